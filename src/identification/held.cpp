#include "held.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "names.hpp"
#include "sample_sums.hpp"

namespace hydrapod::identification {

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

struct HeldRun {
  std::size_t file{};
  std::int64_t begin{}, length{};
  double value{};
  double before{no_number}, after{no_number};  ///< the samples beside it
  [[nodiscard]] std::int64_t end() const { return begin + length; }
};

/// All of a channel.
struct HeldAccount {
  double last{no_number}, step{std::numeric_limits<double>::infinity()};
  SampleSums all{};
  std::int64_t changes{};
  HeldRun run{};
  std::vector<HeldRun> runs{};  // long ones

  void begin(std::size_t file, std::int64_t least) {
    end_run(least);
    last = no_number;
    run = {.file = file};
  }
  void add(double x, std::int64_t at, std::int64_t least) {
    all.add(x);
    if (x == last) {
      ++run.length;
      return;
    }
    if (const double by = std::abs(x - last); by > 0.0) step = std::min(step, by);
    ++changes;
    run.after = x;
    end_run(least);
    run = {run.file, at, 1, x, last};
    last = x;
  }
  void end_run(std::int64_t least) {
    if (run.length >= least) runs.push_back(run);
    run.length = 0;
  }
  /// Samples that a value lasts, in the mean.
  [[nodiscard]] double usual() const {
    return static_cast<double>(all.count) / static_cast<double>(std::max<std::int64_t>(1, changes));
  }
  /// Without `runs`.
  [[nodiscard]] SampleSums others() const {
    SampleSums sums = all;
    for (const HeldRun& own : runs) sums.add(own.value, -own.length);
    return sums;
  }
  void keep_unusual(double of_usual, const HeldOptions& options);
};

/// The longest runs, by the mean length of all others.
void HeldAccount::keep_unusual(double of_usual, const HeldOptions& options) {
  std::ranges::sort(runs, std::greater(), &HeldRun::length);
  std::size_t kept = 0;
  std::int64_t held = 0;
  // with each run that goes, the mean of the others falls
  for (bool more = true; more;) {
    const double usual =
        static_cast<double>(all.count - held) /
        static_cast<double>(std::max<std::int64_t>(1, changes - static_cast<std::int64_t>(kept)));
    more = false;
    for (; kept < std::min(runs.size(), options.most) &&
           static_cast<double>(runs[kept].length) >= of_usual * usual;
         ++kept) {
      held += runs[kept].length;
      more = true;
    }
  }
  runs.resize(kept);
  const SampleSums sums = others();
  if (sums.count == 0 || sums.rms() < options.of_step * step) runs.clear();
}

/// use(file, first, samples) for all pieces of all files.
template <class Begin, class Use>
void for_pieces(data::RecordSet& records, const Begin& begin, const Use& use) {
  std::optional<std::size_t> current;
  std::int64_t first = 0;
  records.stream([&](std::size_t file, const Eigen::Ref<const data::Samples>& block) {
    if (current != file) {
      begin(file);
      first = 0;
    }
    current = file;
    use(file, first, block);
    first += block.rows();
    return true;
  });
}

std::vector<HeldAccount> accounts_of(data::RecordSet& records, const std::vector<std::size_t>& used,
                                     const HeldOptions& options) {
  std::vector<HeldAccount> accounts(used.size());
  for_pieces(
      records,
      [&](std::size_t file) {
        for (auto& account : accounts) account.begin(file, options.least);
      },
      [&](std::size_t, std::int64_t first, const Eigen::Ref<const data::Samples>& block) {
        for (std::size_t c = 0; c < used.size(); ++c)
          for (Index t = 0; t < block.rows(); ++t)
            accounts[c].add(block(t, static_cast<Index>(used[c])), first + t, options.least);
      });
  for (auto& account : accounts) account.end_run(options.least);
  return accounts;
}

/// A run that may be held, and what goes on beside and during it.
struct HeldCandidate {
  int channel{};
  HeldRun run{};
  SampleSums before{}, after{};
  std::vector<int> movers{};
  std::vector<SampleSums> during{}, later{};  // of the movers; `later`: in the last half of the run

