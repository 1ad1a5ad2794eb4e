#pragma once
/// From frequency responses to modes without a choice to make.
///
/// 1. Band: from the first to the last frequency at which the responses stand above their noise,
///    narrowed to what poles need where all lie in its lower part.
/// 2. Poles of all model orders, clusters of those that come back (poles.hpp).
/// 3. Maximum-likelihood fit of the modal model to all of them.
/// 4. What does not stand above the noise, has no determined frequency or damping, left the band or
///    doubles another is taken out, and the rest fitted again.
/// 5. Heavily damped poles (a controller's, a delay's) stay in the model and are listed apart.
/// 6. Is the residual noise, in every response and part of the band? Else the result says where it
///    is not, and the quality of modes there falls.
///
/// Responses without errors get assumed ones, from what of them, and then of the residual, is rough
/// along frequency: so 3 to 6 are the same for responses of records and of files.
///
/// The modal model of frequency responses, and its maximum-likelihood fit:
///
///     H(ω) = Σ_r [ φ_r L_rᵀ g(ω, λ_r) + conj. ] + Σ_k C_k s^k,   s = iω, k = −2 … K,
///
/// g = 1/(s − λ), or what averaging with a window makes of it under white excitation (the
/// transform of ρ(τ) e^(λτ), see lag_taper): so the widening of resonances by the window is
/// part of the model and not an error of the damping. C_k, real, stand for all modes below (−2, −1)
/// and above (0 … K; 1 unless said otherwise) the band.
///
/// Fit. Rows of H are independent given λ and L: minimised is Σ over lines and outputs of
///
///     ‖(Ĥ_o − H_o) W‖²/σ_o²,   W Wᴴ = Q⁻¹  (transposed as the row needs it),
///
/// σ_o² and Q being those of the responses' errors; by Gauss-Newton steps with Levenberg's damping
/// over λ and L, with φ and C eliminated exactly. Without known errors they are taken in proportion
/// to the response, see line_weights.hpp, and their size from the residual.
///
/// Errors. Estimates are θ̂ − θ = N⁻¹ Jᵀ e with N = Jᵀ J; the covariance is N⁻¹ Jᵀ cov(e) J N⁻¹ with
/// what the responses say of cov(e), between outputs and between neighbouring lines. Where nothing
/// is known, cov(e) is taken from the residual.
///
/// Sources: P. Guillaume, P. Verboven, S. Vanlanduit, ISMA 23 (1998) 359 (maximum likelihood); M.
/// El-Kafafy, T. De Troyer, B. Peeters, P. Guillaume, Mech. Syst. Signal Process. 37 (2013) 422
/// (modal model).
///
/// How much frequencies and damping scatter when the averages are drawn anew: a check of the
/// intervals that needs none of their theory. The blocks of a record are kept in G groups of
/// neighbours. A resample draws G groups with replacement, averages their spectra, estimates the
/// responses anew and fits the modes that were found, starting from them. The standard deviation
/// over resamples, times √(G/(G − 1)), estimates that of the frequency and the damping ratio.
///
/// Source: B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap (1993), ch. 6 and 8.
///
/// Do frequencies stay where they are during a record? The modes that were found are fitted to
/// groups of neighbouring blocks, halves or quarters. Of a mode whose frequency stays
///
///     χ² = Σ_g (ω_g − ω̄)²/σ_g²
///
/// over G − 1 is distributed as F(G − 1, ν), σ_g being the deviations that the fits of the groups
/// state and ν = Σ_g (K_g − p) the degrees of freedom of the noise estimates that they follow from;
/// those of several lines count as one, so that the test is careful. A mode that wanders is widened
/// in the mean over the record: its damping is too high, and its intervals hold neither number.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>

#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/identification/poles.hpp"
#include "hydrapod/numerics/parallel.hpp"

