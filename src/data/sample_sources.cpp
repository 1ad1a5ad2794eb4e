#include "sample_sources.hpp"

#include <algorithm>

namespace hydrapod::data {

void SampleSources::add(std::size_t variable, bool samples_are_slow, std::size_t channels) {
  const std::size_t before = all_.empty() ? 0 : all_.back().first_channel + all_.back().channels;
  all_.push_back({variable, samples_are_slow, before, channels});
}

bool SampleSources::read_source(const Source& source, std::uint64_t first,
                                Eigen::Ref<Samples> block) {
  const auto rows = static_cast<std::uint64_t>(block.rows());
  auto columns = block.middleCols(static_cast<Eigen::Index>(source.first_channel),
                                  static_cast<Eigen::Index>(source.channels));
  if (source.samples_are_slow) {
    buffer_.resize(columns.rows(), columns.cols());
    if (!file_->read(source.variable, first, rows, 0, source.channels, buffer_.data()))
      return false;
    columns = buffer_;
    return true;
  }
  buffer_.resize(columns.rows(), 1);
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    if (!file_->read(source.variable, static_cast<std::uint64_t>(c), 1, first, rows,
                     buffer_.data()))
      return false;
    columns.col(c) = buffer_;
  }
  return true;
}

bool SampleSources::read_all(std::uint64_t first, Eigen::Ref<Samples> block) {
  return std::ranges::all_of(
      all_, [&](const Source& source) { return read_source(source, first, block); });
}

bool SampleSources::read(std::uint64_t first, Eigen::Ref<Samples> block, std::span<double> times) {
  if (!times_) return read_all(first, block);
  wide_.resize(block.rows(), block.cols() + 1);
  if (!read_all(first, wide_)) return false;
  const auto at = static_cast<Eigen::Index>(*times_), behind = block.cols() - at;
  block.leftCols(at) = wide_.leftCols(at);
  block.rightCols(behind) = wide_.rightCols(behind);
  if (!times.empty()) Eigen::Map<Eigen::VectorXd>(times.data(), wide_.rows()) = wide_.col(at);
  return true;
}

bool SampleSources::read_times(std::uint64_t first, std::span<double> out) {
  const auto source = std::ranges::find_if(
      all_, [&](const Source& one) { return times_.value() < one.first_channel + one.channels; });
  const std::size_t column = times_.value() - source->first_channel;
  if (!source->samples_are_slow)
    return file_->read(source->variable, column, 1, first, out.size(), out.data());
  const auto rows = static_cast<Eigen::Index>(out.size());
  buffer_.resize(rows, static_cast<Eigen::Index>(source->channels));
  if (!file_->read(source->variable, first, out.size(), 0, source->channels, buffer_.data()))
    return false;
  Eigen::Map<Eigen::VectorXd>(out.data(), rows) = buffer_.col(static_cast<Eigen::Index>(column));
  return true;
}

}  // namespace hydrapod::data
