#pragma once
/// Tones in records whose inputs were measured: mains hum in sensors and drives, ripple of pumps.
/// Private to the module.
///
/// A tone has one complex amplitude per channel and an envelope e that all channels share,
///
///     x_c(t) = Re A_c e(t) e^(iωt),   e = 1, or a cubic spline where the frequency wanders.
///
/// It is subtracted from the samples of inputs, outputs and instruments. What is lost of each
/// channel is its projection on one known signal: y = H u remains true of the rest, and a mode at
/// the same frequency remains seen.
///
/// 1. Candidates: lines that stand out of the spectra of the references (inputs, or instruments)
///    and of what these do not explain of the other channels. Lines that hold most of the power of
///    a reference are its excitation. Periodic excitation is left out by differences of samples
///    that are one period apart.
/// 2. Around a candidate all channels are demodulated to a low rate. The combination uᴴz with the
///    largest ratio of the powers at the line and beside it, N⁻¹ times its eigenvector, is looked
///    at with the resolution of whole records.
/// 3. It is a tone, and not the response of a sharp resonance to noise, where its power stands out
///    of lines 3 or more resolutions 1/T away (T: length of a record), or where its modulus is more
///    nearly constant than that of a Gaussian process ever is: for J independent values of |e|²
///    the chance that their relative variance is < x is at most the share that a ball of radius
///    √(x/J) has in the simplex Σ p = 1.
/// 4. The envelope's knots are as close as the criterion of Schwarz asks for.
/// 5. A sharp mode, and a closed loop that is nearly unstable, have resonances that are as narrow.
///    Their amplitude comes and goes.

#include <functional>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/responses.hpp"
#include "names.hpp"

namespace hydrapod::identification {

struct ToneOptions {
  /// A candidate: power > stands_out · the level beside it and the median within `reach` lines, and
  /// more than chance makes once in 1/by_chance records of noise.
  double stands_out{3.0};
  double by_chance{0.1};
  int reach{20};
  /// … and > audible · the strongest line of the channel: less is rounding.
  double audible{1e-10};
  double wander{0.04};   ///< [Hz] that a tone's frequency may be from its mean: twice that of mains
  std::size_t most{32};  ///< candidates, the most conspicuous first
  /// … and no more than this holds, demodulated, times × channels (64 MiB): hours of many channels
  /// have room for a few.
  std::size_t most_numbers{std::size_t{1} << 22U};
  double of_excitation{0.5};  ///< share of a reference's power in lines that makes them excitation
  /// Chance that the power of noise stands so far out of what is around it.
  double resolved_chance{1e-5};
  double envelope_chance{3e-3};  ///< … that the modulus of noise is so nearly constant
  /// Fall of Schwarz's criterion, in units of ln likelihood, that a tone is worth.
  double evidence{10.0};
  double longest_window{1.0};  ///< [s] of the demodulation: a wandering tone turns little in that
  /// It is no tone, but a resonance that rings, where unevenness > comes_and_goes. What noise makes
  /// ring has 1 in the long run, and 0.4 to 1.3 in records as long as it rings. A tone whose
  /// amplitude changes by 30 % to either side has 0.2.
  double comes_and_goes{0.2};
};

/// e(t) by sample.
struct ToneEnvelope {
  double spacing{};                            ///< of knots [samples]; 0: constant
  VectorXcd coefficients{VectorXcd::Ones(1)};  ///< of cubic B-splines
  [[nodiscard]] Complex at(double sample) const;
};

/// A tone in one record.
struct ToneTrack {
  double omega{};  ///< [rad/sample]
  ToneEnvelope envelope{};
  VectorXcd amplitude{};  ///< A_c per channel; empty: none in this record
  double unevenness{};    ///< relative variance of |e|²; 0: constant
};

struct Tone {
  double frequency{};                ///< [Hz], mean over records
  std::vector<ToneTrack> records{};  ///< one per record
  VectorXd amplitude{};              ///< RMS over records of |A_c e|, per channel
  VectorXcd relative{};              ///< A_c of the record where it is strongest
  double unevenness{};               ///< mean over records
};

/// What is read of records: `channels`, after the first `settling` samples.
struct ToneReading {
  std::vector<std::size_t> channels{};
  std::int64_t settling{};
  int block{};  ///< block length, or period [samples]
  bool periodic{};
};

/// Lines of `spectra`, not periodic, at which there may be tones; ascending. `references`: channels
/// of the spectra that explain the others.
std::vector<Index> conspicuous_lines(const CrossSpectra& spectra,
                                     const std::vector<int>& references,
                                     const ToneOptions& options = {});

/// Ascending in frequency. `spectra`: of these records, `channels` of the reading; the records are
/// read again where there are candidates, and always where the excitation is periodic.
std::vector<Tone> find_tones(data::RecordSet& records, const ToneReading& reading,
                             const CrossSpectra& spectra, const std::vector<int>& references,
                             const ToneOptions& options = {});

/// Takes out of `tones` resonances that ring for as long as the record, driven by noise. To
/// subtract them is wrong: what a smooth envelope leaves of inputs and outputs is no longer related
/// by the machine.
std::vector<Tone> take_ringing(std::vector<Tone>& tones, const ToneOptions& options = {});

/// Subtracts tones from samples, all channels of the record, of which the first is number `first`.
void subtract_tones(const std::vector<Tone>& tones, const std::vector<std::size_t>& channels,
                    std::size_t record, std::int64_t first, data::Samples& samples);

/// Spectra with one line per tone, ½ A Aᴴ, in the channels of `like`: what follows from spectra for
/// other channels (to_platform) follows for amplitudes √(2 S_cc) from these.
CrossSpectra tone_spectra(const std::vector<Tone>& tones, const CrossSpectra& like);

}  // namespace hydrapod::identification
