#include "gaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bridge.hpp"
#include "hydrapod/base/error.hpp"
#include "sample_sums.hpp"

namespace hydrapod::identification {

namespace {

/// use(first, count) for every run of missing samples in a column.
template <class Use>
void for_runs(const Mask& missing, Index rows, Index column, const Use& use) {
  for (Index t = 0; t < rows; ++t) {
    if (!missing(t, column)) continue;
    const Index first = t;
    while (t < rows && missing(t, column)) ++t;
    use(first, t - first);
  }
}

}  // namespace

std::vector<std::vector<int>> groups_to_fill(const ChannelChoice& choice, Estimator estimator) {
  std::vector<std::vector<int>> groups;
  if (estimator == Estimator::instrumental) {
    groups = {choice.instruments, choice.inputs};
    groups[1].insert(groups[1].end(), choice.outputs.begin(), choice.outputs.end());
  } else {
    groups = {choice.instruments, choice.inputs, choice.outputs};
  }
  std::vector<int> seen;
  for (auto& group : groups)
    std::erase_if(group, [&](int c) {
      if (std::ranges::find(seen, c) != seen.end()) return true;
      seen.push_back(c);
      return false;
    });
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  return groups;
}

/// Moments of each column, and rows to fit predictions to.
struct GapModel::Scan {
  struct Channel {
    SampleSums present{};
    std::int64_t missing{}, in_long_gaps{}, run{};

    void add(double x, Index longest) {
      if (std::isfinite(x)) {
        end_run(longest);
        present.add(x);
      } else {
        ++missing;
        ++run;
      }
    }
    void end_run(Index longest) {
      if (run > longest) in_long_gaps += run;
      run = 0;
    }
    [[nodiscard]] double share() const {
      const std::int64_t total = present.count + missing - in_long_gaps;
      return total > 0 ? static_cast<double>(missing - in_long_gaps) / static_cast<double>(total)
                       : 0.0;
    }
  };

  std::vector<Channel> channels{};
  Rows rows{};
  Mask missing{};
  Index kept{};

  Scan(data::RecordSet& records, const GapModel& model) : channels(model.columns_.size()) {
    const auto width = static_cast<Index>(channels.size());
    const Index per_file = model.options_.most_rows / static_cast<Index>(records.files().size());
    rows.resize(model.options_.most_rows, width);
    missing.resize(model.options_.most_rows, width);
    std::optional<std::size_t> current;
    Index seen = 0;
    records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
      if (current != file) {
        for (auto& channel : channels) channel.end_run(model.longest_);
        seen = 0;
      }
      current = file;
      for (Index t = 0; t < block.rows(); ++t, ++seen) {
        if (seen < model.plan_.settling) continue;
        for (std::size_t c = 0; c < channels.size(); ++c)
          channels[c].add(block(t, static_cast<Index>(model.columns_[c].channel)), model.longest_);
        if (seen - model.plan_.settling < per_file) keep(block.row(t), model.columns_);
      }
      return true;
    });
    for (auto& channel : channels) channel.end_run(model.longest_);
  }

  void keep(const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& row,
            const std::vector<Column>& columns) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double x = row[static_cast<Index>(columns[c].channel)];
      missing(kept, static_cast<Index>(c)) = !std::isfinite(x);
      rows(kept, static_cast<Index>(c)) = std::isfinite(x) ? x : 0.0;
    }
    ++kept;
  }

  /// In units of their deviation, and without rows in long gaps.
  void prepare(const std::vector<Column>& columns, Index longest) {
    std::vector<char> out(static_cast<std::size_t>(kept));
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto c = static_cast<Index>(k);
      if (columns[k].dead) missing.col(c).head(kept).setZero();
      for_runs(missing, kept, c, [&](Index first, Index count) {
        if (count > longest) std::fill_n(out.begin() + first, count, char{1});
      });
      for (Index t = 0; t < kept; ++t)
        rows(t, c) = missing(t, c) || columns[k].dead
                         ? 0.0
                         : (rows(t, c) - columns[k].mean) / columns[k].scale;
    }
    Index to = 0;
    for (Index t = 0; t < kept; ++t) {
      if (out[static_cast<std::size_t>(t)]) continue;
      if (to != t) {
        rows.row(to) = rows.row(t);
        missing.row(to) = missing.row(t);
      }
      ++to;
    }
    kept = to;
    rows.conservativeResize(kept, Eigen::NoChange);
    missing.conservativeResize(kept, Eigen::NoChange);
  }
};

GapModel::GapModel(data::RecordSet& records, const GapPlan& plan, const GapOptions& options)
    : plan_(plan), options_(options) {
  longest_ = static_cast<Index>(options.longest * plan.block_length);
  for (const auto& group : plan.groups)
    for (const int c : group) columns_.push_back({plan.channels[static_cast<std::size_t>(c)]});
  Scan scan(records, *this);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto& channel = scan.channels[c];
    auto& column = columns_[c];
    column.dead = channel.present.count == 0;
    if (column.dead) continue;
    column.mean = channel.present.mean();
    if (const double rms = channel.present.rms(); rms > 0.0) column.scale = rms;
    if (channel.share() > options.largest_share)
      throw base::ComputationError(fmt::format(
          "{} misses {:.0f} % of its samples, beside gaps longer than {} samples: up to {:.0f} % "
          "can be filled; leave the channel out, or measure again",
          records.header().channels[column.channel].name, 100.0 * channel.share(), longest_,
          100.0 * options.largest_share));
  }
  scan.prepare(columns_, longest_);
  Index given = 0;
  for (const auto& group : plan.groups) {
    const Index end = given + static_cast<Index>(group.size());
    Rows z = scan.rows.leftCols(end);
    predictors_.emplace_back(z, Mask(scan.missing.leftCols(end)), given);
    scan.rows.leftCols(end) = z;
    context_ = std::max(context_, longest_ + 2 * predictors_.back().order());
    given = end;
  }
}

