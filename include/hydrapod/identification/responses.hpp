#pragma once
/// Frequency responses of several inputs and outputs from cross spectra.
///
///     Y = H U + V      u: inputs, y: outputs, r: instruments; V: what does not come from u
///
///     H1 = S_yu S_uu⁻¹             no noise in u; V independent of u
///     H2 = S_yy S_uy⁻¹             no noise in y; as many outputs as inputs
///     Hv                           noise in all channels, in proportion to their level at the
///                                  line: per output the smallest eigenvector of the coherence
///                                  matrix of (u, y_o) (total least squares)
///     instrumental = S_yr S_ur⁻¹   r reaches y only through u and is independent of V, as the
///                                  external excitation of a closed loop is; as many r as u
///
/// In closed loop u holds part of V, and H1 from u to y is biased; from the external excitation r
/// to y it is not, and then shows the closed loop's modes.
///
/// Variance. With G = S_uu⁻¹ (H1, H2, Hv) or S_ur⁻¹, and R = u or r,
///
///     S_vv = (I, −H) S_(y,u) (I, −H)ᴴ · K/(K − p),   cov(H_oi, H_pj) = (S_vv)_op Q_ji / K,
///     Q = Gᴴ S_RR G,
///
/// K effective averages, p inputs; to first order in the noise. |Ĥ_oi − H_oi|² / var(H_oi) is then
/// distributed as F(2, 2 (K − p)): confidence_radius(). Periodic excitation: S_vv from what differs
/// between periods, and K the number of periods, over all records.
///
/// Sources: J. S. Bendat, A. G. Piersol, Random Data, 4th ed. (2010), ch. 7 and 9; R. Pintelon,
/// J. Schoukens, System Identification: A Frequency Domain Approach, 2nd ed. (2012), ch. 2 and 7;
/// G. T. Rocklin, J. Crowley, H. Vold, IMAC 3 (1985) 272 (Hv).
///
/// Windows of spectral estimates, and what they do to statistics and to responses.
///
/// Cross spectra of all channels of a record, from samples that stream past.
///
/// Blocks of n samples, D apart (Welch), lose the mean of their record (over its blocks), get a
/// window and are transformed once per channel, z_k = (Z_1 … Z_c)ᵀ at line f_k = k f_s/n. Averaged
/// over the blocks,
///
///     S(f_k) = c_k/(f_s Σ w²) · mean of z_k z_kᴴ,   c = 1 at k = 0 and n/2, else 2,
///
/// is the one-sided density [unit²/Hz]: S_ij = E[Z_i Z_j*]. Memory: n · c for the samples and
/// c (c + 1)/2 complex numbers per line, whatever the length of the record.
///
/// Periodic excitation: blocks are whole periods, without window and overlap. They are averaged as
/// transforms over the periods of a record, z̄, and S = mean over the records of z̄ z̄ᴴ; what
/// differs from period to period is the noise, N = mean of (z − z̄)(z − z̄)ᴴ · m/(m − 1).
///
/// From what sensors measure to directions of the platform.
///
/// Small motions about the pose: leg lengths l = J_l_q q, so q = J_l_q⁻¹ l with q = (x, y, z, rx,
/// ry, rz) of the point Q in base axes. Drives, to which the legs' speeds are proportional, are
/// brought to directions in the same way. Accelerometers at p_k with axis e_k, both in base axes,
/// measure a_k = e_kᵀ (q̈_lin + q̈_rot × (p_k − Q)); six or more that see all directions give q̈ by
/// least squares.
///
/// Half spectra of outputs whose excitation was not measured.
///
/// Under excitation that is white over the band, covariances at lags k ≥ 0 are a free decay,
///
///     R_k = E[y(t + kT) r(t)ᵀ] = Σ_r φ_r g_rᵀ e^(λ_r kT) + conj.,
///
/// r being some of the outputs, the references. Their half spectrum
///
///     S⁺(ω) = T Σ_(k ≥ 0) ε_k τ_k R_k e^(−iωkT),   ε_0 = ½, else 1,
///
/// has the modal form of frequency responses, with references for inputs and g for
/// participations, and goes through the same identification. R_k is the inverse transform of the
/// averaged spectra, for k < L = n/2; it holds the ρ_k of their window, and τ_k = ρ_k cos²(πk/2L)
/// is the taper that the modal model knows of. Sensor noise is in R_0 alone: a constant.
///
/// Errors of S⁺ at all lines depend on each other: those of a strong resonance reach far, in the
/// form of its own flank, which the fit takes for a part of the resonance. The variances that are
/// given per line, T²/N mean over ν of |Q(ω − ν)|² S_oo(ν) S_ii(ν) as a product of a number for o
/// and one for i, are those without what reaches so far; they weigh the lines. Intervals follow
/// from output_errors.hpp.
///
/// Sources: B. Cauberghe, Applied frequency-domain system identification in the field of
/// experimental and operational modal analysis, PhD, Vrije Universiteit Brussel (2004); J. S.
/// Bendat, A. G. Piersol, Random Data, 4th ed. (2010), ch. 8.
///
/// From record files to frequency responses without a choice to make.
///
/// Inputs are the channels with the role drive where there are as many excitations that are
/// commands (not forces): the modes are then those of the machine without its controller. Else they
/// are the channels with the role excitation, else those with the role drive. Outputs are those
/// with the role response; among sensors of several kinds the platform's motion in six directions,
/// else the six leg lengths. Estimator: H1 from excitations; from drives, the instrumental estimate
/// where there are as many excitations, else H1. Block length: a power of two, so that there are
/// some 4 p + 8 blocks side by side for p inputs, half as many for the instrumental estimate, and
/// p + 2 in short records. Excitation that repeats exactly is averaged over whole periods.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/record.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/numerics/parallel.hpp"

