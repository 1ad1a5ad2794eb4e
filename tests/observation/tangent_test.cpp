/// First-order changes of what is observed, against differences of the observations themselves.

#include "hydrapod/observation/observation.hpp"

#include <gtest/gtest.h>

#include <array>

#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/calibration_machine.hpp"
#include "support/run_program.hpp"

namespace hydrapod::observation {
namespace {

using dynamics::ModelKind;

/// A number of the machine file that is varied, and of which machine.
struct Varied {
  std::string path{};
  std::vector<std::string> overrides{};
  Observed observed{Observed::plant};
};

class Tangents : public testing::TestWithParam<Varied> {
 protected:
  Tangents()
      : file_(test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")),
                                 GetParam().overrides)),
        number_(find_number(file_, GetParam().path).value()) {
    if (GetParam().observed == Observed::system)
      controller_ = simulation::tune_controller(file_.machine, X_BP()).parameters;
  }
  [[nodiscard]] spatial::Pose X_BP() const { return file_.machine.poses.back().X_BP; }
  [[nodiscard]] double value() const { return number_.value; }
  [[nodiscard]] const control::ControllerParameters* controller() const {
    return controller_ ? &*controller_ : nullptr;
  }
  [[nodiscard]] model::Machine machine(double value) const {
    return model::with(file_.machine, std::array{model::Assignment{number_.id, value}});
  }
  [[nodiscard]] Observation observed_at(double value) const {
    return observe(machine(value), X_BP(), ModelKind::guide, GetParam().observed, controller());
  }
  [[nodiscard]] Tangent tangent(double step) const {
    const auto system = [&](double value) {
      return observed_system(machine(value), X_BP(), ModelKind::guide, GetParam().observed,
                             controller());
    };
    return {observed_at(value()), system(value() - step), system(value() + step), 2.0 * step};
  }

 private:
  model::MachineFile file_;
  model::FileNumber number_;
  std::optional<control::ControllerParameters> controller_{};
};

TEST_P(Tangents, PolesMoveAsDifferencesSay) {
  const double h = 1e-4 * value();
  const auto center = observed_at(value()), above = observed_at(value() + h),
             below = observed_at(value() - h);
  const auto line = tangent(1e-3 * value());
  const auto moved = line.at(h);
  int compared = 0;
  double largest = 0.0;
  for (std::size_t k = 0; k < center.modes.size(); ++k) {
    const auto pole = center.modes[k].pole;
    const auto near = [&](const Observation& seen) {
      return std::ranges::min_element(seen.modes, {},
                                      [&](const auto& m) { return std::abs(m.pole - pole); })
          ->pole;
    };
    const auto by_differences = 0.5 * (near(above) - near(below));
    const bool alone = std::ranges::count_if(center.modes, [&](const auto& m) {
                         return std::abs(m.pole - pole) < 0.02 * std::abs(pole);
                       }) == 1;
    if (!alone || std::abs(pole) < 1.0) continue;
    EXPECT_LT(std::abs(moved.modes[k].pole - pole - by_differences),
              2e-5 * std::abs(by_differences) + 1.2e-9 * std::abs(pole))
        << pole;
    largest = std::max(largest, std::abs(by_differences) / std::abs(pole));
    ++compared;
  }
  EXPECT_GE(compared, 4);
  EXPECT_GT(largest, 1e-7);
}

/// Poles that repeat or nearly coincide do not disturb them.
TEST_P(Tangents, ResponsesMoveAsDifferencesSay) {
  const double h = 1e-3 * value(), tiny = 1e-7 * value();
  const auto above = observed_at(value() + h), below = observed_at(value() - h);
  const auto line = tangent(h);
  const auto high = line.at(tiny), low = line.at(-tiny);
  for (const double omega : {13.1, 47.7, 83.0, 190.0})
    for (const auto entry : {Entry::valves, Entry::commands, Entry::forces})
      for (const auto against : {MotionAgainst::ground, MotionAgainst::base}) {
        if (!can_enter(GetParam().observed, entry)) continue;
        const std::complex<double> s(0.7, omega);
        const auto at = [&](const Observation& seen) { return seen.response(s, entry, against); };
        const auto found = ((at(high) - at(low)) / (2.0 * tiny)).eval();
        const auto expected = ((at(above) - at(below)) / (2.0 * h)).eval();
        // A, B and C come from differences of the plant that are good to some 1e-9; over h it shows
        const double rounding = 5e-6 * at(high).norm() / std::abs(value());
        EXPECT_LT((found - expected).norm(), 3e-4 * expected.norm() + rounding) << omega;
      }
}

INSTANTIATE_TEST_SUITE_P(
    , Tangents,
    testing::Values(Varied{"legs.guide_sleeve.stiffness"}, Varied{"leg.3.guide_sleeve.stiffness"},
                    Varied{"platform.mass"}, Varied{"platform.mass_center[2]"},
                    Varied{"leg.2.oil_spring.cylinder.bulk_modulus"},
                    Varied{"base.mount.stiffness.x",
                           {"base.mount.mass=1.31 t", "base.mount.stiffness.x=0.041 kN/um",
                            "base.mount.stiffness.ry=7.1e8"}},
                    Varied{"platform.mass", {}, Observed::system},
                    Varied{"legs.guide_sleeve.stiffness", {}, Observed::system}));

}  // namespace
}  // namespace hydrapod::observation
