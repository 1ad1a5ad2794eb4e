#pragma once
/// Reads bytes as a record through a file and checks what the reader promises.

#include "fuzz.hpp"
#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/data/record_io.hpp"

namespace hydrapod::fuzz {

/// What `read` gives for the rate that a file states, or for 100 Hz where it states none.
template <class Read>
auto with_a_rate(const Read& read) {
  try {
    return read(data::ReadOptions{});
  } catch (const base::InputError&) {
    return read(data::ReadOptions{.sample_rate = 100.0});
  }
}

inline void read_to_the_end(const std::string& path) {
  data::file_kind(path);
  data::RecordSet record =
      with_a_rate([&](const auto& options) { return data::RecordSet({path}, options); });
  data::validate(record.header());
  constexpr std::int64_t most = 2'000'000;  // numbers: a fuzzer has no time for more
  std::int64_t numbers = 0;
  const bool complete = record.stream([&](std::size_t /*file*/, const auto& block) {
    numbers += block.size();
    return numbers <= most;
  });
  if (!complete) return;
  if (record.sample_count() != record.count_samples(0)) std::abort();
  for (const auto& note : record.notes()) require_presentable(note);
}

inline void read_as_record(const std::string& bytes) {
  const std::string& path = file_of(bytes);
  accepted([&] { read_to_the_end(path); });
  accepted([&] {
    const auto responses = data::read_frequency_responses(path).responses;
    data::validate(responses);
    data::response_table(responses);
  });
  accepted([&] {
    const auto modes = data::read_modal_results(path).results;
    for (const auto& mode : modes.modes)
      if (mode.shape.size() != static_cast<Eigen::Index>(modes.outputs.size())) std::abort();
  });
}

}  // namespace hydrapod::fuzz
