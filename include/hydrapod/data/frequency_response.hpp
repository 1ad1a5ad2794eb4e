#pragma once
/// Frequency responses of several inputs and outputs, what is known of their errors, and their
/// Universal Files, tables of text, and files of arrays (MAT, HDF5).
///
/// H(f): output o per input i, in the units of the channels.
///
/// Values per line that copies share.
///
/// Responses of many outputs take hundreds of megabytes, nearly all for the covariance of their
/// noise, and are copied for every band and every trial. Here a copy, or a part of adjacent lines,
/// refers to the same values until one of them is changed, which copies first (its own part alone).

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record_io.hpp"

namespace hydrapod::data {

/// Reads and changes as std::vector<T> does. Two objects that share values may be used on two
/// threads; one object may be changed by several threads in different places once it has been
/// changed by one (resize() does), as nothing is copied then.
template <class T>
class PerLine {
 public:
  using value_type = T;
  using const_iterator = const T*;
  using iterator = T*;

  PerLine() = default;
  PerLine(std::vector<T> values)  // NOLINT(google-explicit-constructor): is a vector
      : all_(std::make_shared<std::vector<T>>(std::move(values))), size_(all_->size()) {}
  PerLine(std::initializer_list<T> values) : PerLine(std::vector<T>(values)) {}
  PerLine(const PerLine&) = default;
  PerLine& operator=(const PerLine&) = default;
  PerLine(PerLine&& other) noexcept { swap(other); }
  PerLine& operator=(PerLine&& other) noexcept {
    PerLine taken(std::move(other));
    swap(taken);
    return *this;
  }
  ~PerLine() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const T* data() const { return all_ ? all_->data() + first_ : nullptr; }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size_; }
  [[nodiscard]] const T& operator[](std::size_t k) const { return data()[k]; }
  [[nodiscard]] const T& front() const { return data()[0]; }
  [[nodiscard]] const T& back() const { return data()[size_ - 1]; }

  /// `count` lines from `first` on, which are shared.
  [[nodiscard]] PerLine part(std::size_t first, std::size_t count) const {
    PerLine some = *this;
    some.first_ += first;
    some.size_ = count;
    return some;
  }

  T* begin() { return own().data(); }
  T* end() { return own().data() + size_; }
  T& operator[](std::size_t k) { return own()[k]; }
  T& front() { return own().front(); }
  T& back() { return own().back(); }
  void resize(std::size_t size) {
    own().resize(size);
    size_ = size;
  }
  void reserve(std::size_t size) { own().reserve(size); }
  void push_back(T value) { emplace_back(std::move(value)); }
  template <class... Arguments>
  T& emplace_back(Arguments&&... arguments) {
    own().emplace_back(std::forward<Arguments>(arguments)...);
    ++size_;
    return all_->back();
  }
  void clear() { *this = PerLine(); }
  void assign(std::size_t size, const T& value) { *this = PerLine(std::vector<T>(size, value)); }

  friend bool operator==(const PerLine& a, const PerLine& b) {
    if (a.size_ != b.size_) return false;
    for (std::size_t k = 0; k < a.size_; ++k)
      if (!(a[k] == b[k])) return false;
    return true;
  }

 private:
  void swap(PerLine& other) noexcept {
    all_.swap(other.all_);
    std::swap(first_, other.first_);
    std::swap(size_, other.size_);
  }
  /// Values that nobody else refers to.
  std::vector<T>& own() {
    if (!all_)
      all_ = std::make_shared<std::vector<T>>();
    else if (all_.use_count() > 1 || size_ != all_->size())
      *this = PerLine(std::vector<T>(data(), data() + size_));
    else  // what the last other owner, perhaps another thread, has read was read before
      std::atomic_thread_fence(std::memory_order_acquire);
    return *all_;
  }

  std::shared_ptr<std::vector<T>> all_{};
  std::size_t first_{}, size_{};
};

/// How responses were estimated from spectra (identification/responses.hpp).
/// Half spectra are those of outputs, references standing for inputs.
enum class Estimator { h1, h2, hv, instrumental, half_spectra };
/// "h1", "h2", "hv", "iv", "half-spectra".
std::string_view estimator_text(Estimator estimator);
std::optional<Estimator> estimator_from_text(std::string_view text);

