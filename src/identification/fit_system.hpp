#pragma once
/// The least-squares problem of fit_modes. Private to the module.
///
/// Parameters that all outputs share: per mode Re λ, Im λ and the real and imaginary parts of L but
/// for its largest element, which is 1. Own parameters of an output: per mode Re φ, Im φ; then C_k
/// by k and input. Residuals of an output and a line are the p complex numbers W (Ĥ_o − H_o)ᵀ/σ_o.

#include "hydrapod/identification/modal_model.hpp"
#include "pole_basis.hpp"

namespace hydrapod::identification {

inline constexpr int residual_terms = 4;  // s⁻² … s
inline constexpr int lowest_residual_power = -2;

/// λ and L of all modes, and which element of L is 1.
struct SharedParameters {
  Eigen::VectorXcd poles;
  Eigen::MatrixXcd participations;  // inputs × modes
  std::vector<Eigen::Index> fixed;
  void step(const Eigen::VectorXd& change);
};

/// All that is needed at one set of shared parameters.
struct Basis {
  std::vector<PoleLines> lines;      // per mode
  std::vector<Eigen::MatrixXcd> u;   // per line: W L, inputs × modes
  std::vector<Eigen::MatrixXcd> uc;  // W L*
};

class FitSystem {
 public:
  FitSystem(const FrequencyResponses& responses, bool taper);

  [[nodiscard]] Eigen::Index inputs() const { return inputs_; }
  [[nodiscard]] Eigen::Index outputs() const { return outputs_; }
  [[nodiscard]] Eigen::Index lines() const { return lines_; }
  [[nodiscard]] Eigen::Index shared_count(Eigen::Index modes) const { return modes * 2 * inputs_; }
  [[nodiscard]] Eigen::Index own_count(Eigen::Index modes) const {
    return 2 * modes + residual_terms * inputs_;
  }
  [[nodiscard]] double omega_scale() const { return omega_scale_; }
  [[nodiscard]] const Eigen::MatrixXd& deviation() const { return deviation_; }

  [[nodiscard]] Basis basis(const SharedParameters& shared) const;
  /// Derivatives of the model by the own parameters, inputs × own_count, at a line; without 1/σ_o.
  void own_columns(const Basis& basis, Eigen::Index line,
                   Eigen::Ref<Eigen::MatrixXcd> columns) const;
  /// By the shared parameters, given this output's φ.
  void shared_columns(const Basis& basis, const SharedParameters& shared,
                      const Eigen::VectorXcd& phi, Eigen::Index line,
                      Eigen::Ref<Eigen::MatrixXcd> columns) const;
  /// W Ĥ_oᵀ.
  [[nodiscard]] Eigen::VectorXcd data(Eigen::Index output, Eigen::Index line) const;

  /// The best own parameters of an output and what they leave, Σ |residual|².
  struct OwnFit {
    Eigen::VectorXd parameters;
    double cost{};
  };
  [[nodiscard]] OwnFit fit_own(const Basis& basis, Eigen::Index output) const;

  /// Normal equations of an output: N = JᵀJ over (shared, own) parameters, and Jᵀ e.
  struct Normal {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
  };
  [[nodiscard]] Normal normal(const Basis& basis, const SharedParameters& shared,
                              Eigen::Index output, const Eigen::VectorXd& own) const;

 private:
  const FrequencyResponses& responses_;
  PoleBasis pole_basis_;
  Eigen::Index inputs_, outputs_, lines_;
  double omega_scale_;
  Eigen::MatrixXd deviation_;            // σ_o, lines × outputs
  std::vector<Eigen::MatrixXcd> white_;  // W per line
};

/// φ out of own parameters.
Eigen::VectorXcd shape_row(const Eigen::VectorXd& own, Eigen::Index modes);

}  // namespace hydrapod::identification
