#include "hydrapod/study_rows.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <utility>

#include "hydrapod/base/text.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/reproduction.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

std::string study_command() {
  constexpr std::array alone{"--resume", "--join", "--no-mpi", "--force"};
  constexpr std::array valued{"--threads", "--shard",  "--results", "--csv",   "-o",
                              "--output",  "--format", "--plot",    "--worst", "--value"};
  const auto given = record_origin().command;
  std::vector<std::string> kept;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const auto name = given[k].substr(0, given[k].find('='));
    if (std::ranges::find(alone, given[k]) != alone.end()) continue;
    if (std::ranges::find(valued, name) == valued.end())
      kept.push_back(given[k]);
    else if (name == given[k])
      ++k;
  }
  return shell_text(kept);
}

std::vector<std::string> comments_of(const tasks::StudyJob& job, const std::string& command) {
  std::vector<std::string> lines{
      fmt::format("hydrapod study: {}, pose {}, {} model", job.machine.file.machine.name,
                  job.machine.pose.name, dynamics::name(job.machine.kind)),
      fmt::format("machine: {}", report::mechanics_state_text(job.machine.file)),
      fmt::format("made by: {}", command)};
  lines.push_back(fmt::format("frequencies are those of {} modes",
                              study::frequency_kind(job.machine.file.machine)));
  for (const auto& [path, sum] : record_origin().inputs)
    lines.push_back(fmt::format("read {}: sha256 {}", path, sum));
  lines.push_back(fmt::format("written by {}", program_text()));
  return lines;
}

StudyRows::StudyRows(const tasks::StudyJob& job, std::string csv, const std::string& output,
                     const std::vector<std::string>& comments)
    : csv_(std::move(csv)), width_(job.problem.inputs.size() + job.problem.outputs.size()) {
  std::string above;
  for (const auto& comment : comments) {
    above += "# " + base::printable(comment, comment.size());
    above += '\n';
  }
  const auto& outputs = job.problem.outputs;
  const auto column_of = [&](const std::string& name) -> std::optional<std::size_t> {
    const auto at = std::ranges::find(outputs, name, &study::Column::name);
    if (at == outputs.end()) return {};
    return job.problem.inputs.size() + static_cast<std::size_t>(at - outputs.begin());
  };
  output_ = column_of(output);
  if (output_) stroke_ = column_of("stroke");
  for (std::size_t k = 0; k < job.problem.inputs.size(); ++k)
    titles_ += fmt::format("{}{} [{}]", titles_.empty() ? "" : ",", job.input_column(k),
                           job.problem.inputs[k].unit);
  for (const auto& one : outputs) titles_ += fmt::format(",{} [{}]", one.name, one.unit);
  titles_ = above + titles_ + "\n";
}

void StudyRows::take(std::span<const double> rows) {
  const auto keep = [&](const std::optional<std::size_t>& column, std::vector<double>& kept) {
    for (std::size_t at = column.value_or(rows.size()); at < rows.size(); at += width_)
      kept.push_back(rows[at]);
  };
  keep(output_, values_);
  keep(stroke_, stroke_left_);
  if (csv_.empty()) return;
  if (!file_) open_csv();
  fmt::memory_buffer text;
  for (std::size_t at = 0; at < rows.size(); ++at) {
    if (std::isfinite(rows[at])) fmt::format_to(std::back_inserter(text), "{:.17g}", rows[at]);
    text.push_back((at + 1) % width_ == 0 ? '\n' : ',');
  }
  write({text.data(), text.size()});
}

void StudyRows::close_csv(bool complete) {
  if (!file_) return;
  const bool written = std::fflush(file_.get()) == 0;
  if (std::fclose(file_.release()) != 0 || !written) fail();
  const std::string place = part_ ? part_->commit(complete) : csv_;
  if (csv_ != "-") print_written(place);
}

/// Devices, pipes and the standard output are written directly.
void StudyRows::open_csv() {
  std::error_code none;
  const bool exists = std::filesystem::exists(csv_, none);
  const bool direct = csv_ == "-" || (exists && !std::filesystem::is_regular_file(csv_, none));
  if (!direct) part_.emplace(csv_);
  const std::string& name = direct ? csv_ : part_->part();
  file_.reset(csv_ == "-" ? ::fdopen(::dup(STDOUT_FILENO), "w") : std::fopen(name.c_str(), "w"));
  if (!file_) fail();
  write(titles_);
}

void StudyRows::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail();
}

void StudyRows::fail() const {
  throw base::ComputationError(fmt::format("writing '{}' failed: {}", csv_, std::strerror(errno)));
}

}  // namespace hydrapod::cli
