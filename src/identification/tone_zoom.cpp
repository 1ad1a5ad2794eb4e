#include "tone_zoom.hpp"

#include <algorithm>

namespace hydrapod::identification {

namespace {

/// Mean period of a record, by samples from the settling time on.
struct MeanPeriod {
  MatrixXd sum{};  // period × channels
  Index rows{};
  MatrixXd waiting{};  // of the period that is not whole yet

  void add(const data::Samples& samples, Index period) {
    if (sum.size() == 0) sum = waiting = MatrixXd::Zero(period, samples.cols());
    for (Index t = 0; t < samples.rows(); ++t, ++rows) {
      waiting.row(rows % period) = samples.row(t);
      if ((rows + 1) % period == 0) sum += waiting;
    }
  }
};

std::vector<MeanPeriod> mean_periods(data::RecordSet& records, const ToneReading& reading) {
  std::vector<MeanPeriod> means(records.files().size());
  if (!reading.periodic) return means;
  stream_used(records, reading,
              [&](std::size_t record, std::int64_t, const data::Samples& samples) {
                means[record].add(samples, reading.block);
              });
  return means;
}

/// The windows of one record, for all tones at once.
class Demodulator {
 public:
  Demodulator(Index window, Index channels, const std::vector<double>& omegas)
      : hop_(window / 4), buffer_(window, channels), omegas_(omegas) {
    const VectorXd w = window_samples(Window::hann, static_cast<int>(window));
    const double scale = 2.0 / w.sum();
    kernel_ = MatrixXd(window, 2 * static_cast<Index>(omegas.size()));
    for (Index k = 0; k < static_cast<Index>(omegas.size()); ++k)
      for (Index t = 0; t < window; ++t) {
        const Complex turn =
            std::polar(scale * w[t], -omegas[static_cast<std::size_t>(k)] * static_cast<double>(t));
        kernel_(t, 2 * k) = turn.real();
        kernel_(t, 2 * k + 1) = turn.imag();
      }
  }
  /// The row's number counts from the beginning of the record.
  void add(std::int64_t number, const Eigen::Ref<const Eigen::RowVectorXd>& row) {
    if (filled_ == 0) begin_ = number;
    if (!first_) first_ = number;
    buffer_.row(filled_++) = row;
    if (filled_ < buffer_.rows()) return;
    const MatrixXd products = buffer_.transpose() * kernel_;
    for (std::size_t k = 0; k < omegas_.size(); ++k) {
      const auto at = 2 * static_cast<Index>(k);
      VectorXcd z(products.rows());
      z.real() = products.col(at);
      z.imag() = products.col(at + 1);
      rows_.push_back(std::polar(1.0, -omegas_[k] * static_cast<double>(begin_)) * z);
    }
    filled_ -= hop_;
    begin_ += hop_;
    buffer_.topRows(filled_) = buffer_.bottomRows(filled_).eval();
  }
  [[nodiscard]] Zoom zoom(std::size_t tone) const {
    const std::size_t tones = omegas_.size();
    Zoom result{.omega = omegas_[tone],
                .window = buffer_.rows(),
                .hop = hop_,
                .first = first_.value_or(0),
                .z = MatrixXcd(static_cast<Index>(rows_.size() / tones), buffer_.cols())};
    for (Index j = 0; j < result.z.rows(); ++j)
      result.z.row(j) = rows_[static_cast<std::size_t>(j) * tones + tone].transpose();
    return result;
  }

 private:
  Index hop_, filled_{};
  MatrixXd buffer_;  // rows × channels
  std::vector<double> omegas_;
  MatrixXd kernel_;  // window × (re, im) of each tone
  std::optional<std::int64_t> first_{};
  std::int64_t begin_{};
  std::vector<VectorXcd> rows_{};  // of all tones, one after the other
};

}  // namespace

void stream_used(data::RecordSet& records, const ToneReading& reading, const UseRows& use) {
  std::vector<std::int64_t> seen(records.files().size());
  const std::vector<Index> columns(reading.channels.begin(), reading.channels.end());
  records.stream([&](std::size_t record, const Eigen::Ref<const data::Samples>& block) {
    const std::int64_t number = seen[record];
    seen[record] += block.rows();
    const Index skip = std::clamp<std::int64_t>(reading.settling - number, 0, block.rows());
    if (skip < block.rows())
      use(record, number + skip,
          data::Samples(block(Eigen::seqN(skip, block.rows() - skip), columns)));
    return true;
  });
}

std::vector<std::vector<Zoom>> zoom_in(data::RecordSet& records, const ToneReading& reading,
                                       const std::vector<std::vector<double>>& omegas,
                                       Index window) {
  const std::size_t count = records.files().size();
  const auto means = mean_periods(records, reading);
  std::vector<Demodulator> demodulators;
  for (std::size_t r = 0; r < count; ++r) {
    std::vector<double> own;
    for (const auto& omega : omegas) own.push_back(omega[r]);
    demodulators.emplace_back(window, static_cast<Index>(reading.channels.size()), own);
  }
  stream_used(records, reading,
              [&](std::size_t record, std::int64_t number, const data::Samples& samples) {
                const auto& mean = means[record];
                const Index periods = mean.rows / std::max(reading.block, 1);
                for (Index t = 0; t < samples.rows(); ++t, ++number) {
                  Eigen::RowVectorXd row = samples.row(t);
                  if (reading.periodic && periods > 0)
                    row -= mean.sum.row((number - reading.settling) % reading.block) /
                           static_cast<double>(periods);
                  demodulators[record].add(number, row);
                }
              });
  std::vector<std::vector<Zoom>> zooms(omegas.size());
  for (std::size_t k = 0; k < omegas.size(); ++k)
    for (std::size_t r = 0; r < count; ++r) {
      zooms[k].push_back(demodulators[r].zoom(k));
      if (!reading.periodic) continue;
      zooms[k].back().period = reading.block;
      zooms[k].back().periods = means[r].rows / reading.block;
    }
  return zooms;
}

}  // namespace hydrapod::identification
