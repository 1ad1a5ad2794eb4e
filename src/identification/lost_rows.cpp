#include "lost_rows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"
#include "predictor.hpp"

namespace hydrapod::identification {

namespace {

/// Rows of the inputs and outputs, each with the `order` rows before it. `use` is given the file,
/// the number of the first row that has these, and the rows from `order` before it on; false ends
/// the reading.
class RowsWithPast {
 public:
  using Use =
      std::function<bool(std::size_t file, std::int64_t first, const Eigen::Ref<const Rows>& rows)>;
  RowsWithPast(std::vector<Index> columns, Index order)
      : columns_(std::move(columns)), order_(order) {}

  void stream(data::RecordSet& records, const Use& use) const {
    Rows rows(0, std::ssize(columns_));
    Index filled = 0;  // rows
    std::size_t current = 0;
    std::int64_t next = 0;  // row of the file
    records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
      const bool begins = file != current || next == 0;
      const Index kept = begins ? 0 : std::min(order_, filled);
      const Rows past = rows.middleRows(filled - kept, kept);
      filled = kept + block.rows();
      if (rows.rows() < filled) rows.resize(filled, rows.cols());
      rows.topRows(kept) = past;
      copy_columns(block, rows.data() + kept * rows.cols());
      if (begins) next = 0;
      current = file;
      const bool goes_on =
          filled <= order_ || use(file, next - kept + order_, rows.topRows(filled));
      next += block.rows();
      return goes_on;
    });
  }

 private:
  /// Row by row: neighbours come from the cache together.
  void copy_columns(const Eigen::Ref<const data::Samples>& block, double* to) const {
    for (Index t = 0; t < block.rows(); ++t) {
      const double* from = block.data() + t * block.outerStride();
      for (const Index c : columns_) *to++ = from[c];
    }
  }

  std::vector<Index> columns_;
  Index order_;
};

/// e = y − A (past of all channels, r now), and its deviations. Columns hold the past, r and y.
class OneStep {
 public:
  OneStep(const Eigen::Ref<const MatrixXd>& samples, Index outputs, double outlier)
      : past_(samples.rows() - outputs), outputs_(outputs) {
    const auto count = static_cast<double>(samples.cols());
    mean_ = VectorXd::Zero(samples.rows());  // sums go along the columns, as the memory does
    for (const auto& column : samples.colwise()) mean_ += column / count;
    scale_ = VectorXd::Zero(samples.rows());
    for (const auto& column : samples.colwise()) scale_ += (column - mean_).cwiseAbs2();
    scale_ = (scale_ / count).cwiseSqrt();
    scale_ = scale_.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
    MatrixXd x = scale_.asDiagonal() * (samples.colwise() - mean_);
    fit(x);
    MatrixXd e = x.bottomRows(outputs) - A_ * x.topRows(past_);
    set_deviations(e);
    std::vector<Index> kept;
    for (Index t = 0; t < e.cols(); ++t)
      if ((e.col(t).cwiseAbs().array() <= outlier * deviation_.array()).all()) kept.push_back(t);
    if (2 * std::ssize(kept) > e.cols() && std::ssize(kept) < e.cols()) {
      x = x(Eigen::all, kept).eval();
      fit(x);
      e = x.bottomRows(outputs) - A_ * x.topRows(past_);
      set_deviations(e);
    }
    of_samples_ = MatrixXd::Zero(outputs, samples.rows());
    of_samples_.leftCols(past_) = -A_;
    of_samples_.rightCols(outputs).setIdentity();
    of_samples_ = deviation_.cwiseInverse().asDiagonal() * of_samples_ * scale_.asDiagonal();
    of_mean_ = of_samples_ * mean_;
  }
  /// |e| of the first `outputs` by its deviation, a column per row of `rows` that has its past.
  [[nodiscard]] MatrixXd errors(const Eigen::Ref<const Rows>& rows, Index outputs) const {
    const MatrixXd A = of_samples_.topRows(outputs);
    const Index order = A.cols() / rows.cols() - 1, count = rows.rows() - order,
                paired = count / four * four;
    MatrixXd e(outputs, count);
    MatrixXd::Map(e.data(), four * outputs, count / four).noalias() =
        side_by_side(A, rows.cols()) *
        steps(rows, A.cols() + (four - 1) * rows.cols(), count / four);
    const auto one_by_one = [&](Index first, Index last) {
      for (Index k = first; k < last; ++k)
        e.col(k) = A * VectorXd::Map(rows.data() + k * rows.cols(), A.cols());
    };
    // what is missing beside a row is none of its errors
    for (Index t = 0; t < paired; t += four)
      if (!std::isfinite(e.middleCols(t, four).sum())) one_by_one(t, t + four);
    one_by_one(paired, count);
    e.colwise() -= of_mean_.head(outputs);
    return e.cwiseAbs();
  }
  /// Of the numbers of a row with its past.
  [[nodiscard]] const VectorXd& mean() const { return mean_; }
  /// What they are multiplied by to have variance 1; 0 where they are constant.
  [[nodiscard]] const VectorXd& scale() const { return scale_; }
  /// e by its deviations = this · (a row with its past − mean()).
  [[nodiscard]] const MatrixXd& of_samples() const { return of_samples_; }