/// What a user should know of responses; report::warning_text has the words.
struct ResponseWarning {
  enum class Kind {
    dead_output,      ///< channel, left out; value: all its samples
    dead_input,       ///< channel; there are no responses to it
    repeated_input,   ///< channel, left out for `other`
    clipped,          ///< channel; share of its samples that are cut off at `lowest` or `highest`;
                      ///< value: of its power
    blocks_left_out,  ///< count, of total, for missing samples
    correlated_inputs,  ///< value: median of the condition
    biased,             ///< value: median of the relative deviation from the instrumental estimate;
                        ///< share of lines outside its 95 % band; estimator
    excited_band,      ///< instruments are seen in the inputs from `lowest` to `highest` [Hz] only,
                       ///< and not at `count` gaps in between
    interrupted,       ///< count: samples that were read
    lines_not_finite,  ///< count, of total, were left out
    missing_samples,   ///< count, of total, over all channels, most in channel: share; filled.
                       ///< value: share of the inputs' power that stays unknown and acts as noise
    single_block,      ///< count: records, each of them one hit and one block
    weak_excitation,   ///< value: the smallest F of the instruments for the inputs from `lowest` to
                       ///< `highest` [Hz]; share: of what is needed
    spikes,           ///< count, in channel, first at `value` [s] of a file; `highest`: the largest
                      ///< by what the samples beside it leave open; taken as missing
    hits_left_out,    ///< count, of total; value: less of them was recorded than this [s]
    repeated_output,  ///< channel has the samples of `other`
    held,             ///< channel; count: of its samples, in `total` runs at one value each, while
                      ///< inputs and other outputs move; share; value: the longest [s]; missing
    drop_outs,     ///< count: samples of all channels, in `total` runs in which all stand still at
                   ///< once; share; value: the longest [s]; taken as missing
    slow_channel,  ///< channel holds each of its values for `value` samples; `highest`: half of
                   ///< its own sample rate [Hz]; share of what is above that in an input, which
                   ///< cannot be told from what is below; count: 1: left out
    clipped_hits,  ///< count, of total, were left out: channel is cut off in them
    delayed,       ///< channel is later than `other` by value [s]; the responses are without that
    hum,         ///< of the input `channel` of hits, at value [Hz], share of its largest: taken out
    two_clocks,  ///< `count` of `total` outputs, the first `channel`, are later than `other` by
                 ///< value · t, in the end by `share` [s]; they are brought to its clock
    exponential_window,  ///< value: time constant [s] of the window that an analyser applied, whose
                         ///< damping is taken out; count: 1: the file says so
    wandering_tone,  ///< a vibration of constant amplitude at `value` [Hz] wanders by `share` of it
                     ///< to either side; spectra from `lowest` to `highest` [Hz] are left out for
                     ///< it
    short_record,    ///< modes are those of the record in one piece: it has `value` [s], `count`
                     ///< blocks of `share` [s] side by side, and averages need `total`; 0: the
                     ///< excitation is a sweep
    feedback,  ///< inputs follow outputs: these explain `share` of what the inputs' past does not
    motion_input,    ///< `count` of `total` inputs, the first `channel`, are motions that were
                     ///< measured: poles are those of the machine with these held
    sensor_changed,  ///< in a record, the file `other`, or from `lowest` to `highest` [s] of the
                     ///< only one, the output `channel` is `value` times what it is in the others;
                     ///< so are `count` of `total` outputs, each by its own factor
    lines_zero,      ///< at count, of total, a response is exactly 0, that of `channel` to `other`
                     ///< most often: these were left out
    two_sided,       ///< count, of total, lines above `value` [Hz], half the sample rate, are
                     ///< conjugates of those below in reverse: left out
    input_changed,   ///< as sensor_changed, of the input `channel` and `count` of `total` inputs
    lost_rows,  ///< at `count` places, the first at `value` [s] of the file `other`, most outputs
                ///< do not go on from where they were; `share` of the blocks hold one: these
                ///< are left out (`total`: places) or were needed (0)
    rings,      ///< a loop, at `value` [Hz], for longer than a block lasts: it is nearly unstable
    cut_sweep,  ///< the excitation is a sweep; `count` blocks of `value` [s] side by side cut it
                ///< into pieces, and `total` would do
    run_up  ///< outputs alone: what excites passes from `lowest` to `highest` [Hz] or back; half
            ///< of the power of a band between is there in `share` of the record (median)
  };
  Kind kind{};
  std::string channel{}, other{};
  double value{}, share{}, lowest{}, highest{};
  std::int64_t count{}, total{};
  Estimator estimator{Estimator::h1};
};