namespace hydrapod::identification {

/// Tukey's is tapered over half of its length, as programs have it unless told otherwise.
enum class Window { hann, rectangular, hamming, blackman_harris, flat_top, blackman, tukey };

/// "hann", "rectangular", "hamming", "blackman-harris", "flat-top", "blackman", "tukey".
std::string_view window_text(Window window);
std::optional<Window> window_from_text(std::string_view text);

/// w_t, t = 0 … n − 1, periodic: w_t = Σ_j (−1)^j a_j cos(2π j t/n).
Eigen::VectorXd window_samples(Window window, int length);

/// Statistics of averages over K blocks of length n whose starts are D samples apart, for noise
/// whose spectrum is flat over a few lines. With
///
///     c(m, d) = Σ_t w_t w_{t + mD} e^(−2πi d t/n) / Σ_t w_t²
///
/// the covariance of a cross spectrum between the lines k and k + d is proportional to
///
///     a_d = 1/K Σ_m (1 − |m|/K) |c(m, d)|²,   |m| < K.
struct AverageStatistics {
  double effective_averages{};          ///< 1/a_0: as many independent blocks would be as good
  std::vector<double> line_covariance;  ///< a_d/a_0, d = 0, 1, … while it is above 1e-4
  /// Of what the window lets in from beside a line: Σ w'²/Σ w² [1/sample²], w' = dw/dt, and as many
  /// a'_d/a_0, with c'(m, d) c(m, d)* for |c|², c' being formed of w'. (The error of a block is
  /// H'(ω) times i times the transform of w'_t u_t.)
  double leakage_rate{};
  std::vector<double> leakage_covariance;
  /// The same of the relation, E[e_k e_{k+d}]: −x(m, d) y(m, d)* for |c|², x of w_t w'_{t + mD}, y
  /// of w'_t w_{t + mD}. What several lines have in common turns hardly any frequency.
  std::vector<double> leakage_relation;
};
AverageStatistics average_statistics(const Eigen::VectorXd& window, int hop, long blocks);

/// ρ_τ = Σ_t p_t w_t w_{t+τ} / Σ_t p_t w_t², τ = 0 … n − 1. Under white excitation, whose mean
/// square at a sample of the block is p_t, an averaged cross spectrum is, in the mean, the
/// transform of the impulse response times ρ: a window makes resonances wider, by an amount that is
/// known. p is 1 where it is not given; bursts that begin where blocks begin have another one, and
/// also what does not fit into a block any more is then known.
Eigen::VectorXd lag_taper(const Eigen::VectorXd& window, const Eigen::VectorXd& power = {});

/// Responses of a file that does not say with which window they were averaged, if with any: when
/// one is taken to be known. Without it modes leave more than noise, with it noise alone.
struct WindowOptions {
  /// Modes leave this share of the responses (RMS) or more: averages under random excitation leave
  /// 0.02 and more, and what a window adds to less is little beside it.
  double least_left{0.01};
  /// The same modes leave, RMS, with the window < clearly · what they leave without it. Without a
  /// window the two are alike: a fit of poles takes up what is no more than rounding of peaks.
  double clearly{0.97};
  /// BIC without it − BIC with it > evidence: "very strong" by Kass and Raftery, J. Am. Stat.
  /// Assoc. 90 (1995) 773.
  double evidence{10.0};
  /// Lines are multiples of their distance to this share of it: digits of a text file. Of all
  /// multiples between the first and the last line at least half are there.
  double rounded{0.02}, filled{0.5};
  int longest{1 << 16};  ///< samples of the taper at most, four per period of the last line
};

struct SpectrumOptions {
  int block_length{};           ///< n [samples], even, at least 8
  double overlap{0.5};          ///< 0 … < 1, share of a block that the next one has too
  Window window{Window::hann};  ///< for periodic excitation there is none
  bool periodic{};              ///< blocks are periods
  int threads{};                ///< 0: one per processor; the result is the same
  int lines{};                  ///< only the first so many; 0: all
  std::vector<int> inputs{};    ///< channels whose power over the block is wanted
  /// Their power over the block counts where it changes lag_taper by more than `uneven`. Of a
  /// stationary input it is even but for chance, which changes ρ by some (2/(blocks · n))^½.
  double uneven{0.05};
};

/// What a look at a channel's samples tells.
struct ChannelHealth {
  std::int64_t samples{};
  std::int64_t missing{};  ///< NaN or infinite
  /// Cut off at the highest or lowest value, or 0 where these look like the end of a signal in
  /// steps of its resolution: more than a few say that it was clipped.
  std::int64_t at_limit{};
  /// At the highest or lowest value in flat tops, whose flanks are too steep for a rounded one:
  /// they say that it was clipped, however few they are.
  std::int64_t in_flat_tops{};
  std::int64_t longest_hold{};  ///< samples at one value in succession, where that is long; else 0
  double lowest{}, highest{};
  /// Samples from there on were cut off; not finite: at this end none was.
  double cut_below{std::numeric_limits<double>::quiet_NaN()}, cut_above{cut_below};
  double held_samples{1.0};  ///< that each value lasts, in the mean, where all last alike
  [[nodiscard]] bool constant() const { return samples > missing && !(highest > lowest); }
};

struct CrossSpectra {
  std::vector<data::Channel> channels{};
  double sample_rate{};  ///< [Hz]
  SpectrumOptions options{};
  Eigen::VectorXd window{};        ///< w_t
  std::int64_t blocks{};           ///< that were averaged
  std::int64_t blocks_left_out{};  ///< for a missing sample
  int records{};                   ///< that held at least one block
  AverageStatistics statistics{};
  std::vector<ChannelHealth> health{};
  /// Mean square of the inputs that the options name at each sample of a block, each input in
  /// proportion to its own power; mean 1. Empty: they name none, or blocks are periods.
  Eigen::VectorXd input_power{};
  /// Pair (i, j), i ≥ j, is column i (i + 1)/2 + j; a row per line.
  Eigen::MatrixXd re{}, im{};
  Eigen::MatrixXd noise_re{}, noise_im{};  ///< N, for periodic excitation; else empty

