#pragma once
/// Linear systems given by their modes, and their exact response to sampled input.
///
///     H(s) = Σ_r [ φ_r L_rᵀ/(s − λ_r) + conj. ]
///
/// Input is held between samples; then q_r(k + 1) = e^(λT) q_r(k) + (e^(λT) − 1)/λ L_rᵀ u(k) and
/// y = 2 Re Σ φ_r q_r hold without any error of integration.

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

struct ExactMode {
  std::complex<double> pole{};
  Eigen::VectorXcd shape{};
  Eigen::VectorXcd participation{};
};

struct ModalSystem {
  std::vector<ExactMode> modes{};
  [[nodiscard]] Eigen::Index outputs() const { return modes[0].shape.size(); }
  [[nodiscard]] Eigen::Index inputs() const { return modes[0].participation.size(); }
  /// H(s) of the system itself.
  [[nodiscard]] Eigen::MatrixXcd response(double frequency) const;
  /// From held samples to samples: H(z), z = e^((shift + 2πi f) T).
  [[nodiscard]] Eigen::MatrixXcd sampled_response(double frequency, double sample_time,
                                                  double shift = 0.0) const;
};

/// A real mode of frequency [Hz] and damping ratio with displacement shape ψ: residue ψ ψᵀ/(2i Im
/// λ), as of a structure with modal mass 1.
ExactMode real_mode(double frequency, double damping_ratio, const Eigen::VectorXd& shape);

/// n equal masses between n + 1 equal springs, both ends held, same damping ratio for all modes:
/// ω_r = 2 √(k/m) sin(r π/(2 (n + 1))), ψ_r(j) = √(2/(m (n + 1))) sin(j r π/(n + 1)).
ModalSystem chain(int masses, double mass, double stiffness, double damping_ratio);

/// Runs a system sample by sample.
class ModalRun {
 public:
  ModalRun(const ModalSystem& system, double sample_time);
  [[nodiscard]] Eigen::VectorXd output() const;
  void advance(const Eigen::VectorXd& input);
  /// From now on the mode's pole is `factor` times that of the system.
  void tune(int mode, double factor);

 private:
  const ModalSystem& system_;
  double sample_time_;
  Eigen::VectorXcd state_, decay_, gain_;
};

struct NoiseExperiment {
  double sample_rate{100.0};
  int samples{1 << 14};
  double input_deviation{1.0};
  Eigen::VectorXd output_noise{};  ///< standard deviation per output; empty: none
  std::uint64_t seed{1};
  int settling{2000};  ///< samples before the record begins
};

double normal(Random& random);

/// White noise on all inputs; channels u1 …, y1 … with roles excitation and response.
data::Record record_of(const ModalSystem& system, const NoiseExperiment& experiment);

data::RecordHeader header_of(Eigen::Index inputs, Eigen::Index outputs, double sample_rate);

}  // namespace hydrapod::test