/// In the order of ResponseWarning::Kind.
inline constexpr std::array response_warning_names{"dead_output",
                                                   "dead_input",
                                                   "repeated_input",
                                                   "clipped",
                                                   "blocks_left_out",
                                                   "correlated_inputs",
                                                   "biased",
                                                   "excited_band",
                                                   "interrupted",
                                                   "lines_not_finite",
                                                   "missing_samples",
                                                   "single_block",
                                                   "weak_excitation",
                                                   "spikes",
                                                   "hits_left_out",
                                                   "repeated_output",
                                                   "held",
                                                   "drop_outs",
                                                   "slow_channel",
                                                   "clipped_hits",
                                                   "delayed",
                                                   "hum",
                                                   "two_clocks",
                                                   "exponential_window",
                                                   "wandering_tone",
                                                   "short_record",
                                                   "feedback",
                                                   "motion_input",
                                                   "sensor_changed",
                                                   "lines_zero",
                                                   "two_sided",
                                                   "input_changed",
                                                   "lost_rows",
                                                   "rings",
                                                   "cut_sweep",
                                                   "run_up"};
static_assert(response_warning_names.size() ==
              static_cast<std::size_t>(ResponseWarning::Kind::run_up) + 1);

/// A vibration of constant amplitude, as machines that turn make it: no resonance.
struct Harmonic {
  double frequency{};           ///< [Hz]
  Eigen::VectorXd amplitude{};  ///< per output, in its unit
  double wander{};              ///< [Hz] that its frequency goes to either side; 0: it is constant
};

/// What errors of half spectra follow from: spectra of all outputs, whose errors at different lines
/// are independent.
struct OutputSpectra {
  /// Σ_k R_k e^(−iωkT) at even lines from 0 to half the sample rate, outputs × outputs.
  std::vector<Eigen::MatrixXcd> S{};
  double samples{};               ///< as many as R_k are means of
  double averages{};              ///< of S
  std::vector<int> references{};  ///< the outputs that stand for inputs
};

/// What the window of blocks lets in from beside a line, under random excitation: to first order a
/// part R H' Q⁻¹ H'ᴴ of the noise, H' = dH/dω. Neighbouring lines share it in another way than
/// noise. With C Cᴴ = Q⁻¹ it is H' C g C⁻¹, E[g_ij,k g*_ij,k+d] = R a_d and E[g_ij,k g_ji,k+d] = R
/// b_d at the lines k and k + d.
struct Leakage {
  double rate{};                          ///< R [1/s²]
  std::vector<double> line_covariance{};  ///< a_d, d = 0, 1, …; empty: leakage is not known
  std::vector<double> relation{};         ///< b_d, as many
};

/// Frequency responses with what is known of their errors. All vectors over lines have one length.
/// Copies share the matrices of their lines.
struct FrequencyResponses {
  std::string title{};
  std::string date{};  ///< ISO 8601
  std::vector<data::Channel> inputs{}, outputs{};
  std::vector<double> frequency{};  ///< [Hz], ascending
  PerLine<Eigen::MatrixXcd> H{};    ///< outputs × inputs
  Geometry geometry{};              ///< of the points of the channels
  /// What a Universal File of another program says of each response, up to five lines; response
  /// (o, i) at o · inputs + i. Empty: nothing.
  std::vector<std::vector<std::string>> id_lines{};
  /// cov(H_oi, H_pj*) = noise(o, p) · input_factor(j, i). Empty: errors are not known.
  PerLine<Eigen::MatrixXcd> noise{};         ///< S_vv/K, outputs × outputs
  PerLine<Eigen::MatrixXcd> input_factor{};  ///< Q, inputs × inputs
  /// Spectra U of a whole record, a number per input. Where they are given, H U alone is known at
  /// a line, with the covariance `noise`; H is the smallest matrix that has it. No file holds them.
  PerLine<Eigen::VectorXcd> excitation{};
  double degrees{};  ///< K − p: of freedom of the noise estimate; 0: not known
  /// E[e_k e*_{k+d}]/E|e_k|² of neighbouring lines, d = 0, 1, …
  std::vector<std::complex<double>> line_covariance{1.0};
  Leakage leakage{};  ///< a part of `noise`
  /// a: H is at s = a + iω; 0: on the imaginary axis [1/s]
  double shift{};
  /// H(iω) by a modal model, for other programs and for pictures; only where shift > 0.
  PerLine<Eigen::MatrixXcd> on_axis{};
  /// ρ_τ at lag τ / sample_rate, the autocorrelation of the window of the estimate; empty where
  /// resonances are not widened.
  Eigen::VectorXd taper{};
  double sample_rate{};  ///< [Hz] of the taper

