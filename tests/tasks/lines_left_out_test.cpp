/// What modes cannot be found in, frequencies, channels and conjugates, is said, as all else is.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>
#include <string>

#include "exact/modal_system.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/tasks/machine.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "support/run_program.hpp"

namespace hydrapod::tasks {
namespace {

/// A table of the responses of two outputs; `blank`: is this one written as 0?
template <class Blank>
void write_table(const std::string& file, const Blank& blank, bool conjugate = false) {
  const auto system = test::chain(3, 1.3, 4000.0, 0.015);
  test::Random random(3);
  std::ofstream out(file);
  out << "frequency [Hz],re a1/F [m/N],im a1/F [m/N],re a2/F [m/N],im a2/F [m/N]\n";
  for (int k = 20; k < 500; ++k) {
    const double f = 0.04 * k;
    const Eigen::MatrixXcd H = system.response(f);
    out << f;
    for (int o = 0; o < 2; ++o) {
      const std::complex<double> h =
          H(o, 0) *
          (1.0 + 0.003 * std::complex<double>(test::normal(random), test::normal(random)));
      if (blank(o, f))
        out << ",0,0";
      else
        out << fmt::format(",{},{}", h.real(), conjugate ? -h.imag() : h.imag());
    }
    out << "\n";
  }
}

Identified identified(const std::string& file) {
  return identify({.measure = {.files = {file}}, .compare = false});
}

std::int64_t said(const Identified& found, const std::string& part) {
  return std::ranges::count_if(found.warnings, [&](const base::Diagnostic& d) {
    return d.message.find(part) != std::string::npos;
  });
}

TEST(LinesLeftOut, ZerosOfAnAnalyserAreSaidAndModesAreThoseOfTheRest) {
  const test::TemporaryFolder folder;
  const std::string whole = folder / "whole.csv", blanked = folder / "blanked.csv";
  write_table(whole, [](int, double) { return false; });
  write_table(blanked, [](int o, double f) { return f < 2.0 || (o == 1 && f > 18.0); });
  const auto all = identified(whole), some = identified(blanked);
  EXPECT_EQ(said(all, "exactly 0"), 0);
  EXPECT_EQ(said(some, "frequencies a response is exactly 0, that of a2 to F most often"), 1);
  int found = 0;
  for (const auto& mode : some.modes.modes) {
    const double omega = mode.fit.omega();
    const bool is_true = std::ranges::any_of(std::array{1, 2, 3}, [&](int k) {
      const double exact = 2.0 * std::sqrt(4000.0 / 1.3) * std::sin(k * std::numbers::pi / 8.0);
      return std::abs(omega / exact - 1.0) < 1e-3;
    });
    found += is_true ? 1 : 0;
    EXPECT_TRUE(is_true || mode.quality() < 0.3) << omega << ", quality " << mode.quality();
  }
  EXPECT_EQ(found, 3);
}

TEST(LinesLeftOut, ADeadOutputOfATableIsSaid) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "dead.csv";
  write_table(file, [](int o, double) { return o == 1; });
  EXPECT_EQ(said(identified(file), "a2: dead"), 1);
}

/// In the convention e^(−iωt).
TEST(LinesLeftOut, ConjugatedResponsesAreSaidAndAreNoTargets) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "conjugated.csv";
  write_table(
      file, [](int, double) { return false; }, true);
  const auto found = identified(file);
  EXPECT_EQ(said(found, "the phases rise through the resonances"), 1);
  for (const auto& mode : found.modes.modes) EXPECT_EQ(mode.quality(), 0.0);
  const auto machine =
      read_machine({.file = test::source_file("models/heavy-platform.toml").string()});
  try {
    read_measured(machine, {.files = {file}});
    FAIL() << "not refused";
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("conjugated.csv"));
    EXPECT_THAT(error.what(), testing::HasSubstr("the phases rise through the resonances"));
  }
}

}  // namespace
}  // namespace hydrapod::tasks
