#pragma once
/// Channels around one frequency, at a low rate. Private to the module.
///
///     z_j = 2/Σ w · Σ_t w_t x(t_j + t) e^(−iω (t_j + t)),   w: Hann's window,
///
/// so that z = A for x = Re A e^(iωt). Where the excitation is periodic the mean period of the
/// record is taken out before.

#include "tones.hpp"

namespace hydrapod::identification {

/// One tone in one record.
struct Zoom {
  double omega{};         ///< [rad/sample]
  Index window{}, hop{};  ///< [samples]
  std::int64_t first{};   ///< sample of the record at which the first window begins
  Index period{};         ///< [samples] whose mean was taken out; 0: none
  Index periods{};        ///< in that mean
  MatrixXcd z{};          ///< times × channels; rows with missing samples are not finite
  /// Middle of a window [samples].
  [[nodiscard]] double time(Index row) const {
    return static_cast<double>(first + row * hop) + 0.5 * static_cast<double>(window);
  }
};

/// The record's number, that of the first row, counted from the beginning of the record, and rows
/// of the channels of a reading.
using UseRows = std::function<void(std::size_t, std::int64_t, const data::Samples&)>;
/// All samples behind the settling time.
void stream_used(data::RecordSet& records, const ToneReading& reading, const UseRows& use);

/// [tone][record]. `omegas`: [tone][record], in rad/sample.
std::vector<std::vector<Zoom>> zoom_in(data::RecordSet& records, const ToneReading& reading,
                                       const std::vector<std::vector<double>>& omegas,
                                       Index window);

}  // namespace hydrapod::identification
