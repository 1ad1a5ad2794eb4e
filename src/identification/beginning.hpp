#pragma once
/// What the first samples of a record tell of how to read it. Private to the module.

#include <cstdint>
#include <map>
#include <vector>

#include "hydrapod/identification/responses.hpp"
#include "names.hpp"

namespace hydrapod::identification {

/// The first samples of the first input and the first instrument, up to a million past what
/// settles. They are read once, when they are asked for.
class Beginning {
 public:
  /// `records` must live as long.
  Beginning(data::RecordSet& records, const ChannelChoice& choice, std::int64_t settling);
  VectorXd of(int channel);

 private:
  void read();

  data::RecordSet& records_;
  std::int64_t settling_;
  bool read_{};
  std::map<int, std::vector<double>> samples_{};
};

/// That of the instruments, where there are records enough for responses from them: in a loop noise
/// makes the inputs differ from period to period. Else that of the inputs. 0: there is none.
std::int64_t excitation_period(const data::RecordSet& records, const ChannelChoice& choice,
                               Beginning& beginning);

/// Has the spectrum of `x`, in blocks of this length, no gap?
bool fills_band(const VectorXd& x, int block, const FilledBand& options);

}  // namespace hydrapod::identification