  [[nodiscard]] std::int64_t beside(const HeldOptions& options) const {
    const double share = options.beside_share * static_cast<double>(run.length);
    return std::clamp(std::llround(share), static_cast<long long>(options.least_beside),
                      static_cast<long long>(options.most_beside));
  }
};

/// Runs of all living channels at once, the longest of each channel being known.
std::vector<HeldRun> runs_of_all(const std::vector<HeldAccount>& accounts,
                                 const HeldOptions& options) {
  std::vector<HeldRun> common;
  bool begun = false;
  for (const auto& account : accounts) {
    if (!(account.all.variance() > 0.0)) continue;
    std::vector<HeldRun> both;
    for (const HeldRun& own : account.runs) {
      if (static_cast<double>(own.length) < options.of_usual_of_all * account.usual()) continue;
      if (!begun) both.push_back(own);
      for (const HeldRun& other : common) {
        const std::int64_t begin = std::max(own.begin, other.begin),
                           end = std::min(own.end(), other.end());
        if (own.file == other.file && end - begin >= options.least)
          both.push_back({own.file, begin, end - begin});
      }
    }
    common = std::move(both);
    begun = true;
  }
  std::ranges::sort(common, {}, [](const HeldRun& run) { return std::pair(run.file, run.begin); });
  return common;
}

/// Did the recorder stop, and not the machine? Mean squares over the outputs, by their variance.
bool is_drop_out(const HeldRun& run, const std::vector<HeldAccount>& accounts,
                 const ChannelChoice& choice, const HeldOptions& options) {
  double into = 0.0, out = 0.0, away = 0.0, living = 0.0;
  for (const int o : choice.outputs) {
    const auto& account = accounts[static_cast<std::size_t>(o)];
    if (!(account.all.variance() > 0.0)) continue;
    const auto own = std::ranges::find_if(account.runs, [&](const HeldRun& other) {
      return other.file == run.file && other.begin <= run.begin && other.end() >= run.end();
    });
    if (own == account.runs.end() || !std::isfinite(own->before - own->after) ||
        account.all.rms() < options.of_step * account.step)
      return false;
    const auto square = [&](double x) { return x * x / account.all.variance(); };
    into += square(own->before - own->value);
    out += square(own->after - own->value);
    away += square(own->value - account.all.mean());
    ++living;
  }
  const double least = options.jumps * living;
  return into > least || (out > least && away > least);
}

/// Stretches of all channels, and a warning; the runs.
std::vector<HeldRun> add_drop_outs(const data::RecordHeader& header,
                                   const std::vector<std::size_t>& used,
                                   const std::vector<HeldAccount>& accounts,
                                   const ChannelChoice& choice, const HeldOptions& options,
                                   Held& held) {
  data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::drop_outs};
  std::vector<HeldRun> drop_outs;
  std::int64_t all = 1;
  for (const auto& account : accounts) all = std::max(all, account.all.count);
  for (const HeldRun& run : runs_of_all(accounts, options)) {
    if (!is_drop_out(run, accounts, choice, options)) continue;
    for (const std::size_t c : used) held.stretches.push_back({run.file, c, run.begin, run.end()});
    drop_outs.push_back(run);
    ++warning.total;
    warning.count += run.length;
    warning.value = std::max(warning.value, static_cast<double>(run.length) / header.sample_rate);
  }
  warning.share = static_cast<double>(warning.count) / static_cast<double>(all);
  if (warning.total > 0) held.warnings.push_back(std::move(warning));
  return drop_outs;
}

