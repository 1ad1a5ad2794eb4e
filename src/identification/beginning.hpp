#pragma once
/// What the first samples of a record tell of how to read it. Private to the module.

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "hydrapod/identification/responses.hpp"
#include "names.hpp"

namespace hydrapod::identification {

/// The first samples of the inputs and the instruments, up to a million past what settles, of
/// the first record. They are read once, when they are asked for.
class Beginning {
 public:
  /// `records` must live as long.
  Beginning(data::RecordSet& records, const ChannelChoice& choice, std::int64_t settling);
  const VectorXd& of(int channel);
  /// Is that the whole record?
  [[nodiscard]] bool is_whole() const { return whole_; }
  /// Gives the memory back; what is asked for later is read again.
  void release();

 private:
  void read();

  data::RecordSet& records_;
  std::int64_t settling_;
  bool read_{}, whole_{};
  std::map<int, VectorXd> samples_{};
};

/// That of the instruments, where there are records enough for responses from them: in a loop noise
/// makes the inputs differ from period to period. Else that of the inputs. 0: there is none.
std::int64_t excitation_period(const data::RecordSet& records, const ChannelChoice& choice,
                               Beginning& beginning);

/// Has the spectrum of `x`, in blocks of this length, no gap?
bool fills_band(const VectorXd& x, int block, const FilledBand& options);

/// A sweep is a signal whose time tells its frequency. With the power p_tf of sections t of the
/// record in bands f of equal power, Σ p_tf = 1,
///
///     I = Σ p_tf ln(p_tf/(p_t p_f))   >   tells · min(E_t, E_f),   E = −Σ p ln p,
///
/// and e^(E_t), e^(E_f) ≥ fewest. Noise has I = 0 but for chance, 0.42 with a line per band,
/// however its level varies: then p_tf = p_t p_f. Sweeps that are short beside a section have none
/// either.
struct SweepRules {
  int sections{32}, bands{16};  ///< at least so many sections
  double tells{0.5};
  double fewest{4.0};  ///< of fewer, chance tells too much
  /// A section is excited from the first to the last line with power > edge · its largest, where
  /// its power > heard · the mean of the sections: what is less is no part of the sweep.
  double edge{0.1}, heard{0.1};
  /// Modes of sweeps are those of the record in one piece, with at most so many lines in the band
  /// where the outputs are heard: half a minute or so.
  double most_lines{6000.0};
};

/// [Hz] that a sweep passes.
struct Swept {
  double from{}, to{};
};

/// None: it is no sweep.
std::optional<Swept> sweep_in(const VectorXd& samples, double sample_rate,
                              const SweepRules& rules = {});

}  // namespace hydrapod::identification