 private:
  void fit(const MatrixXd& x) {
    constexpr double ridge = 1e-9;  // of channels of variance 1
    MatrixXd S = MatrixXd::Zero(x.rows(), x.rows());
    S.selfadjointView<Eigen::Lower>().rankUpdate(x, 1.0 / static_cast<double>(x.cols()));
    S.diagonal().array() += ridge;
    const MatrixXd of_past = S.topLeftCorner(past_, past_).selfadjointView<Eigen::Lower>();
    A_ = of_past.ldlt().solve(S.bottomLeftCorner(outputs_, past_).transpose()).transpose();
  }
  void set_deviations(const MatrixXd& e) {
    constexpr double of_median = 0.6745;  // of a normal number, |x| is half the time below that
    constexpr double least = 1e-6;        // of the channel: rounding
    deviation_.resize(outputs_);
    for (Index o = 0; o < outputs_; ++o) {
      const VectorXd own = e.row(o).cwiseAbs();
      deviation_[o] = std::max(least, numerics::upper_median({own.begin(), own.end()}) / of_median);
    }
  }

  /// Four rows are predicted at a time, from what is before any of them: a product of few rows
  /// leaves most of a processor's registers empty.
  static constexpr Index four = 4;
  static MatrixXd side_by_side(const MatrixXd& A, Index D) {
    MatrixXd all = MatrixXd::Zero(four * A.rows(), A.cols() + (four - 1) * D);
    for (Index k = 0; k < four; ++k) all.block(k * A.rows(), k * D, A.rows(), A.cols()) = A;
    return all;
  }
  /// So many columns of `length` numbers, which begin at every fourth row.
  static Eigen::Map<const MatrixXd, 0, Eigen::OuterStride<>> steps(
      const Eigen::Ref<const Rows>& rows, Index length, Index columns) {
    return {rows.data(), length, columns, Eigen::OuterStride<>(four * rows.cols())};
  }

  Index past_, outputs_;
  VectorXd mean_{}, scale_{}, deviation_{}, of_mean_{};
  MatrixXd A_{}, of_samples_{};
};

