/// Records with too few blocks: identified in one piece.

#include "short_records.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hydrapod::identification {
namespace {

TEST(Dev, Try) {
  const auto rows = two_rows();
  for (const auto& m : rows.modes)
    fmt::print("{:.3f} Hz {:.2f} %\n", std::abs(m.pole) / 6.2831853,
               -100.0 * m.pole.real() / std::abs(m.pole));
  const int seeds = std::getenv("SEEDS") ? std::atoi(std::getenv("SEEDS")) : 3;
  const double noise = std::getenv("NOISE") ? std::atof(std::getenv("NOISE")) : 0.01;
  for (const double T : {5.0, 10.0, 20.0, 40.0}) {
    for (int which = 0; which < 2; ++which) {
      const auto system = which == 0 ? five_masses() : two_rows();
      const auto truth = test::true_modes(system);
      test::ClassScore ours, plain, usual;
      for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds); ++seed) {
        const auto record = short_record(system, {.duration = T, .noise = noise}, seed);
        try {
          const auto r = identified_record({record});
          ours.add(truth, test::found_modes(r.found));
          if (std::getenv("SHOW")) {
            fmt::print("seed {} record {} misfit {:.2f} warnings {} band {:.2f} {:.2f}\n", seed,
                       r.measured.record != nullptr, r.found.model.misfit, r.found.warnings.size(),
                       r.found.from, r.found.to);
            for (const auto& m : r.found.modes)
              fmt::print("   {:.4f} ± {:.4f} Hz  {:.3f} ± {:.3f} %  q {:.2f} sig {:.0f}\n",
                         m.fit.omega() / 6.2831853, m.fit.omega_deviation / 6.2831853,
                         100 * m.fit.damping_ratio(), 100 * m.fit.damping_deviation, m.quality(),
                         m.fit.significance);
            for (const auto& l : r.found.left_out)
              fmt::print("   out {:.3f} Hz {:.2f} % {}\n", std::abs(l.pole) / 6.2831853,
                         -100 * l.pole.real() / std::abs(l.pole), static_cast<int>(l.reason));
          }
        } catch (const std::exception& e) {
          fmt::print("ours: {}\n", e.what());
          ours.add(truth, {});
        }
        plain.add(truth, textbook_record_modes(record, system.inputs(), 25.0));
        try {
          MeasureOptions o;
          usual.add(truth, test::found_modes(identify_modes(measured({record}, o).responses)));
        } catch (const std::exception& e) {
          usual.add(truth, {});
        }
      }
      const auto name = fmt::format("{} {} s", which == 0 ? "five" : "rows", T);
      test::print_class(name, "hydrapod", ours);
      test::print_class(name, "usual", usual);
      test::print_class(name, "VARX", plain);
    }
  }
}

}  // namespace
}  // namespace hydrapod::identification
