#pragma once
/// Records with too few blocks: their samples, a model of the time record, and their modes. Private
/// to the module.
///
/// The band ends where no output is heard any more (record_band.hpp). At twice its end over
/// RecordOptions::nyquist_room a VARX model is fitted (varx.hpp) and realised; where all stable
/// poles lie in the lower part of the band, the band is narrowed as that of frequency responses is,
/// and the model fitted anew. Its clusters of poles begin the fit of the modal model to the spectra
/// of the whole record (record_fit.hpp).
///
/// Sweeps. In blocks a resonance is excited while the window rises or falls, and what it makes of
/// damping does not average out. The record in one piece has no window: its modes are asked for
/// however many blocks there are, up to where the inputs end.
///
/// Feedback. Inputs must not hold the outputs' noise. Where the innovations of
/// a model of the inputs from their own past are smaller with the outputs' past besides, the inputs
/// follow the outputs (Granger). That is asked of channels that are not excitations by their role:
/// these are what somebody commanded.
///
/// Source: C. W. J. Granger, Econometrica 37 (1969) 424.

#include <optional>

#include "bring_to_platform.hpp"
#include "reading.hpp"
#include "signals.hpp"

namespace hydrapod::identification {

struct ShortRecord {
  Signals signals{};
  std::optional<Swept> sweep{};
};

/// [blocks], side by side, of the length that would be chosen, and how many it takes.
struct BlockCount {
  double fit{}, needed{};
};

/// Do the options say how blocks are to be averaged?
bool asks_for_blocks(const MeasureOptions& options);

/// None: the options say how blocks are to be averaged, or there are enough and no sweep.
std::optional<BlockCount> too_few_blocks(const data::RecordSet& records, const Reading& reading,
                                         const MeasureOptions& options);

/// A sweep that few blocks cut into pieces.
std::optional<data::ResponseWarning> warning_of_cut_sweep(const data::RecordSet& records,
                                                          const Reading& reading,
                                                          const MeasureOptions& options);

/// The record is kept, and m.responses become those of a model of it. `choice`: of m.spectra;
/// `changes`: of its channels. False, and nothing is done, where samples are missing that cannot be
/// filled, and, with a warning, where inputs follow outputs; where the whole record was asked for,
/// that is a base::ComputationError, and not looked for in excitations.
bool keep_short_record(data::RecordSet& records, const Reading& reading, const BlockCount& blocks,
                       const MeasureOptions& options, const std::vector<PlatformChange>& changes,
                       ChannelChoice& choice, Measurement& m);

}  // namespace hydrapod::identification
