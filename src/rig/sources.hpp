#pragma once
/// The signals behind SignalSpec. Private to the module.

#include "hydrapod/rig/excitation.hpp"

namespace hydrapod::rig {

/// Signals of one list take different random numbers of one seed by their `stream`.
struct SourceContext {
  double rate{};  ///< [Hz]
  std::uint64_t seed{};
  std::uint64_t stream{};
};

std::unique_ptr<SignalSource> make_source(const WhiteNoise& spec, const SourceContext& context);
std::unique_ptr<SignalSource> make_source(const ShapedNoise& spec, const SourceContext& context);
std::unique_ptr<SignalSource> make_source(const Multisine& spec, const SourceContext& context);
std::unique_ptr<SignalSource> make_source(const BinarySequence& spec, const SourceContext& context);
std::unique_ptr<SignalSource> make_source(const SweptSine& spec, const SourceContext& context);
std::unique_ptr<SignalSource> make_source(const Chirp& spec, const SourceContext& context);

/// Throws std::invalid_argument "SIGNAL: PARAMETER is VALUE, expected EXPECTED" unless `sound`.
void require(bool sound, const char* what, double value, const char* expected);
/// Levels that are finite and not negative.
void require_levels(const char* signal, const Vector6& rms);
void require_band(const char* signal, double from, double to, double rate, bool from_zero);

/// A period that begins anew: one row per sample.
class PeriodicSource final : public SignalSource {
 public:
  explicit PeriodicSource(Eigen::Matrix<double, 6, Eigen::Dynamic> period);
  void restart() override { at_ = 0; }
  void add_next(Vector6& sample) override;

 private:
  Eigen::Matrix<double, 6, Eigen::Dynamic> period_;
  Eigen::Index at_{};
};

inline constexpr long longest_period = 10'000'000;  ///< [samples]
/// `seconds` in whole samples, checked against longest_period.
long whole_samples(const char* what, double seconds, double rate);

/// Samples between two clock ticks and bits of the register of a binary sequence.
struct SequenceShape {
  long hold{};
  int bits{};
  [[nodiscard]] long length() const { return ((1L << bits) - 1) * hold; }
};
SequenceShape sequence_shape(const BinarySequence& spec, double rate);

}  // namespace hydrapod::rig
