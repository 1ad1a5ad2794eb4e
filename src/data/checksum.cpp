#include "checksum.hpp"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace hydrapod::data {

static_assert(std::endian::native == std::endian::little);

struct Checksum::State {
  XXH3_state_t sum;
  std::int64_t samples{};

  void add(const double* values, Eigen::Index count) {
    using Values = Eigen::ArrayXd;
    const Eigen::Map<const Values> given(values, count);
    const auto update = [&](const double* from) {
      XXH3_64bits_update(&sum, from, static_cast<std::size_t>(count) * sizeof(double));
    };
    // 0 times NaN or infinity is NaN
    if ((0.0 * given).sum() == 0.0) return update(values);
    Values same = given;
    for (double& value : same)
      if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
    update(same.data());
  }
};

Checksum::Checksum(const RecordHeader& header) : state_(std::make_unique<State>()) {
  XXH3_64bits_reset(&state_->sum);
  std::string text = fmt::format("{}\n{}\n{}\n", header.sample_rate, header.start, header.repeat);
  for (const Channel& c : header.channels)
    text += fmt::format("{}\n{}\n{}\n{}\n{}\n", c.name, c.unit, direction_text(c.direction),
                        role_text(c.role), c.point);
  XXH3_64bits_update(&state_->sum, text.data(), text.size());
}

Checksum::~Checksum() = default;

void Checksum::add(const Eigen::Ref<const Samples>& samples) {
  state_->samples += samples.rows();
  if (samples.outerStride() != samples.cols()) {  // rows are apart
    for (Eigen::Index row = 0; row < samples.rows(); ++row)
      state_->add(samples.row(row).data(), samples.cols());
    return;
  }
  constexpr Eigen::Index piece = 4096;  // that stays in the cache between the two looks at it
  for (Eigen::Index at = 0; at < samples.size(); at += piece)
    state_->add(samples.data() + at, std::min(piece, samples.size() - at));
}

std::string Checksum::text() const {
  XXH3_state_t sum = state_->sum;
  XXH3_64bits_update(&sum, &state_->samples, sizeof state_->samples);
  return fmt::format("xxh3:{:016x}", XXH3_64bits_digest(&sum));
}

}  // namespace hydrapod::data