namespace hydrapod::identification {

/// The largest element of its participation is 1.
struct FittedMode : PoleEstimate {
  /// Standard deviations, from the responses' errors.
  double omega_deviation{}, damping_deviation{};  ///< of ω [rad/s] and ζ
  Eigen::VectorXd shape_deviation{};              ///< of φ_o: √E|φ̂ − φ|²
  /// Σ over lines and entries of |contribution|²/variance, over the number of its parameters: what
  /// the mode is above the noise. Around 1 it is nothing. Of half spectra: the largest of |φ_o|²
  /// over its variance.
  double significance{};
};

inline constexpr int lowest_residual_power = -2;

struct ModalModel {
  std::vector<FittedMode> modes{};
  /// C_k for k = −2 … K, outputs × inputs, with s/ω_scale for s.
  std::vector<Eigen::MatrixXd> residuals{};
  double omega_scale{1.0};
  double cost{};   ///< the sum of squares that is minimised
  double error{};  ///< √(Σ|Ĥ − H|²/Σ|Ĥ|²) over lines and entries
  /// Mean of |residual|²/variance, less the parameters: about 1 when the model is right and the
  /// variances are; 0 where errors are not known.
  double misfit{};
  int iterations{};
  bool converged{};
};

/// What standard deviations are asked for; those of shapes take several times as long.
enum class Deviations { none, poles, all };

struct FitOptions {
  int max_iterations{30};
  double tolerance{1e-9};  ///< relative fall of the sum of squares at which it stops
  bool taper{true};        ///< model the window, where the responses tell it
  Deviations deviations{Deviations::all};
  double leakage_seen{0.5};       ///< leakage is told from noise of at least this share of it
  int highest_residual_power{1};  ///< K
};

/// Starting from `start`. Throws std::invalid_argument without poles.
ModalModel fit_modes(const FrequencyResponses& responses, const std::vector<PoleEstimate>& start,
                     const FitOptions& options = {});

/// H of the model at s = shift + iω: without the window's effect.
Eigen::MatrixXcd synthesised(const ModalModel& model, double frequency, double shift = 0.0);

/// The band that poles are looked for in.
struct BandOptions {
  /// From the first to the last line with |H|²/variance > audible, as a mean over entries and over
  /// `reach` lines on either side: a mean of noise alone is 1 and hardly ever 3.
  double audible{3.0};
  int reach{4};
  /// Upper end: room · highest pole, half the present end without one, where that is at most
  /// worth · the present end: model orders are spent on modes, not on an empty band.
  double room{1.6}, worth{0.75};
  int rounds{6};      ///< of narrowing; six with this `worth` leave 0.18 of the band or less
  double below{0.6};  ///< of outputs alone the band begins at this share of the lowest mode
  /// Of the final fit: fit_room · highest fitted mode, with its flank; the rest is for residuals.
  double fit_room{1.25};
};

/// Peaks of responses above the band that poles were found in: modes that were not identified. A
/// peak is the largest mean square of all responses (each by its own median, over `reach` of
/// BandOptions) from f/side to f · side, more than `drop` times the smallest on either side:
/// damping ratios up to some 15 % rise so high, edges of filters do not.
struct PeakOptions {
  double side{1.25};
  double drop{4.0};
};

/// Which poles of a fit are kept, beside the limits of IdentifyOptions.
struct PruneOptions {
  /// Open damping: deviation of ζ > largest_damping_deviation · max(ζ, damping_floor). Of a mode
  /// with less damping it is enough to know that it is small.
  double damping_floor{0.002};
  /// Two poles are one: |Δλ| < mean |Re λ|, and MAC > same_vector of shapes and of participations.
  /// Repeated modes differ in one of them.
  double same_vector{0.98};
  int rounds{8};  ///< fits; each takes something out, the last ones rarely anything
};

/// Modes that are as weak as the noise of strong ones: poles fitted to the residual.
struct WeakModeOptions {
  /// A place: the mean of |residual|²/variance over the lines within `reach` is above
  /// median · (1 + stands_out/√n), n numbers in the mean: it scatters by 1/√n. With 36 responses
  /// one line in ten thousand is 4 of that above by chance, with a single one two in a thousand.
  int reach{2};
  double stands_out{4.0};
  int most_places{8};  ///< of one search, the most conspicuous first
  /// Lines around a place that poles are fitted to: |k − place| ≤ least_half_band or
  /// |f − f_place| ≤ half_band · f_place. A sharp resonance and little else is in there.
  int least_half_band{12};
  double half_band{0.02};
  OrderRange orders{1, 6, 1};  ///< one mode, and what the others have left over
  /// Of a weak mode the damping is known that badly, and there are few orders.
  SelectionOptions selection{.damping = 0.5, .damping_floor = 0.004, .fewest = 3};
  int rounds{3};  ///< of search and fit, while they find something
};

/// How well a mode must be known that no pole search came upon.
struct Certainty {
  double near{};           ///< |ω − ω_tried| ≤ near · ω_tried
  double frequency{0.02};  ///< deviation of ω ≤ frequency · ω
  double damping{0.5};     ///< deviation of ζ ≤ damping · ζ
  /// Fall of the sum of squares over the number of a mode's parameters, as in
  /// FittedMode::significance, ≥ gain · least_significance.
  double gain{};
};

/// Modes tried beside those found; they stay if the fit is certain of them and no other mode moves.
struct TrialOptions {
  double unmoved{0.005};  ///< |Δω| < unmoved · ω: the same mode; also one of a close pair
  int rounds{4};          ///< in the flanks of strong modes, while one finds something
  int most_places{3};     ///< of a round, the most conspicuous first: one mode there, then two
  /// A fit is given up where the significance of a mode that is tried + patience · its largest
  /// growth in three iterations · those that are left < least_significance. What follows noise goes
  /// on for long and gains next to nothing; a mode has most of its significance after three
  /// iterations.
  double patience{4.0};
  double damping{0.003};  ///< ζ that a trial begins with: what hides in a flank is sharp
  Certainty hidden{.near = 0.02, .frequency = 0.002, .damping = 0.3};
  /// Of two at once, of which one alone is no resonance. How nearly equal poles share their damping
  /// is hardly determined: that they are two is seen by what the fit gains.
  Certainty hidden_pair{.near = 0.005, .frequency = 0.004, .damping = 1.0, .gain = 2.0};
  /// Of a second one like a weak mode that stands alone.
  Certainty second{.near = 0.005, .damping = 1.0, .gain = 0.5};
};

/// Errors of responses that come without, as a file of a hammer test often does: see
/// assumed_errors.hpp for how they are found.
struct AssumedErrorOptions {
  /// Lines on either side in the median: it scatters by 1.4/√(2 reach + 1), and sharp resonances
  /// must fill less than half of them.
  int reach{24};
  /// Variance ≥ floor² |H|²: no sensor and no linear model is better than that.
  double floor{1e-3};
  /// Windows make neighbouring lines scatter together; lines so far apart do not.
  int apart{3};
  /// What is rough over lines that are `apart` is taken where it is this often that of adjacent
  /// ones: with a Hann window it is three times, and else the same but for scatter.
  double correlated{1.5};
  int lags{2};  ///< of line_covariance that are estimated
  /// Entries of the residual with |e|²/variance > outlier are no noise: its chance is e^−9.
  double outlier{9.0};
  double least_noise{0.1};  ///< mean |e|²/variance below this is rounding, not noise
  /// That of errors, where it is known; empty: estimated from the residual.
  std::vector<std::complex<double>> line_covariance{};
  double by_chance{3.0};  ///< correlations below by_chance/√(2 n) are taken as none
};

/// Is the residual what noise explains? Asked for each response in parts of the band that overlap
/// by half. It is not where
///
///     level = mean |residual|²/variance   >   max(level, F quantile),   or
///     smooth = Re Σ e_k* e_{k+d}/Σ |e_k|²  >   max(smooth, normal quantile),
///
/// d being the first distance at which the noise of lines is not correlated.
struct ResidualTestOptions {
  int lines{32};  ///< of a part; a resonance that matters is that wide with its flanks
  /// Chance of one false alarm in all tests of responses that the model and its errors fit.
  double false_alarm{0.01};
  double level{2.0};   ///< so much is left over that it equals the noise
  double smooth{0.4};  ///< so large a share of the residual is no noise
  /// |residual|² ≤ negligible² |H|² is no matter, however small the noise.
  double negligible{1e-3};
};

/// Records with few blocks (FewBlocks), in one piece: docs/theory/identification.md.
struct RecordOptions {
  double nyquist_room{0.8};  ///< of half the lower sample rate: the edge of the band costs an order
  /// Lines on either side that the noise's density is a mean of: max(reach, reach_share · lines).
  /// It is known to 1/√(2 reach + 1), and a mode takes the noise of the few lines that it is wide.
  Eigen::Index reach{24};
  double reach_share{0.125};
  int rounds{4};             ///< of noise and parameters in turn; the third changes hardly anything
  double first_noise{1e-4};  ///< E|V|² of the first fit by mean |Y|²: less than the residual
  double audible_chance{0.01};  ///< that one of all windows of noise stands above it
  OrderRange orders{2, 60, 2};  ///< of realisations
  /// A tone, and no mode: decay within the record < tone_decays, and power that the inputs drive <
  /// tone_driven · that of its transient. Noise makes it less, and of a mode it is as large.
  double tone_decays{0.5}, tone_driven{0.1};
  /// What inputs drive beside the nearest line < tone_beside · all that they drive: nothing but one
  /// line is driven. A mode that decays by a tenth in the record has 1e-3 there where it lies on a
  /// line, and more elsewhere.
  double tone_beside{1e-3};
  int most_tones{8};
  SelectionOptions selection{.persistence = 0.3};  ///< few orders have all modes: many candidates
  double fewest_periods{4.0};  ///< refused: duration · frequency of the lowest mode < this
  double fewest_numbers{2.0};  ///< refused: numbers of an output < this · its parameters
};

struct IdentifyOptions {
  std::optional<double> from{}, to{};  ///< band [Hz]; default: found as said above
  OrderRange orders{};
  SelectionOptions selection{};
  FitOptions fit{};
  double highest_damping{0.3};      ///< of a mode
  double least_significance{20.0};  ///< FittedMode::significance
  /// The same for half spectra, where it is the square of amplitude over deviation: chance makes 8
  /// once in 3000, and a mode has it after e^(-1)-decays eight times as long as its own.
  double least_significance_of_outputs{8.0};
  double largest_frequency_deviation{0.02};  ///< of ω, relative
  double largest_damping_deviation{0.5};     ///< of ζ, relative
  BandOptions band{};
  PeakOptions peaks{};
  PruneOptions prune{};
  WeakModeOptions weak{};
  TrialOptions trial{};
  /// K of the final fit ≤ this, one more as long as Akaike's criterion falls: more terms than the
  /// band has room for begin to stand for modes.
  int highest_residual_power{4};
  double fewest_samples{8.0};  ///< per period of a mode; with fewer aliasing is seen: a warning
  /// Quality ≤ folded_quality with fewer than these per period: anti-alias filters pass up to the
  /// sample rate/2.56, and beyond stands what is folded, for which the model has poles.
  double filtered_samples{2.56}, folded_quality{0.3};
  double largest_misfit{2.0};  ///< ModalModel::misfit > this is a warning; 1 is noise alone
  /// A block shorter than this over the bandwidth ζ ω/π of a mode is a warning: modes nearer to
  /// each other come out as one. Where half of a loop's modes are, no quality exceeds the share.
  double fewest_lines_wide{2.0};
  WindowOptions window{};
  AssumedErrorOptions assumed_errors{};
  ResidualTestOptions residual_test{};
  RecordOptions record{};
};

/// A response in a part of the band where the residual is more than noise.
struct Unexplained {
  Eigen::Index output{}, input{};
  double from{}, to{};  ///< [Hz]
  double level{};       ///< mean of |residual|²/variance
  double smooth{};      ///< share of the residual that goes on from line to line
  double share{};       ///< Σ|residual|²/Σ|H|²
};

struct IdentifiedMode {
  FittedMode fit{};
  /// φ as displacement: φ/λ^d for outputs that are speeds (d = 1) or accelerations (2).
  /// Of repeated modes along outputs, where the space of their shapes has a real basis.
  Eigen::VectorXcd displacement{};
  int repeated{1};       ///< how many modes this one cannot be told from by its pole, with itself
  double persistence{};  ///< see PoleCluster
  double vector_consistency{};
  double mpc{};  ///< of the displacement shape
  double mpd{};  ///< [rad]
  /// Share of the residual around its frequency that noise explains: 1/Unexplained::level of the
  /// worst response there, at most 1 − Unexplained::smooth and, where misfit is a warning, at most
  /// largest_misfit/misfit; 1 where all is noise. Where the excitation is weak, at most F by what
  /// is needed; where sensors or inputs changed, at most the share of those that did not; 0 of
  /// conjugates.
  double explained{1.0};
  /// ζ ω over ζ ω and the deviation of ω between parts of the record; 1: it does not wander, or
  /// that was not asked.
  double steadiness{1.0};
  /// min(1, ζ/(4 σ_ζ)): 1 where the 95 % interval of the damping is within half of it. A pole of
  /// noise or of a transient comes with a wider one.
  [[nodiscard]] double resolution() const {
    return std::clamp(fit.damping_ratio() / std::max(4.0 * fit.damping_deviation, 1e-300), 0.0,
                      1.0);
  }
  /// Share of model orders that know it × MAC across them × `explained` × `steadiness` ×
  /// `resolution`: 1 is best.
  [[nodiscard]] double quality() const {
    return persistence * vector_consistency * explained * steadiness * resolution();
  }
};

/// Why a fitted mode is none; report::words has the words.
enum class Objection {
  none,
  left_band,       ///< its frequency is outside of `from` … `to`
  in_noise,        ///< significance < least_significance
  open_frequency,  ///< deviation of ω > largest_frequency_deviation · ω
  open_damping,    ///< deviation of ζ > largest_damping_deviation · max(ζ, damping_floor)
  doubles,         ///< another fitted pole is the same, see PruneOptions
  not_finite       ///< a number of the fit overflowed
};

struct LeftOut {
  std::complex<double> pole{};
  Objection reason{};
};

/// What a user should know of identified modes; report::warning_text has the words.
struct ModeWarning {
  enum class Kind {
    no_mode,       ///< between `from` and `to` [Hz]
    few_samples,   ///< value: samples per period of the highest mode; may be the image of `to`;
                   ///< `count` of `total` modes above `from`, which anti-alias filters cut
    misfit,        ///< value: ModalModel::misfit
    unexplained,   ///< value: Unexplained::level of the worst response, from `from` to `to`; of
                   ///< `count` of `total` responses somewhere in the band
    wanders,       ///< the mode at value [Hz], `from` … `to` in the `count` parts of the record;
                   ///< its damping is higher by `share` than the mean of that of the parts
    short_blocks,  ///< `count` of `total` modes; value: [s] of a block; the sharpest one: `from`
                   ///< its frequency, `to` its half-power bandwidth [Hz]
    peaks_above,   ///< `count` peaks, the largest at value [Hz], above the band `from` … `to`
    conjugated,    ///< modes leave `share` of the responses (RMS), and `value` of their conjugates
    window,        ///< the responses are averages with this window, in blocks of value [s]
    twins,         ///< `count` of `total` modes; a pair: `from`, `to` [Hz], value half widths apart
    moved,         ///< twins that are one resonance; `share` of the outputs not explained there
    common_poles,  ///< `count` of `total` modes, `from` … `to`; value: damping of the lowest one
    set_ups,  ///< `count` of `total` modes in pairs, the first `from` and `to`; the lower one of
              ///< a pair moves `value` outputs, `output` and others, the higher one the rest
    combination_tones  ///< `count` of `total` modes are at ω_a ± ω_b of two others, one at value
                       ///< [Hz] of those at `from` and `to` [Hz]
  };
  Kind kind{};
  double value{}, from{}, to{}, smooth{}, share{};
  std::string output{}, input{}, window{};  ///< names
  std::int64_t count{}, total{};
};

struct Identification {
  FrequencyResponses responses{};   ///< in the band that was used
  std::vector<OrderPoles> chart{};  ///< stabilisation chart
  std::vector<PoleCluster> clusters{};
  ModalModel model{};                   ///< all poles, also the heavily damped ones
  std::vector<IdentifiedMode> modes{};  ///< the machine's, ascending in frequency
  std::vector<FittedMode> heavily_damped{};
  std::vector<LeftOut> left_out{};
  double from{}, to{};  ///< [Hz]
  /// Where the residual is more than noise, worst first: intervals of modes there are too narrow.
  std::vector<Unexplained> unexplained{};
  /// No errors came with the responses: those that are used are what is rough along frequency.
  bool errors_assumed{};
  std::optional<double> needed_duration{};  ///< [s]; there where sensors could not be tested
  std::vector<ModeWarning> warnings{};
};

/// Without a mode in the band the result has none, and a warning that says so. Throws
/// base::ComputationError where there are too few frequencies.
Identification identify_modes(const FrequencyResponses& responses,
                              const IdentifyOptions& options = {},
                              const std::function<void(double)>& progress = {});

/// The same; of records with few blocks from their samples, in one piece. Throws
/// base::ComputationError where these are too few, and where the inputs are in a loop without
/// instruments.
Identification identify_modes(const Measurement& measurement, const IdentifyOptions& options = {},
                              const std::function<void(double)>& progress = {});

/// H(iω) of responses at a + iω, which is what other programs expect: the difference is that of the
/// modal model, so that resonances are brought there exactly; what the model leaves over, noise for
/// the most part, remains what it is. `found`: of these responses, at least one mode.
std::vector<Eigen::MatrixXcd> on_imaginary_axis(const FrequencyResponses& responses,
                                                const Identification& found);

/// The modes with their errors, as others take them.
data::ModalResults modal_results(const Identification& identified);

/// Lines from `from` to `to` [Hz].
FrequencyResponses within(const FrequencyResponses& responses, double from, double to);

/// Complex mode indicator function: singular values of H, outputs scaled to their own size.
/// lines × min(outputs, inputs), descending.
Eigen::MatrixXd mode_indicator(const FrequencyResponses& responses);

/// MAC of every shape with every other.
Eigen::MatrixXd mac_matrix(const std::vector<Eigen::VectorXcd>& a,
                           const std::vector<Eigen::VectorXcd>& b);

/// Spectra that were formed alike as one, each with the weight of its blocks. `picks`: which ones,
/// some perhaps several times.
CrossSpectra averaged_spectra(const std::vector<CrossSpectra>& groups,
                              const std::vector<std::size_t>& picks);

struct BootstrapOptions {
  int resamples{50};
  std::uint64_t seed{1};
  IdentifyOptions identify{};  ///< those that found the modes
};

struct BootstrapScatter {
  Eigen::VectorXd omega_deviation{};    ///< of ω [rad/s], per mode that was found
  Eigen::VectorXd damping_deviation{};  ///< of ζ
  int resamples{};                      ///< that could be fitted
  int groups{};  ///< G: the scatter itself is known to 1/√(2 (G − 1)) or so
};

/// `groups`: spectra of at least four groups with the same channels and options. `progress` is told
/// the share that is done; where it asks to stop the resamples so far count. Throws
/// std::invalid_argument for fewer groups and for a result without modes.
BootstrapScatter bootstrap_modes(const std::vector<CrossSpectra>& groups,
                                 const ChannelChoice& choice, Estimator estimator,
                                 const Identification& found, const BootstrapOptions& options = {},
                                 const numerics::Progress& progress = {});

struct WanderOptions {
  /// A mode wanders where P(F) > 1 − level/modes: of a record whose modes all stay, one is called
  /// wandering with this probability.
  double level{0.005};
  /// … and the deviation of ω between the parts, less what estimates scatter, > least_spread · ζ ω:
  /// less than that changes the damping by a percent at most.
  double least_spread{0.1};
  /// Neighbouring groups are put together until K − p ≥ least_degrees: fewer hardly tell errors.
  double least_degrees{6.0};
  /// A part tells of a mode where each input has more than least_excitation of its density in the
  /// whole record there: a sweep passes a mode in one part of the record, and in the others its
  /// response is what rings down. The first half of noise that grows to four times its RMS has 0.4.
  double least_excitation{0.15};
};

struct Wandering {
  std::size_t mode{};  ///< of Identification::modes
  double chi_squared{};
  int groups{};
  double lowest{}, highest{};  ///< ω of the groups [rad/s]
  double deviation{};          ///< of ω between the groups, less what estimates scatter [rad/s]
  double damping_in_groups{};  ///< mean of ζ over the groups
};

/// The modes that wander; none where the record is too short to tell. `groups`: in the order of
/// time, as measure_groups() forms them, with all lines of `found`, which `identify` found.
std::vector<Wandering> wandering_modes(std::vector<CrossSpectra> groups,
                                       const ChannelChoice& choice, Estimator estimator,
                                       const Identification& found,
                                       const IdentifyOptions& identify = {},
                                       const WanderOptions& options = {});

struct PartsFinding {
  std::vector<Wandering> wandering{};
  std::optional<data::ResponseWarning> changed{};  ///< sensor_changed or input_changed
  std::optional<double> needed_duration{};         ///< [s] of a record that sensors are compared in
};

/// The same with quarters of the records, read once more; and a sensor or an input that changed
/// between records or parts of the only one, which in short records are halves of shorter blocks.
/// Nothing where `progress` asks to stop. Throws as measure_groups().
PartsFinding compare_parts(data::RecordSet& records, const Measurement& measured,
                           const MeasureOptions& measure, const Identification& found,
                           const IdentifyOptions& identify = {}, const WanderOptions& options = {},
                           const numerics::Progress& progress = {});

/// Warnings; the steadiness of modes; no quality above the share of channels that did not change,
/// outputs or inputs.
void add_wandering(const std::vector<Wandering>& wandering, Identification& found);
void add_changed_channel(const data::ResponseWarning& changed, Identification& found);

}  // namespace hydrapod::identification