/// What moves a channel; empty: that is not known.
std::vector<int> movers_of(int channel, const ChannelChoice& choice,
                           const std::vector<HeldAccount>& accounts) {
  std::vector<int> movers;
  const auto add = [&](const std::vector<int>& channels) {
    for (const int c : channels)
      if (c != channel && accounts[static_cast<std::size_t>(c)].all.variance() > 0.0)
        movers.push_back(c);
  };
  const bool is_output = std::ranges::find(choice.outputs, channel) != choice.outputs.end();
  if (is_output && choice.inputs.empty()) {
    add(choice.outputs);
  } else if (is_output) {
    add(choice.inputs);
    add(choice.instruments);
  } else if (choice.inputs.size() == 1 && choice.inputs[0] == channel &&
             (choice.instruments.empty() || choice.instruments == choice.inputs)) {
    add(choice.outputs);
  }
  return movers;
}

std::vector<HeldCandidate> candidates_of(std::vector<HeldAccount>& accounts,
                                         const ChannelChoice& choice, const HeldOptions& options) {
  std::vector<HeldCandidate> candidates;
  for (std::size_t k = 0; k < accounts.size(); ++k) {
    const auto c = static_cast<int>(k);
    const bool is_output = std::ranges::find(choice.outputs, c) != choice.outputs.end();
    auto& account = accounts[k];
    account.keep_unusual(is_output ? options.of_usual : options.of_usual_input, options);
    const auto movers = movers_of(c, choice, accounts);
    const bool too_still = static_cast<double>(account.others().count) <
                               options.moves * static_cast<double>(account.all.count) ||
                           account.runs.size() > options.most_of_input;
    if (movers.empty() || (!is_output && too_still)) continue;
    for (const HeldRun& run : account.runs)
      candidates.push_back({.channel = c,
                            .run = run,
                            .movers = movers,
                            .during = std::vector<SampleSums>(movers.size()),
                            .later = std::vector<SampleSums>(movers.size())});
  }
  return candidates;
}

/// Samples `from` … `to` of a file, those of them that a block from `first` on has.
template <class Column>
void add_part(const Column& column, std::int64_t first, std::int64_t from, std::int64_t to,
              SampleSums& sums) {
  const std::int64_t begin = std::max(from, first),
                     end = std::min<std::int64_t>(to, first + column.size());
  for (std::int64_t t = begin; t < end; ++t) sums.add(column[t - first]);
}

void measure_candidates(data::RecordSet& records, const std::vector<std::size_t>& used,
                        const HeldOptions& options, std::vector<HeldCandidate>& candidates) {
  const auto part = [&](const Eigen::Ref<const data::Samples>& block, std::int64_t first, int c,
                        std::int64_t from, std::int64_t to, SampleSums& sums) {
    const auto k = static_cast<std::size_t>(c);
    add_part(block.col(static_cast<Index>(used[k])), first, from, to, sums);
  };
  for_pieces(
      records, [](std::size_t) {},
      [&](std::size_t file, std::int64_t first, const Eigen::Ref<const data::Samples>& block) {
        for (auto& candidate : candidates) {
          const HeldRun& run = candidate.run;
          if (run.file != file) continue;
          const std::int64_t end = run.begin + run.length, near = candidate.beside(options);
          part(block, first, candidate.channel, run.begin - near, run.begin, candidate.before);
          part(block, first, candidate.channel, end, end + near, candidate.after);
          for (std::size_t m = 0; m < candidate.movers.size(); ++m) {
            part(block, first, candidate.movers[m], run.begin, end, candidate.during[m]);
            part(block, first, candidate.movers[m], run.begin + run.length / 2, end,
                 candidate.later[m]);
          }
        }
      });
}