/// Says in single precision, at less than half the cost, that nothing stands out, where rounding
/// cannot hide it.
class QuietRows {
 public:
  /// Of the first `outputs` of the model.
  QuietRows(const OneStep& model, Index outputs, Index channels)
      : mean_(model.mean().tail(channels)), scale_(model.scale().tail(channels)) {
    scale_ = scale_.unaryExpr([](double s) { return s > 0.0 ? s : 1.0; });
    const MatrixXd A = model.of_samples().topRows(outputs);
    const Index steps = A.cols() / channels;
    offset_ = (A * (mean_.replicate(steps, 1) - model.mean())).cast<float>();
    const MatrixXd of_small = A * scale_.cwiseInverse().replicate(steps, 1).asDiagonal();
    per_unit_ = of_small.cwiseAbs().rowwise().sum().maxCoeff();
    for (Index c = 0; c < channels; ++c)
      for (Index k = 0; k < steps; ++k)
        for (Index o = 0; o < outputs; ++o)
          coefficients_.push_back(static_cast<float>(of_small(o, k * channels + c)));
  }
  /// |e| ≤ `most` · its deviation, of all rows that have their past. False where it cannot tell.
  [[nodiscard]] bool are_quiet(const Eigen::Ref<const Rows>& rows, double most) {
    const Index steps = std::ssize(coefficients_) / (offset_.size() * rows.cols());
    if (x_.cols() != rows.cols() || x_.rows() < rows.rows() + lanes)
      x_.setZero(rows.rows() + lanes, rows.cols());
    x_.topRows(rows.rows()) =
        ((rows.rowwise() - mean_.transpose()) * scale_.asDiagonal()).cast<float>();
    const double unit = 0.5 * std::numeric_limits<float>::epsilon(),
                 rounding = 2.0 * static_cast<double>(steps * rows.cols() + 4) * unit * per_unit_ *
                            static_cast<double>(x_.topRows(rows.rows()).cwiseAbs().maxCoeff());
    if (!(rounding < 0.1 * most)) return false;
    const auto limit = static_cast<float>(most - rounding);
    switch (offset_.size()) {
      case 1:
        return are_within<1>(limit, steps, rows.rows());
      case 2:
        return are_within<2>(limit, steps, rows.rows());
      case 3:
        return are_within<3>(limit, steps, rows.rows());
      default:  // more outputs than LostRowsOptions asks for
        return false;
    }
  }

 private:
  static constexpr int lanes = 32;  // rows at once: as many as registers hold for three outputs

  template <int outputs>
  [[nodiscard]] bool are_within(float limit, Index steps, Index rows) const {
    using Lanes = Eigen::Array<float, lanes, 1>;
    for (Index first = 0; first + steps <= rows; first += lanes) {
      std::array<Lanes, outputs> e;
      for (int o = 0; o < outputs; ++o) e[o].setConstant(offset_[o]);
      const float* a = coefficients_.data();
      for (Index c = 0; c < x_.cols(); ++c)
        for (Index k = 0; k < steps; ++k, a += outputs) {
          const Lanes x = Lanes::Map(x_.data() + c * x_.rows() + first + k);
          for (int o = 0; o < outputs; ++o) e[o] += a[o] * x;
        }
      const Index there = std::min<Index>(lanes, rows - steps + 1 - first);
      for (const auto& own : e)
        if (!(own.head(there).abs() <= limit).all()) return false;
    }
    return true;
  }

  VectorXd mean_, scale_;
  Eigen::VectorXf offset_{};
  double per_unit_{};
  std::vector<float> coefficients_{};  // by channel, step, output
  Eigen::MatrixXf x_{};                // a column per channel
};

/// Rows that are whole with their past, `length` numbers each, evenly over the first ones of
/// `total`.
std::vector<double> rows_to_fit(data::RecordSet& records, const RowsWithPast& with_past,
                                Index order, Index length, std::int64_t total,
                                const LostRowsOptions& options) {
  const std::int64_t looked_at = std::min(total, options.fit_within),
                     step = std::max<std::int64_t>(1, looked_at / options.fit_rows);
  std::int64_t read = 0;
  std::vector<double> kept;
  kept.reserve(
      static_cast<std::size_t>(std::min<std::int64_t>(looked_at, options.fit_rows + 1) * length));
  with_past.stream(records,
                   [&](std::size_t, std::int64_t first, const Eigen::Ref<const Rows>& rows) {
                     const std::int64_t before = (first + step - 1) / step * step - first;
                     for (Index t = order + before; t < rows.rows(); t += step) {
                       const double* own = rows.data() + (t - order) * rows.cols();
                       if (VectorXd::Map(own, length).allFinite())
                         kept.insert(kept.end(), own, own + length);
                     }
                     read += rows.rows() - order;
                     return read < looked_at;
                   });
  return kept;
}

