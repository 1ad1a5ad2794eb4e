#pragma once
/// Vibrations of constant amplitude in short records: mains hum, ripple of a pump. Private to the
/// module.
///
/// Over a record of T seconds such a vibration is, at the lines of the record, what a mode without
/// damping leaves as a transient: a e^(iω₀t) has the lines −a (e^(iω₀T) − 1)/(T (iω − iω₀)). So it
/// is a pole of the modal model of record_fit.hpp that hardly decays within the record and that the
/// inputs do not drive:
///
///     −Re λ T < decays,   Σ |g|² |LᵀU|² < driven · Σ |g|² |t|²,
///
/// t being its part in the transients. A mode as sharp as that, driven by the inputs, fails the
/// second. Tones are tried where the residual stands out, and fitted with all modes; what is left
/// of the record is what it would be without them.

#include <vector>

#include "hydrapod/identification/identify.hpp"
#include "record_fit.hpp"

namespace hydrapod::identification {

/// Tones that the residual of `result`, a fit of `lines`, asks for.
void add_tones(const IdentifyOptions& options, const RecordLines& lines, Identification& result);

/// Takes them out of the model and of the clusters of `result`; what is known of them.
std::vector<data::Harmonic> take_out_tones(const IdentifyOptions& options, const RecordLines& lines,
                                           Identification& result);

}  // namespace hydrapod::identification