bool is_held(const HeldCandidate& candidate, const std::vector<HeldAccount>& accounts,
             bool is_output, const HeldOptions& options) {
  const SampleSums others = accounts[static_cast<std::size_t>(candidate.channel)].others();
  const double least = options.beside * options.beside * others.variance();
  // at an end of the record there is nothing beside it
  const bool begins = candidate.before.count >= options.least_beside,
             ends = candidate.after.count >= options.least_beside;
  if ((begins && candidate.before.variance() < least) ||
      (ends && candidate.after.variance() < least) || (!begins && !ends))
    return false;
  for (std::size_t m = 0; m < candidate.movers.size(); ++m) {
    const SampleSums& all = accounts[static_cast<std::size_t>(candidate.movers[m])].all;
    const auto power = [&](const SampleSums& sums) {
      return sums.count > 0 ? sums.variance() + std::pow(sums.mean() - all.mean(), 2) : 0.0;
    };
    const double needed = (is_output ? options.goes_on : options.outputs_go_on) * all.variance();
    if (!(power(is_output ? candidate.during[m] : candidate.later[m]) >= needed)) return false;
  }
  return true;
}

}  // namespace

void LongestHold::add(const Column& samples) {
  const Index n = samples.size();
  Index head = 0;
  while (head < n && samples[head] == last_) ++head;
  run_ += head;
  longest_ = std::max(longest_, run_);
  if (head == n) return;
  // a run of `least` samples holds one of every `least`
  for (Index at = head + least - 1; at < n;) {
    Index from = at, to = at + 1;
    while (from > head && samples[from - 1] == samples[at]) --from;
    while (to < n && samples[to] == samples[at]) ++to;
    longest_ = std::max<std::int64_t>(longest_, to - from);
    at = to - 1 + least;
  }
  Index from = n - 1;
  while (from > head && samples[from - 1] == samples[n - 1]) --from;
  run_ = n - from;
  last_ = samples[n - 1];
  longest_ = std::max(longest_, run_);
}

bool may_be_held(const CrossSpectra& spectra) {
  return std::ranges::any_of(spectra.health,
                             [](const ChannelHealth& health) { return health.longest_hold > 0; });
}

Held find_held(data::RecordSet& records, const std::vector<std::size_t>& used,
               const ChannelChoice& choice, const HeldOptions& options) {
  auto accounts = accounts_of(records, used, options);
  Held held;
  const auto drop_outs = add_drop_outs(records.header(), used, accounts, choice, options, held);
  const auto is_in_drop_out = [&](const HeldRun& run) {
    return std::ranges::any_of(drop_outs, [&](const HeldRun& lost) {
      return lost.file == run.file && lost.begin < run.end() && run.begin < lost.end();
    });
  };
  auto candidates = candidates_of(accounts, choice, options);
  if (candidates.empty()) return held;
  measure_candidates(records, used, options, candidates);
  for (std::size_t c = 0; c < used.size(); ++c) {
    const bool is_output =
        std::ranges::find(choice.outputs, static_cast<int>(c)) != choice.outputs.end();
    data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::held,
                                  .channel = records.header().channels[used[c]].name};
    for (const auto& candidate : candidates) {
      if (candidate.channel != static_cast<int>(c) || is_in_drop_out(candidate.run) ||
          !is_held(candidate, accounts, is_output, options))
        continue;
      const HeldRun& run = candidate.run;
      held.stretches.push_back({run.file, used[c], run.begin, run.begin + run.length});
      ++warning.total;
      warning.count += run.length;
      warning.value =
          std::max(warning.value, static_cast<double>(run.length) / records.header().sample_rate);
    }
    if (warning.total == 0) continue;
    warning.share = static_cast<double>(warning.count) /
                    static_cast<double>(std::max<std::int64_t>(1, accounts[c].all.count));
    if (is_output && warning.share > options.too_much)
      for (std::size_t file = 0; file < records.files().size(); ++file)
        held.stretches.push_back({file, used[c], 0, std::numeric_limits<std::int64_t>::max()});
    held.warnings.push_back(std::move(warning));
  }
  return held;
}

}  // namespace hydrapod::identification
