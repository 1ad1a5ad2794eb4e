#pragma once
/// Identification judged on systems and data that this project's own models and test rig did not
/// make: masses, dampers and springs or poles and shapes that a test writes down, controllers of
/// its own, excitation of every kind. One class of data is one table row of
/// docs/validation/identification.md.

#include <complex>
#include <string>
#include <vector>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"

namespace hydrapod::test {

/// A mode that must be found, with its shape at the outputs.
struct TrueMode {
  std::complex<double> pole{};
  Eigen::VectorXcd shape{};  ///< empty: not judged
};

/// A mode that was found, from whatever method. Deviations of 0 or NaN: the method has none.
struct FoundMode {
  std::complex<double> pole{};
  double omega_deviation{}, damping_deviation{};  ///< of ω [rad/s] and ζ
  Eigen::VectorXcd shape{};
  Eigen::VectorXd shape_deviation{};
};

/// Nearest pairs within `frequency` are the same mode, each taken once.
struct SameMode {
  double frequency{0.02};  ///< |Δω|/ω
};

/// What many seeds of one class of data and one method gave.
struct ClassScore {
  int seeds{}, wanted{}, found{}, false_modes{}, refused{};
  std::vector<double> frequency_errors{}, damping_errors{};  ///< relative, of found modes
  int intervals{}, frequency_covered{}, damping_covered{};   ///< 95 % intervals
  int shape_intervals{}, shape_covered{};                    ///< per output

  void add(const std::vector<TrueMode>& truth, const std::vector<FoundMode>& modes,
           const SameMode& same = {});
  [[nodiscard]] double found_share() const;  ///< of wanted modes
  [[nodiscard]] double false_per_seed() const;
  [[nodiscard]] double median_frequency_error() const;  ///< of |Δω|/ω
  [[nodiscard]] double largest_frequency_error() const;
  [[nodiscard]] double median_damping_error() const;  ///< of |Δζ|/ζ
  [[nodiscard]] double largest_damping_error() const;
  [[nodiscard]] double frequency_coverage() const;
  [[nodiscard]] double damping_coverage() const;
  [[nodiscard]] double shape_coverage() const;
};

/// | class | method | seeds | found | false per record | Δω median (largest) | Δζ | coverage ω, ζ,
/// φ |
std::string class_row(const std::string& name, const std::string& method, const ClassScore& score);
/// Expects that all are found, none is false, and that intervals hold the truth in 90 % or more: of
/// 180 that promise 95 % that is three standard errors below.
void expect_honest(const ClassScore& score);
/// Prints a row of the table to stdout.
void print_class(const std::string& name, const std::string& method, const ClassScore& score);

std::vector<FoundMode> found_modes(const identification::Identification& identified);
std::vector<TrueMode> true_modes(const ModalSystem& system);
/// Those whose frequency [Hz] is in a band.
std::vector<TrueMode> within_band(std::vector<TrueMode> modes, double from, double to);

}  // namespace hydrapod::test
