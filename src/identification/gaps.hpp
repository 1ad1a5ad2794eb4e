#pragma once
/// Records with missing samples. Private to the module.
///
/// A block of samples can be transformed only where it is whole, and a single missing sample costs
/// all blocks that hold it. Missing samples are therefore filled, group by group of channels, each
/// from itself and the groups before it (predictor.hpp): instruments, inputs, outputs.
///
/// Why responses stay unbiased. What is filled for an input u is û, its mean under the condition of
/// what was measured of the inputs. Its error e = u − û is uncorrelated with û, and so is the error
/// f of what is filled for an output y, its mean under the condition of û and of what was measured
/// of the outputs. With Y = H U + V and V independent of the inputs,
///
///     E[Ŷ Û*] = E[(H Û + H E + V − F) Û*] = H E[Û Û*].
///
/// What remains unknown of the inputs, H e, acts as noise of the outputs, in proportion to what is
/// missing (for white inputs all of it). The estimate of the noise holds it. The same is true of
/// the instrumental estimate, with the instruments for u. Inputs are not filled from outputs: û
/// would hold part of V.
///
/// Of outputs without inputs second moments are wanted: there a draw from the errors is added to
/// the mean.
///
/// Gaps that are longer than a share of a block stay: no more is known inside of them.

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "hydrapod/identification/responses.hpp"
#include "predictor.hpp"

namespace hydrapod::identification {

struct GapOptions {
  /// A gap is filled where its samples ≤ longest · block: so much of a block then is not measured.
  double longest{0.125};
  /// … and of each channel, long gaps aside, missing ≤ largest_share · samples: with a quarter
  /// missing, hardly a stretch as long as the prediction is whole.
  double largest_share{0.25};
  Index most_rows{Index{1} << 17};  ///< that predictions are fitted to, of all files together
  Index chunk{Index{1} << 14};      ///< rows that are filled at a time
};

/// How the channels of a reading are filled.
struct GapPlan {
  std::vector<std::size_t> channels{};  ///< of the record, that are used
  /// Numbers of `channels`, each in one group: filled from itself and the groups before.
  std::vector<std::vector<int>> groups{};
  bool draw{};              ///< of the last group, errors too
  std::int64_t settling{};  ///< samples at the beginning of each record that do not count
  int block_length{};
};

/// From the choice of channels among `channels`.
std::vector<std::vector<int>> groups_to_fill(const ChannelChoice& choice, Estimator estimator);

/// What filling needs to know of the records, which are read once for it.
class GapModel {
 public:
  /// Throws base::ComputationError where too much of a channel is missing.
  GapModel(data::RecordSet& records, const GapPlan& plan, const GapOptions& options = {});

 private:
  friend class GapFiller;
  struct Column {
    std::size_t channel{};  ///< of the record
    bool dead{};            ///< never measured
    double mean{}, scale{1.0};
  };
  struct Scan;
  GapPlan plan_{};
  GapOptions options_{};
  std::vector<Column> columns_{};  // group after group
  std::vector<Predictor> predictors_{};
  Index longest_{}, context_{};
};

/// Samples stream through it and come out filled, some later. What is left of them is in gaps that
/// are too long.
class GapFiller {
 public:
  using Use = std::function<void(const Eigen::Ref<const data::Samples>&)>;
  GapFiller(const GapModel& model, Use use);
  void add(const Eigen::Ref<const data::Samples>& samples);
  /// What is still inside comes out: the next sample is another record's.
  void end_record();
  /// Share of the power of the first group's channels that filling did not restore, the largest.
  [[nodiscard]] double unknown_share() const;

 private:
  void process(bool last);

  const GapModel& model_;
  Use use_;
  data::Samples raw_{};
  Rows z_{};
  Mask missing_{};
  Index rows_{}, done_{};
  std::int64_t total_{};
  VectorXd unknown_{};  // Σ (1 − ẑ²) over filled samples, per column of the first group
  numerics::Gaussian random_{1};
};

/// Does a channel that lives miss samples?
bool misses_samples(const CrossSpectra& spectra);

/// `spectra`: as they were read, with the missing samples.
data::ResponseWarning warning_of_missing(const CrossSpectra& spectra, double unknown_share);

}  // namespace hydrapod::identification
