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
#include "names.hpp"
#include "pole_basis.hpp"

namespace hydrapod::identification {

/// A complex matrix whose products with others are formed by real ones: half of Eigen's kernels are
/// enough, and where only the real part is wanted half of the work.
struct Parts {
  MatrixXd re, im;
  Parts() = default;
  Parts(Index rows, Index columns) : re(rows, columns), im(rows, columns) {}
  explicit Parts(const MatrixXcd& both) : re(both.real()), im(both.imag()) {}
};

/// The columns from `first` on, times a real matrix.
MatrixXcd product(const Parts& left, Index first, const MatrixXd& right);

/// λ and L of all modes, and which element of L is 1.
struct SharedParameters {
  VectorXcd poles;
  MatrixXcd participations;  // inputs × modes
  std::vector<Index> fixed;
  void step(const VectorXd& change);
};

/// One set of shared parameters with the own ones that are best for it.
struct FitState {
  SharedParameters shared;
  std::vector<PoleLines> lines;  ///< per mode
  Parts functions;               ///< c_a, lines × (2 modes + residual terms)
  std::vector<MatrixXd> gram;    ///< per output, of the columns c_a e_i, number a p + i
  std::vector<VectorXd> own;     ///< per output
  VectorXd mode_power;           ///< Σ over lines and outputs of what each mode adds, squared
  MatrixXcd residual;            ///< Ĥ_oi − H_oi in column o p + i, a row per line
  double cost{};
};

class FitSystem {
 public:
  FitSystem(const FrequencyResponses& responses, const FitOptions& options);

  [[nodiscard]] Index inputs() const { return inputs_; }
  [[nodiscard]] Index outputs() const { return outputs_; }
  [[nodiscard]] Index lines() const { return lines_; }
  [[nodiscard]] double numbers_per_line() const { return numbers_; }
  [[nodiscard]] Index shared_count(Index modes) const { return modes * 2 * inputs_; }
  [[nodiscard]] Index own_count(Index modes) const { return 2 * modes + residual_terms_ * inputs_; }
  [[nodiscard]] int residual_terms() const { return residual_terms_; }
  [[nodiscard]] double omega_scale() const { return omega_scale_; }
  [[nodiscard]] const MatrixXd& deviation() const { return deviation_; }  ///< σ_o
  /// W per line, Wᴴ W = M.
  [[nodiscard]] const std::vector<MatrixXcd>& whitening() const { return white_; }

  /// `before`: a state of this system; what it has of the same poles is not computed again.
  [[nodiscard]] FitState solved(SharedParameters shared, const FitState* before = nullptr) const;

  /// Normal equations of an output: N = JᵀJ over (shared, own) parameters, and Jᵀ e.
  struct Normal {
    MatrixXd matrix;
    VectorXd gradient;
  };
  [[nodiscard]] std::vector<Normal> normals(const FitState& state) const;

  /// d_r without noise weights: lines × (inputs · 2 modes), column i · 2 modes + number.
  [[nodiscard]] Parts slopes(const FitState& state) const;
  /// Derivatives of an output by its (shared, own) parameters, as combinations of the columns
  /// (c_a e_i, d): 2 modes more rows than a Gram matrix.
  [[nodiscard]] MatrixXd derivatives(const FitState& state, Index output) const;

 private:
  [[nodiscard]] Parts weights(Index first, Index lines) const;
  [[nodiscard]] PoleLines lines_of(Complex pole, const FitState* before) const;
  void add_gram(FitState& state) const;
  void solve_own(FitState& state) const;
  [[nodiscard]] MatrixXcd weighted(const MatrixXcd& rows) const;
  [[nodiscard]] Parts times_weight(const Parts& slopes) const;
  [[nodiscard]] MatrixXd with_slopes(const FitState& state, const Parts& slopes,
                                     const Parts& turned, Index output) const;

  struct Pair {
    Index i, j;
  };

  const FrequencyResponses& responses_;
  PoleBasis pole_basis_;
  int residual_terms_;  // s⁻² … s^K
  Index inputs_, outputs_, lines_;
  double numbers_;
  double omega_scale_;
  MatrixXd deviation_;            // lines × outputs
  std::vector<MatrixXcd> white_;  // per line
  MatrixXcd M_;                   // lines × inputs², column i p + j
  std::vector<Pair> pairs_;       // i ≤ j with M_ij ≠ 0 at some line; those i < j come last
  MatrixXcd data_;                // Ĥ_oi in column o p + i
  Parts data_gradient_;           // w_o M Ĥ_o
};

/// φ out of own parameters.
VectorXcd shape_row(const VectorXd& own, Index modes);

}  // namespace hydrapod::identification