GapFiller::GapFiller(const GapModel& model, Use use) : model_(model), use_(std::move(use)) {
  const Index rows = model.options_.chunk + 2 * model.context_;
  z_.resize(rows, static_cast<Index>(model.columns_.size()));
  missing_.resize(rows, z_.cols());
  unknown_ = VectorXd::Zero(static_cast<Index>(model.plan_.groups[0].size()));
}

void GapFiller::add(const Eigen::Ref<const data::Samples>& samples) {
  if (raw_.cols() != samples.cols()) raw_.resize(z_.rows(), samples.cols());
  for (Index t = 0; t < samples.rows(); ++t, ++rows_) {
    if (rows_ == z_.rows()) process(false);
    raw_.row(rows_) = samples.row(t);
    for (std::size_t k = 0; k < model_.columns_.size(); ++k) {
      const auto& column = model_.columns_[k];
      const double x = samples(t, static_cast<Index>(column.channel));
      const auto c = static_cast<Index>(k);
      missing_(rows_, c) = !column.dead && !std::isfinite(x);
      z_(rows_, c) = std::isfinite(x) ? (x - column.mean) / column.scale : 0.0;
    }
  }
}

/// Fills what is in the buffer; all of it comes out, or all but what lies too near its end.
void GapFiller::process(bool last) {
  const auto& model = model_;
  // deep inside long gaps nothing is solved for
  Mask unknown = missing_.topRows(rows_), too_long = Mask::Zero(rows_, missing_.cols());
  for (Index c = 0; c < unknown.cols(); ++c)
    for_runs(missing_, rows_, c, [&](Index first, Index count) {
      if (count <= model.longest_) return;
      too_long.col(c).segment(first, count).setOnes();
      const Index edge = std::min(count / 2, model.context_ - model.longest_);
      unknown.col(c).segment(first + edge, count - 2 * edge).setZero();
    });
  Index given = 0;
  for (std::size_t g = 0; g < model.predictors_.size(); ++g) {
    const Index end = given + static_cast<Index>(model.plan_.groups[g].size());
    if (unknown.middleCols(given, end - given).bottomRows(rows_ - done_).any()) {
      Rows z = z_.topLeftCorner(rows_, end);
      const bool draw = model.plan_.draw && g + 1 == model.predictors_.size();
      model.predictors_[g].fill(z, unknown.leftCols(end), done_, draw ? &random_ : nullptr);
      z_.topLeftCorner(rows_, end) = z;
    }
    given = end;
  }
  const Index to = last ? rows_ : rows_ - model.context_;
  for (Index t = done_; t < to; ++t)
    for (std::size_t k = 0; k < model.columns_.size(); ++k) {
      const auto& column = model.columns_[k];
      const auto c = static_cast<Index>(k);
      auto& x = raw_(t, static_cast<Index>(column.channel));
      if (column.dead) x = 0.0;
      if (!missing_(t, c) || too_long(t, c)) continue;
      x = column.mean + column.scale * z_(t, c);
      if (c < unknown_.size()) unknown_[c] += 1.0 - z_(t, c) * z_(t, c);
    }
  if (to > done_) use_(raw_.middleRows(done_, to - done_));
  total_ += to - done_;
  const Index from = std::max<Index>(0, to - model.context_), kept = rows_ - from;
  raw_.topRows(kept) = raw_.middleRows(from, kept).eval();
  z_.topRows(kept) = z_.middleRows(from, kept).eval();
  missing_.topRows(kept) = missing_.middleRows(from, kept).eval();
  rows_ = kept;
  done_ = to - from;
}

void GapFiller::end_record() {
  if (rows_ > done_) process(true);
  rows_ = done_ = 0;
}

double GapFiller::unknown_share() const {
  return std::clamp(unknown_.maxCoeff() / std::max(1.0, static_cast<double>(total_)), 0.0, 1.0);
}

bool misses_samples(const CrossSpectra& spectra) {
  return std::ranges::any_of(spectra.health, [](const auto& h) { return h.missing > 0; });
}

data::ResponseWarning warning_of_missing(const CrossSpectra& spectra, double unknown_share) {
  data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::missing_samples,
                                .value = unknown_share};
  for (std::size_t c = 0; c < spectra.health.size(); ++c) {
    const auto& health = spectra.health[c];
    warning.count += health.missing;
    warning.total += health.samples;
    const double share = static_cast<double>(health.missing) /
                         static_cast<double>(std::max<std::int64_t>(health.samples, 1));
    if (share <= warning.share && c > 0) continue;
    warning.share = share;
    warning.channel = spectra.channels[c].name;
  }
  return warning;
}

}  // namespace hydrapod::identification
