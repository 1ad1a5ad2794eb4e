#pragma once
/// Reads bytes as a record through a file in memory and checks what the reader promises.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "hydrapod/base/text.hpp"
#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/data/record_io.hpp"

namespace hydrapod::fuzz {

inline void require_presentable(const base::Diagnostic& diagnostic) {
  const std::string text = diagnostic.text();
  const bool one_line = text.find('\n') == std::string::npos;
  const bool utf8 = base::first_invalid_utf8(text) == std::string::npos;
  if (!one_line || !utf8 || diagnostic.message.empty()) std::abort();
}

inline void read_to_the_end(const std::string& path) {
  data::file_kind(path);
  data::RecordSet record({path}, {.sample_rate = 100.0});
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
  static const int file = memfd_create("record", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (ftruncate(file, 0) != 0 ||
      pwrite(file, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    std::abort();
  try {
    read_to_the_end(path);
  } catch (const base::InputError& error) {
    if (error.diagnostics().empty()) std::abort();
    for (const auto& diagnostic : error.diagnostics()) require_presentable(diagnostic);
  }
  try {
    const auto responses = data::read_frequency_responses(path).responses;
    data::validate(responses);
    data::response_table(responses);
  } catch (const base::InputError& error) {
    if (error.diagnostics().empty()) std::abort();
  }
  try {
    const auto modes = data::read_modal_results(path).results;
    for (const auto& mode : modes.modes)
      if (mode.shape.size() != static_cast<Eigen::Index>(modes.outputs.size())) std::abort();
  } catch (const base::InputError& error) {
    if (error.diagnostics().empty()) std::abort();
  }
}

}  // namespace hydrapod::fuzz
