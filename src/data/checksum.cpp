#include "checksum.hpp"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <bit>
#include <cmath>
#include <limits>

namespace hydrapod::data {

static_assert(std::endian::native == std::endian::little);

struct Checksum::State {
  XXH3_state_t sum;
  std::int64_t samples{};
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
  const auto update = [&](const Samples& block) {
    XXH3_64bits_update(&state_->sum, block.data(),
                       static_cast<std::size_t>(block.size()) * sizeof(double));
  };
  if (samples.hasNaN()) {
    Samples same = samples;
    for (double& value : same.reshaped())
      if (std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
    return update(same);
  }
  if (samples.outerStride() != samples.cols()) return update(samples);  // rows are apart
  XXH3_64bits_update(&state_->sum, samples.data(),
                     static_cast<std::size_t>(samples.size()) * sizeof(double));
}

std::string Checksum::text() const {
  XXH3_state_t sum = state_->sum;
  XXH3_64bits_update(&sum, &state_->samples, sizeof state_->samples);
  return fmt::format("xxh3:{:016x}", XXH3_64bits_digest(&sum));
}

}  // namespace hydrapod::data