  [[nodiscard]] Eigen::Index lines() const { return re.rows(); }
  [[nodiscard]] double frequency(Eigen::Index line) const {
    return static_cast<double>(line) * sample_rate / options.block_length;
  }
  /// S or N at a line, Hermitian.
  [[nodiscard]] Eigen::MatrixXcd at(Eigen::Index line) const;
  [[nodiscard]] Eigen::MatrixXcd noise_at(Eigen::Index line) const;
};

/// What averaging made of impulse responses under the inputs as they were.
Eigen::VectorXd lag_taper(const CrossSpectra& spectra);

class SpectrumEstimator {
 public:
  /// Of these channels of `header` (all of them when none is named). Throws std::invalid_argument
  /// for options that make no sense.
  SpectrumEstimator(const data::RecordHeader& header, const SpectrumOptions& options,
                    const std::vector<std::size_t>& channels = {});
  ~SpectrumEstimator();
  SpectrumEstimator(SpectrumEstimator&&) noexcept;
  SpectrumEstimator& operator=(SpectrumEstimator&&) noexcept;

  /// The next samples of the record, all its channels.
  void add(const Eigen::Ref<const data::Samples>& samples);
  /// What comes next is another record: no block reaches over the border. Its first `settling`
  /// samples are passed over.
  void begin_record(std::int64_t settling = 0);
  /// Of what has come so far.
  [[nodiscard]] CrossSpectra result();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Samples after which excitation repeats, to within `tolerance` of its RMS; 0: it does not.
/// `samples`: one signal, at least three periods of it; those that are missing tell nothing.
std::int64_t period_of(const Eigen::VectorXd& samples, double tolerance = 1e-3);

struct LinearSensor {
  spatial::Vector3 position{};  ///< in B [m]
  spatial::Vector3 axis{};      ///< unit vector in B
};

/// q from leg lengths, 6×6. Throws base::ComputationError at a singular pose.
Eigen::MatrixXd platform_from_legs(const model::Machine& machine, const spatial::Pose& X_BP,
                                   const spatial::Vector3& p_BQ);

/// q̈ from accelerations, 6×n. Throws base::ComputationError when the sensors do not see all
/// directions.
Eigen::MatrixXd platform_from_accelerometers(const std::vector<LinearSensor>& sensors,
                                             const spatial::Vector3& p_BQ);

/// The spectra with `channels` replaced by six platform channels, `map` times the former, which
/// come last; the numbers of the other channels close up. Names: `prefix` and x … rz. Units: those
/// of a length channel give "m" and "rad" with the same powers of time, those of drives "1" and
/// "1/m".
CrossSpectra to_platform(const CrossSpectra& spectra, const std::vector<int>& channels,
                         const Eigen::MatrixXd& map, const std::string& prefix = {});

/// The channels of a role with the directions from `first` (x or leg 1) on in their order, if all
/// six are there once; those with one of `units`, or with any where there are none.
std::optional<std::vector<int>> six_channels(const std::vector<data::Channel>& channels,
                                             data::Role role, data::Direction first,
                                             const std::vector<std::string_view>& units = {});

using data::Estimator;
using data::FrequencyResponses;

/// Which channels of the spectra are what.
struct ChannelChoice {
  std::vector<int> inputs{}, outputs{}, instruments{};
};

/// Lines from `lowest_line` on; the first ones hold what is left of the mean. Throws
/// base::ComputationError where nothing sensible can come out: too few averages, inputs that are
/// linearly dependent, nothing on an input. Dead outputs and inputs that repeat another are left
/// out with a warning.
FrequencyResponses estimate_responses(const CrossSpectra& spectra, const ChannelChoice& choice,
                                      Estimator estimator);

struct HalfSpectraOptions {
  int most_references{4};      ///< more hardly see another mode and cost time
  double below_nyquist{0.45};  ///< f ≤ this · sample rate: the pass band of anti-alias filters
  /// [Hz], of vibrations whose frequency wanders: from where to where. They are left out.
  std::vector<std::array<double, 2>> wandering{};
};

/// Half spectra of `outputs`, channels of the spectra. Harmonics are taken out and listed. Throws
/// base::ComputationError where there are too few averages.
FrequencyResponses half_spectra(const CrossSpectra& spectra, const std::vector<int>& outputs,
                                const HalfSpectraOptions& options = {});

/// |Ĥ − H| stays below this, in standard deviations √variance, with the given probability.
double confidence_radius(double probability, double degrees);

/// Largest difference between H1 and the instrumental estimate against its own 95 % radius, and at
/// which share of the lines it is beyond: says whether H1 from u is biased. `share` near 0.05 is
/// what chance gives.
struct BiasFinding {
  double share{};   ///< of entries × lines beyond their 95 % radius
  double median{};  ///< of |H1 − H| / |H|
};
BiasFinding compare_responses(const FrequencyResponses& plain,
                              const FrequencyResponses& instrumental);

/// Of which records the modes are estimated in one piece (MeasureOptions::whole_record), see
/// identify.hpp: those with
///
///     Σ over records of samples/block   <   fewest · max(4, inputs + 2)
///
/// for the block length that would be chosen. Block lengths are powers of two: with fewest > √2
/// these are all records whose blocks had to be shorter than `short_block`. There the averages that
/// the inputs and the noise's covariance take leave next to none.
struct FewBlocks {
  double fewest{1.5};
  /// Unasked only with lines ≤ few_lines in the band where the outputs are heard, which take two
  /// seconds or three, or with fewer blocks than max(3, inputs + 1), of which averages give
  /// nothing.
  double few_lines{1200.0};
  /// Not where inputs follow outputs: the outputs' past explains > feedback of what the inputs' own
  /// does not, and more than chance does once in 1/feedback_chance records.
  double feedback{0.05}, feedback_chance{1e-4};
};

/// A machine at a pose: brings leg lengths to directions of the platform at Q.
struct PlatformFrame {
  model::Machine machine{};
  spatial::Pose X_BP{};
  spatial::Vector3 p_BQ{};  ///< [m]
};

/// Excitation fills the band where density > quiet · that of its strongest line at a share ≥
/// most_lines of the lines below pass_band · half the sample rate.
struct FilledBand {
  double pass_band{0.9};    ///< above, filters of the recorder end any signal
  double quiet{1e-3};       ///< white noise in a single block is hardly ever below
  double most_lines{0.95};  ///< not all: some lines of white noise are
};

struct MeasureOptions {
  std::vector<std::string> inputs{}, outputs{}, instruments{};  ///< channel names; empty: by role
  /// Role of the inputs, excitation or drive; default: as said above.
  std::optional<data::Role> input_role{};
  std::optional<Estimator> estimator{};
  std::optional<int> block_length{};  ///< [samples]
  std::optional<double> overlap{};
  /// Lines × pairs of channels ≤ most_spectra where the block length is not given: 64 MiB. Longer
  /// records have more averages then, not finer lines.
  std::size_t most_spectra{std::size_t{1} << 22U};
  /// Samples × channels of all records ≤ most_kept: they are kept while they are read several
  /// times.
  std::int64_t most_kept{std::int64_t{1} << 23};
  /// [samples] Block length < short_block, where it is not given, only where p + 2 blocks side by
  /// side, for p inputs, would be longer than the record: of short records, longer blocks are worth
  /// more than many averages.
  int short_block{1 << 12};
  /// Modes are wanted: of records with few blocks, where no option says how to average them, the
  /// samples are kept for identify_modes(Measurement), and responses are those of a model of them.
  bool for_modes{};
  /// Modes of short records (FewBlocks) from the whole record at once. True: or
  /// base::ComputationError where that cannot be, as in a loop; false: never; none: where inputs do
  /// not follow outputs.
  std::optional<bool> whole_record{};
  FewBlocks few_blocks{};
  Window window{Window::hann};
  FilledBand filled{};  ///< what fills it less is averaged with an overlap of 3/4 in a loop
  std::optional<double> period{};  ///< [s] of the excitation; 0: not periodic; default: found out
  double settling{};               ///< [s] at the beginning of each record that are passed over
  std::optional<PlatformFrame> platform{};  ///< for responses that are the six leg lengths
  /// 6 × `outputs`: makes directions of the platform of them, see platform_from_accelerometers.
  std::optional<Eigen::MatrixXd> outputs_to_platform{};
};

/// What was found out about records to read them: period, gaps, tones; and the samples of short
/// ones. Private to the module.
struct Reading;
struct ShortRecord;

struct Measurement {
  FrequencyResponses responses{};
  CrossSpectra spectra{};
  ChannelChoice choice{};                 ///< of the spectra, by measure_responses
  data::RecordHeader header{};            ///< of the first record
  std::vector<base::Diagnostic> notes{};  ///< of the readers
  std::int64_t samples{};                 ///< of all records that were read
  bool interrupted{};
  bool from_legs{};  ///< the responses were brought from leg lengths to the platform
  std::optional<BiasFinding> h1_against_instrument{};  ///< where both could be formed
  std::shared_ptr<const Reading> reading{};     ///< by measure_responses; none: records of hits
  std::shared_ptr<const ShortRecord> record{};  ///< of records with few blocks, for modes
};

/// What of responses identify_modes() uses: without lines and channels that hold no measurement,
/// with warnings that say so. Throws base::ComputationError where nothing is left.
FrequencyResponses usable_responses(const FrequencyResponses& responses);

/// Modes of responses are those of the machine where inputs are forces or commands. Measured
/// motions for inputs (by their units; their role is neither excitation nor drive) hold these
/// motions: where outputs are motions too, a warning `motion_input`; where all outputs are forces,
/// the responses are inverse ones, and base::InputError names `file`.
std::vector<data::ResponseWarning> check_inputs(const std::string& file,
                                                const std::vector<data::Channel>& inputs,
                                                const std::vector<data::Channel>& outputs);

/// The records are averaged together; where modes are wanted, after check_inputs(). Where
/// `progress` asks to stop the rest is left unread. Throws base::InputError and
/// base::ComputationError.
Measurement measure_responses(data::RecordSet& records, const MeasureOptions& options,
                              const numerics::Progress& progress = {});

/// Half spectra for responses, for machines whose excitation was not measured; dead outputs are
/// left out with a warning.
Measurement measure_outputs(data::RecordSet& records, const MeasureOptions& options,
                            const numerics::Progress& progress = {});

/// The record in pieces, for bootstrap.hpp: spectra of groups of neighbouring blocks, formed as
/// measure_responses would, and what is input and output among their channels.
struct GroupedSpectra {
  std::vector<CrossSpectra> groups{};
  ChannelChoice choice{};
  Estimator estimator{Estimator::h1};
};

/// In at most `groups` pieces, each at least two blocks long. Throws as measure_responses, and
/// base::ComputationError for periodic excitation, whose periods are no blocks to draw from.
GroupedSpectra measure_groups(data::RecordSet& records, const MeasureOptions& options, int groups,
                              const numerics::Progress& progress = {});

/// The same with what measure_responses found out, given these records and options: they are read
/// once. `highest` [Hz]: lines above may be left out, which the instrumental estimate needs.
GroupedSpectra measure_groups(data::RecordSet& records, const Measurement& measured,
                              const MeasureOptions& options, int groups,
                              const numerics::Progress& progress = {},
                              std::optional<double> highest = {});

}  // namespace hydrapod::identification