  /// Of half spectra; else null.
  std::shared_ptr<const OutputSpectra> whole{};
  std::vector<Harmonic> harmonics{};  ///< found in the outputs and taken out; ascending

  // What tells how good the measurement is; empty for responses from a file.
  Estimator estimator{Estimator::h1};
  double averages{};                              ///< K
  PerLine<Eigen::MatrixXd> coherence{};           ///< |S_oi|²/(S_oo S_ii), outputs × inputs
  PerLine<Eigen::VectorXd> multiple_coherence{};  ///< share of S_oo that H explains
  /// Largest by smallest eigenvalue of the inputs' coherence matrix (singular values for the
  /// instrumental estimate): 1 is best.
  std::vector<double> condition{};
  PerLine<Eigen::VectorXd> input_density{};  ///< S_uu [unit²/Hz]
  std::vector<ResponseWarning> warnings{};

  [[nodiscard]] std::size_t lines() const { return frequency.size(); }
  [[nodiscard]] bool has_errors() const { return !noise.empty(); }
  /// E|Ĥ_oi − H_oi|² at a line; sum of the variances of real and imaginary part.
  [[nodiscard]] double variance(std::size_t line, Eigen::Index output, Eigen::Index input) const;
};

/// Throws std::invalid_argument naming what does not fit: sizes, frequencies that do not ascend or
/// are not finite, channels as validate(RecordHeader) has them.
void validate(const FrequencyResponses& responses);

/// The responses that other programs and pictures show: on_axis in place of H. Errors and
/// covariance of lines remain those of H, without the error of the model that brought it there.
FrequencyResponses brought_to_axis(FrequencyResponses responses);

// Files of responses. H(iω) is written as other programs expect it, and beside it what
// identification needs, in a form that they pass over: the whole noise and input factor per line,
// H(a + iω) where there is a shift, and in comment lines the channels, the estimator, the
// covariance of lines and the taper of the window. So what is read gives the same modes and
// intervals as what was written. Both writers throw std::invalid_argument for responses at a + iω
// without `on_axis`.

/// Datasets 151, 164, 99001 (comment lines) and per output and input one dataset 58 (type 4,
/// complex double; multiple coherence type 26). What other programs do not know is of type 0 and
/// has its name in its first line: "variance", "noise", "input factor", "beside the axis".
/// Frequencies even within 1e-6 of their spacing are written as such, others one by one (to six
/// digits; binary: all digits). `binary`: 58b. Written whole or not at all. Throws as
/// base::write_file_whole.
void write_frequency_responses(const std::string& path, const FrequencyResponses& responses,
                               bool binary = true);

/// Comment lines, a row of titles and a row per line: `frequency_hz`, and per output o and input i
/// `re o/i`, `im o/i`, `deviation o/i`; then `coherence o` and `condition`. The last columns are
/// those that identification needs: `beside the axis re o/i …`, `noise re o/p …` and `input factor
/// re i/j …`, lower triangles.
std::string response_table(const FrequencyResponses& responses);

/// `frequency_hz` (lines), `response` (outputs × inputs × lines, complex), and where they are known
/// `deviation`, `coherence`, `condition`; the names and units of outputs and inputs; and what
/// identification needs: `noise`, `input_factor`, `beside_axis` and the text `description`.
/// Throws as response_table().
std::vector<MatVariable> response_arrays(const FrequencyResponses& responses);

struct ReadFrequencyResponsesResult {
  FrequencyResponses responses{};
  std::vector<base::Diagnostic> notes{};
};

/// A Universal File, a table of text, or a MAT or HDF5 file. Of a Universal File all functions of
/// type 4 that share the first one's frequencies, with their coherences and variances. Units become
/// SI: labels that are known, else dataset 164. Variances V_oi without the noise become noise and
/// input factor V_oi ≈ n_o q_i, by their means over rows and columns. Of arrays of other programs
/// those that are complex and as long as the list of frequencies; of the other indices the first
/// counts outputs, the second inputs. Throws base::InputError, also where a pair of output and
/// input is missing, and where arrays can be understood in several ways.
ReadFrequencyResponsesResult read_frequency_responses(const std::string& path);

}  // namespace hydrapod::data