/// Do all channels, the last rows, move for most of the time?
bool all_move(const Eigen::Ref<const MatrixXd>& samples, double share) {
  for (Index c = 0; c < samples.rows(); ++c) {
    const VectorXd own = (samples.row(c).array() - samples.row(c).mean()).abs();
    const double rms = own.norm() / std::sqrt(static_cast<double>(own.size()));
    if (!(numerics::upper_median({own.begin(), own.end()}) >= share * rms)) return false;
  }
  return true;
}

/// Channels of the records, in columns that are read: what excites, then what is predicted of it.
struct Columns {
  std::vector<Index> all{};
  Index outputs{};
};

Columns columns_of(const Reading& reading, Index most_outputs) {
  const auto& plan = reading.plan;
  const bool loop = plan.estimator == Estimator::instrumental;
  std::vector<int> exciting = loop ? plan.choice.instruments : plan.choice.inputs;
  std::vector<int> predicted = plan.choice.outputs;
  if (loop)
    predicted.insert(predicted.begin(), plan.choice.inputs.begin(), plan.choice.inputs.end());
  const auto count =
      std::min<std::size_t>(predicted.size(), static_cast<std::size_t>(most_outputs));
  Columns columns{.outputs = static_cast<Index>(count)};
  const auto add = [&](int c) {
    columns.all.push_back(static_cast<Index>(reading.used[static_cast<std::size_t>(c)]));
  };
  std::ranges::for_each(exciting, add);
  for (std::size_t k = 0; k < count; ++k) add(predicted[k * predicted.size() / count]);
  return columns;
}

/// Where most outputs do not go on from where they were, in rows that come in their order.
class Places {
 public:
  Places(Index outputs, Index order, const LostRowsOptions& options)
      : outputs_(outputs), order_(order), options_(options), last_(order) {}
  /// At a place one of so many outputs stands out, whichever they are.
  [[nodiscard]] Index enough() const { return half() + 1; }
  [[nodiscard]] bool is_quiet(const MatrixXd& e) const {
    return !(e.array() > options_.quiet).any();
  }
  /// use(t) at each place. `e`: by deviations, of the rows from `first` on of the file.
  template <class Use>
  void look(std::size_t file, std::int64_t first, MatrixXd e, const Use& use) {
    if (file != file_) last_ = order_;  // what was before the file is not known
    file_ = file;
    if (is_quiet(e)) return;
    for (Index k = 0; k < e.cols(); ++k) {
      auto own = e.col(k);
      if (!(own.maxCoeff() > options_.quiet)) continue;
      const std::int64_t t = first + k;
      const bool begins = t - last_ > order_;
      last_ = t;
      if (!begins) continue;
      std::ranges::nth_element(own, own.begin() + half());
      if (own[half()] > options_.stands_out) use(t);
    }
  }

 private:
  [[nodiscard]] Index half() const { return outputs_ - 1 - outputs_ / 2; }

  Index outputs_, order_;
  const LostRowsOptions& options_;
  std::size_t file_{};
  std::int64_t last_;  // row of the file with an error that is not quiet
};

}  // namespace

