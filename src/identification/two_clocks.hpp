#pragma once
/// Inputs and outputs by two recorders whose clocks differ by some millionths. Private to the
/// module.
///
/// The outputs are then later and later (or earlier), by ε t. In the cross spectra of the parts g
/// of a record it turns the phase in proportion to time and to frequency,
///
///     C_g(ω) = H(ω) √S_uu(ω) e^(−iωεt_g) + noise,
///
/// which nothing else does: a delay does not grow, and a resonance that wanders turns phases around
/// itself alone. With unknown H and noise at each line the likelihood of ε is
///
///     L(ε) = −G Σ ln(1 − ρ²),   ρ = |Σ_g C_g e^(iωεt_g)|/√(G Σ_g |C_g|²),
///
/// over lines, outputs and inputs. L(0) is that of entries which may change their sign once, where
/// that gains more than `evidence`: the phases of a cable that was turned round turn too, and not
/// in proportion to the frequency. Where L(ε) says so the outputs are brought to the clock of the
/// inputs (data::Resampler), before spectra are formed.

#include <functional>
#include <memory>
#include <optional>

#include "hydrapod/data/processing.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/identification/responses.hpp"
#include "names.hpp"

namespace hydrapod::identification {

struct TwoClocksOptions {
  double most{5e-4};  ///< |ε|: the worst quartz is at 1e-4
  /// L(ε) − L(0) > evidence, as a mean over outputs and inputs, whose noise may be one and the
  /// same, and without the quarter of the lines that says most. Chance makes that once in e^20 for
  /// each ε.
  double evidence{20.0};
  /// ε is refined where some of the outputs and inputs gain more than this share of `evidence`.
  double worth_refining{0.25};
  /// An output keeps its clock where L(0) − L(ε) of it alone > own_clock.
  double own_clock{4.0};
  int block{2048};          ///< [samples] at most
  Index fewest_blocks{64};  ///< of a record: else blocks are shorter
  Index most_parts{256}, most_lines{128};
  Index most_steps{1024};  ///< of ε that are tried
};

struct ClockDifference {
  double ratio{};              ///< ε: outputs are later by ε t
  std::vector<int> outputs{};  ///< numbers in the choice of channels
  double turn{};               ///< ε T, T being the length of the longest record [s]
};

/// Samples stream through it, and it says whether outputs have another clock.
class ClockSearch {
 public:
  /// `used`: channels of the records, which `choice` numbers.
  ClockSearch(data::RecordSet& records, const std::vector<std::size_t>& used,
              const ChannelChoice& choice, std::int64_t settling,
              const TwoClocksOptions& options = {});
  ~ClockSearch();
  void begin_record(std::size_t record);
  /// All channels.
  void add(const Eigen::Ref<const data::Samples>& samples);
  [[nodiscard]] std::optional<ClockDifference> result() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_{};  // none: records are too short
};

/// Samples stream through it and come out with some columns at the clock of the others.
class ClockCorrector {
 public:
  using Use = std::function<void(const Eigen::Ref<const data::Samples>&)>;
  /// `columns` of the record.
  ClockCorrector(std::vector<Index> columns, double sample_rate, double ratio, Use use);
  void add(const Eigen::Ref<const data::Samples>& samples);
  /// What is still inside comes out; what has no partner does not.
  void end_record();

 private:
  void pass_on();

  std::vector<Index> columns_;
  double sample_rate_, ratio_;
  Use use_;
  std::unique_ptr<data::Resampler> resampler_{};
  data::Samples waiting_{}, corrected_{};
};

}  // namespace hydrapod::identification
