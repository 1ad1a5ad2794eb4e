#pragma once
/// The least-squares problem of fit_modes. Private to the module.
///
/// Parameters that all outputs share: per mode Re λ, Im λ and the real and imaginary parts of L but
/// for its largest element, which is 1. Own parameters of an output: per mode Re φ, Im φ; then C_k
/// by k and input. With the rows e_o = (Ĥ_o − H_o)ᵀ of an output at a line, w_o = 1/σ_o² and
/// M = Q⁻¹ (Q scaled to a mean diagonal of 1) the sum of squares is
///
///     Σ w_o e_oᴴ M e_o   over lines and outputs.
///
/// All derivatives are real combinations of columns that outputs have in common:
///
///     c_a e_i,   c = g_r + ḡ_r,  i (g_r − ḡ_r)  per mode, then s^k
///     d_r,       d = g'_r L_r + ḡ'_r L_r*,  i (g'_r L_r − ḡ'_r L_r*)  per mode
///
/// (g, ḡ: of λ and λ*, g' the derivative by the pole), so that Gram matrices need but the products
/// c_a* c_b at each line, summed with the weights w_o M_ij.

#include "hydrapod/identification/identify.hpp"
#include "pole_basis.hpp"

namespace hydrapod::identification {

/// λ and L of all modes, and which element of L is 1.
struct SharedParameters {
  Eigen::VectorXcd poles;
  Eigen::MatrixXcd participations;  // inputs × modes
  std::vector<Eigen::Index> fixed;
  void step(const Eigen::VectorXd& change);
};

/// One set of shared parameters with the own ones that are best for it.
struct FitState {
  SharedParameters shared;
  std::vector<PoleLines> lines;       ///< per mode
  Eigen::MatrixXcd functions;         ///< c_a, lines × (2 modes + residual terms)
  std::vector<Eigen::MatrixXd> gram;  ///< per output, of the columns c_a e_i, number a p + i
  std::vector<Eigen::VectorXd> own;   ///< per output
  Eigen::VectorXd mode_power;         ///< Σ over lines and outputs of what each mode adds, squared
  Eigen::MatrixXcd residual;          ///< Ĥ_oi − H_oi in column o p + i, a row per line
  double cost{};
};

class FitSystem {
 public:
  FitSystem(const FrequencyResponses& responses, const FitOptions& options);

  [[nodiscard]] Eigen::Index inputs() const { return inputs_; }
  [[nodiscard]] Eigen::Index outputs() const { return outputs_; }
  [[nodiscard]] Eigen::Index lines() const { return lines_; }
  [[nodiscard]] Eigen::Index shared_count(Eigen::Index modes) const { return modes * 2 * inputs_; }
  [[nodiscard]] Eigen::Index own_count(Eigen::Index modes) const {
    return 2 * modes + residual_terms_ * inputs_;
  }
  [[nodiscard]] int residual_terms() const { return residual_terms_; }
  [[nodiscard]] double omega_scale() const { return omega_scale_; }
  [[nodiscard]] const Eigen::MatrixXd& deviation() const { return deviation_; }  ///< σ_o
  /// W per line, Wᴴ W = M.
  [[nodiscard]] const std::vector<Eigen::MatrixXcd>& whitening() const { return white_; }

  [[nodiscard]] FitState solved(SharedParameters shared) const;

  /// Normal equations of an output: N = JᵀJ over (shared, own) parameters, and Jᵀ e.
  struct Normal {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
  };
  [[nodiscard]] std::vector<Normal> normals(const FitState& state) const;

  /// d_r without noise weights: lines × (inputs · 2 modes), column i · 2 modes + number.
  [[nodiscard]] Eigen::MatrixXcd slopes(const FitState& state) const;
  /// Derivatives of an output by its (shared, own) parameters, as combinations of the columns
  /// (c_a e_i, d): 2 modes more rows than a Gram matrix.
  [[nodiscard]] Eigen::MatrixXd derivatives(const FitState& state, Eigen::Index output) const;

 private:
  void add_gram(FitState& state) const;
  void solve_own(FitState& state) const;
  [[nodiscard]] Eigen::MatrixXcd weighted(const Eigen::MatrixXcd& rows) const;
  [[nodiscard]] Eigen::MatrixXd with_slopes(const FitState& state, const Eigen::MatrixXcd& slopes,
                                            const Eigen::MatrixXcd& turned,
                                            Eigen::Index output) const;

  const FrequencyResponses& responses_;
  PoleBasis pole_basis_;
  int residual_terms_;  // s⁻² … s^K
  Eigen::Index inputs_, outputs_, lines_;
  double omega_scale_;
  Eigen::MatrixXd deviation_;                // lines × outputs
  std::vector<Eigen::MatrixXcd> white_;      // per line
  Eigen::MatrixXcd M_;                       // lines × inputs², column i p + j
  Eigen::MatrixXd weights_re_, weights_im_;  // w_o M_ij, i ≤ j: lines × (outputs · pairs)
  Eigen::MatrixXcd data_;                    // Ĥ_oi in column o p + i
  Eigen::MatrixXd data_gradient_re_, data_gradient_im_;  // w_o M Ĥ_o
};

/// φ out of own parameters.
Eigen::VectorXcd shape_row(const Eigen::VectorXd& own, Eigen::Index modes);

}  // namespace hydrapod::identification