LostRows find_lost_rows(data::RecordSet& records, const Reading& reading,
                        const LostRowsOptions& options, const std::atomic<bool>* stop) {
  const auto stopped = [&] { return stop != nullptr && stop->load(std::memory_order_relaxed); };
  if (reading.inputs_cut_off) return {};
  const Columns columns = columns_of(reading, options.most_outputs);
  const Index D = std::ssize(columns.all), outputs = columns.outputs,
              order = std::min(options.highest_order, options.most_coefficients / D),
              length = (order + 1) * D;
  // one output alone: a spike looks alike
  if (outputs < 2 || order < 2 || reading.total < options.fewest_per_coefficient * length)
    return {};
  const RowsWithPast with_past(columns.all, order);
  const auto kept = rows_to_fit(records, with_past, order, length, reading.total, options);
  const Eigen::Map<const MatrixXd> some(kept.data(), length, std::ssize(kept) / length);
  if (some.cols() < options.fewest_per_coefficient * length || stopped() ||
      !all_move(some.bottomRows(D), options.moves))
    return {};
  const OneStep model(some, outputs, options.outlier);
  const double block = reading.spectrum.block_length;
  const auto out =
      static_cast<std::int64_t>((reading.spectrum.periodic ? 1.0 : options.of_block) * block) + 1;
  LostRows lost;
  Places places(outputs, order, options);
  QuietRows quiet(model, places.enough(), D);
  const auto take = [&](std::size_t file, std::int64_t t) {
    if (lost.places++ == 0) {
      lost.file = file;
      lost.first = t;
    }
    for (const std::size_t c : reading.used) lost.stretches.push_back({file, c, t, t + out});
  };
  with_past.stream(
      records, [&](std::size_t file, std::int64_t first, const Eigen::Ref<const Rows>& rows) {
        constexpr Index at_once = 1024;
        for (Index from = order; from < rows.rows(); from += at_once) {
          Index count = std::min(at_once, rows.rows() - from), begin = from;
          const auto own = [&] { return rows.middleRows(begin - order, order + count); };
          // then none of these rows is a place, and the last ones tell of what comes
          if (quiet.are_quiet(own(), options.quiet) ||
              places.is_quiet(model.errors(own(), places.enough()))) {
            begin += std::max<Index>(0, count - order);
            count = std::min(count, order);
          }
          places.look(file, first + begin - order, model.errors(own(), outputs),
                      [&](std::int64_t t) { take(file, t); });
        }
        return !stopped();
      });
  if (lost.places * options.each > reading.total) return {};
  return lost;
}

LostRowsSearch::LostRowsSearch(const data::RecordSet& records, const Reading& reading)
    : missing_(records.taken_as_missing()) {
  if (!is_worth_a_thread(reading)) return;
  if (auto own = records.of_memory())
    search_.emplace(std::move(*own),
                    [reading](data::RecordSet& set, const std::atomic<bool>& stop) {
                      return find_lost_rows(set, reading, {}, &stop);
                    });
}

LostRows LostRowsSearch::result(data::RecordSet& records, const Reading& reading) {
  if (!search_ || records.taken_as_missing() != missing_) return find_lost_rows(records, reading);
  auto found = search_->result();
  return reading.inputs_cut_off ? LostRows{} : found;
}

namespace {

/// What was taken as missing is not: in place of what `rest` says of that comes what `measured`
/// says, which is about the file.
void restore_warnings_of_missing(const Measurement& measured, Measurement& rest) {
  using Kind = data::ResponseWarning::Kind;
  const auto is_about_missing = [](const data::ResponseWarning& w) {
    return w.kind == Kind::missing_samples || w.kind == Kind::blocks_left_out;
  };
  auto& warnings = rest.responses.warnings;
  std::erase_if(warnings, is_about_missing);
  std::ranges::copy_if(measured.responses.warnings, std::back_inserter(warnings), is_about_missing);
}

}  // namespace

void take_without_lost_rows(const LostRows& lost, std::optional<Measurement> rest,
                            const data::RecordSet& records, Measurement& measured,
                            const LostRowsOptions& options) {
  const auto share_left_out = [&](const Measurement& m) {
    return measured.record != nullptr
               ? 1.0
               : 1.0 - static_cast<double>(m.spectra.blocks) /
                           static_cast<double>(std::max<std::int64_t>(1, measured.spectra.blocks));
  };
  const double share = rest ? share_left_out(*rest) : 1.0;
  const auto inputs = static_cast<double>(measured.choice.inputs.size());
  const bool left_out = rest && rest->record == nullptr && rest->spectra.blocks > 0 &&
                        rest->spectra.statistics.effective_averages >= inputs + options.degrees;
  if (left_out) {
    restore_warnings_of_missing(measured, *rest);
    measured = std::move(*rest);
  }
  measured.responses.warnings.push_back(
      {.kind = data::ResponseWarning::Kind::lost_rows,
       .other = records.files().size() > 1 ? records.files()[lost.file] : "",
       .value = static_cast<double>(lost.first) / records.header().sample_rate,
       .share = share,
       .count = lost.places,
       .total = left_out ? lost.places : 0});
}

}  // namespace hydrapod::identification
