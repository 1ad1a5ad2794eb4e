#pragma once
/// The modal model of the spectra of whole records. Private to the module.
///
/// Of a record of n samples the lines of the rectangular transform are, without any average,
///
///     Y(ω) = H(ω) U(ω) + T(ω) + V(ω),   T(ω) = Σ_r φ_r t_r/(iω − λ_r) + conj. + Σ_k D_k s^k.
///
/// T is what rings from before the beginning less what rings on after the end: the response to one
/// more input of constant spectrum, in which each mode takes part by t_r, one per record. V is
/// independent from line to line. E[V Vᴴ] is the more likely of two: the mean of the residual's
/// squares over lines on either side, less what the fit took of them, and what the model of the time
/// record says, with the residual's level. Given it, λ, L, φ, t, C and D have the greatest
/// likelihood where Σ |V_o|²/E|V_o|² is least: FitSystem, with rows that are seen as e_oᵀ U alone.
/// Both are found in turn.
///
/// Errors. N⁻¹ of the normal equations, with the covariance of V between outputs (fit_covariance).
///
/// Sources: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach, 2nd ed.
/// (2012), ch. 6, 9 and 12 (transients as an input, noise from the residual).

#include <vector>

#include "hydrapod/identification/identify.hpp"
#include "signals.hpp"

namespace hydrapod::identification {

struct Varx;

/// Lines of all records, ascending in frequency.
struct RecordLines {
  std::vector<double> frequency{};       ///< [Hz]
  std::vector<Index> record{};           ///< that the line is of
  MatrixXcd Y{}, U{};                    ///< lines × channels
  std::vector<MatrixXcd> model_noise{};  ///< E[V Vᴴ] of the model of the time record
  Index records{};
  double duration{};  ///< [s] of the longest record
  [[nodiscard]] Index size() const { return static_cast<Index>(frequency.size()); }
};

/// Lines from `from` to `to` [Hz]. `model`: of the time record.
RecordLines lines_in_band(const Signals& signals, double from, double to, const Varx& model);

/// As responses that are seen along one excitation, the last inputs being the transients of the
/// records. `noise`: E[V Vᴴ] per line.
FrequencyResponses responses_in_record(const RecordLines& lines, std::vector<MatrixXcd> noise);

/// Fits, with the density of the noise, from `clusters` on: those that stay, with those that the
/// residual asks for. `result` gets `responses` (as above), clusters and model.
void fit_record(const IdentifyOptions& options, const RecordLines& lines,
                std::vector<PoleCluster> clusters, Identification& result);

/// The participation of the inputs alone.
void without_transients(Index inputs, ModalModel& model);

}  // namespace hydrapod::identification
