#pragma once
/// What the errors of all lines make of functions of the parameters. Private to the module.
///
/// A function is linear in the whitened errors e of an output at a line: Re Σ f_oi* e_oi. With C
/// the coherence of the errors of outputs at a line and a_d the covariance of lines that are d
/// apart,
///
///     variance = ½ Re Σ_k Σ_i f_iᴴ(k) C(k) Σ_d a_d f_i(k + d).
///
/// What windows let in has variances of the same form, see data::Leakage.

#include <optional>
#include <span>
#include <vector>

#include "fit_system.hpp"
#include "leakage.hpp"
#include "output_errors.hpp"

namespace hydrapod::identification {

class Propagation {
 public:
  /// Per output what the columns (c_a e_i, d) of fit_system.hpp are multiplied by; one column for
  /// each function.
  using Factors = std::vector<MatrixXd>;

  /// Own parameters are eliminated: output o's by X[o]. The arguments must outlive this.
  Propagation(const FitSystem& system, const FrequencyResponses& responses, const FitState& state,
              const std::vector<MatrixXd>& X, const LeakageParts& let_in);

  /// vᵀ Jᵀ cov(e) J v of each column v of V, functions of the shared parameters.
  [[nodiscard]] VectorXd variances(const MatrixXd& V) const;

  [[nodiscard]] Factors factors(const MatrixXd& V) const;
  /// Of each column of the factors. `first`: the output of the first of them.
  [[nodiscard]] VectorXd variances(const Factors& factors, Index first = 0) const;

 private:
  struct Sums;
  struct Stack;
  [[nodiscard]] Stack changes(const Factors& factors, Index first, Index from, Index to) const;
  [[nodiscard]] Sums sums(const Factors& factors, Index first, std::span<const Complex> along,
                          const MatrixXd* V) const;
  [[nodiscard]] VectorXd summed(const Factors& factors, Index first, const MatrixXd* V) const;
  [[nodiscard]] VectorXd of_half_spectra(const Factors& factors) const;
  [[nodiscard]] bool by_all_parameters(Index functions) const;
  void add_noise();
  void apply_coherence(Stack& stack, Index first) const;
  [[nodiscard]] Stack let_in_by(const Stack& stack, Index first) const;

  const FitSystem& system_;
  const FrequencyResponses& responses_;
  const LeakageParts& let_in_;
  Parts functions_, slopes_;           // transposed: a column per line
  MatrixXd by_noise_, by_leakage_;     // outputs × lines; empty: outputs err alone
  std::vector<MatrixXd> derivatives_;  // of the columns (c_a e_i, d), by the shared parameters
  std::optional<OutputErrors> errors_;
};

}  // namespace hydrapod::identification
