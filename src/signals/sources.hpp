#pragma once
/// The signals behind Form. Private to the module.

#include <array>
#include <string_view>

#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/signals/signals.hpp"

namespace hydrapod::signals {

/// The names of the alternatives of Form.
inline constexpr std::array<std::string_view, std::variant_size_v<Form>> kinds{
    "step", "sine", "sweep", "chirp", "multisine", "white", "noise", "binary", "file"};

template <typename T>
constexpr bool is_random = std::is_same_v<T, Multisine> || std::is_same_v<T, White> ||
                           std::is_same_v<T, Noise> || std::is_same_v<T, Binary>;

/// One signal of a list: its samples k = 0, 1, 2, …, asked for in this order; 0 begins anew.
using Source = std::function<Sample(long k)>;

/// What all signals are made of. Signals of one list take different random numbers of one seed by
/// their `stream`, directions by stream + 0 … 5.
struct Context {
  Vector6 size{};
  double fade{};  ///< [s]
  double rate{};  ///< [Hz]
  std::uint64_t seed{};
  std::uint64_t stream{};

  [[nodiscard]] numerics::Gaussian random(std::size_t direction) const {
    return numerics::Gaussian(seed, stream + direction);
  }
};

Source make_source(const Step& step, const Context& context);
Source make_source(const Sine& sine, const Context& context);
Source make_source(const Sweep& sweep, const Context& context);
Source make_source(const Chirp& chirp, const Context& context);
Source make_source(const Multisine& multisine, const Context& context);
Source make_source(const White& white, const Context& context);
Source make_source(const Noise& noise, const Context& context);
Source make_source(const Binary& binary, const Context& context);
Source make_source(const Trajectory& trajectory, const Context& context);

/// w and dw/dt of a fade over `duration` that began `time` seconds ago.
struct Fade {
  double value{1.0}, rate{};
};
Fade fade_at(double time, double duration);

/// `sample` times the fade.
Sample faded(const Sample& sample, const Fade& fade);

long whole_samples(double seconds, double rate);
inline constexpr long longest_period = 10'000'000;  ///< [samples]

int active_directions(const Vector6& size);

long largest_prime_factor(long number);

/// Cycles per period of the first and the last line in a multisine's band.
std::pair<long, long> line_range(const Multisine& multisine, double rate);

/// Samples between two clock ticks and bits of the register of a binary sequence.
struct SequenceShape {
  long hold{};
  int bits{};
  [[nodiscard]] long length() const { return ((1L << bits) - 1) * hold; }
};
SequenceShape sequence_shape(const Binary& binary, double rate);

}  // namespace hydrapod::signals
