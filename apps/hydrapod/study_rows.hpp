#pragma once
/// What is made of a study's rows while they are read once, in bounded memory: the table of --csv
/// and the values of a heat map.

#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/file.hpp"
#include "hydrapod/tasks/study.hpp"

namespace hydrapod::cli {

/// The command of this run, without what says where results go and how they are computed: an
/// interrupted run that was gone on with has the same.
std::string study_command();

/// Lines above the table of --csv: which machine, and how it was made. There is no date: the same
/// command writes the same file.
std::vector<std::string> comments_of(const tasks::StudyJob& job, const std::string& command);

class StudyRows {
 public:
  /// `csv`: file of the table; `output`: name of the output that is mapped. Empty: not wanted.
  /// `comments`: lines above the table.
  StudyRows(const tasks::StudyJob& job, std::string csv, const std::string& output,
            const std::vector<std::string>& comments);

  [[nodiscard]] bool are_wanted() const { return output_ || !csv_.empty(); }
  /// Rows in their order: inputs, then outputs, row by row. Throws base::ComputationError where the
  /// table cannot be written.
  void take(std::span<const double> rows);
  /// The table takes its place and is announced. One that is not complete replaces no other file.
  void close_csv(bool complete);
  /// Of the output that is mapped; NaN where a row has none, fewer than rows after an interruption.
  [[nodiscard]] const std::vector<double>& values() const { return values_; }
  /// Of the output `stroke` beside it; empty without one.
  [[nodiscard]] const std::vector<double>& stroke_left() const { return stroke_left_; }

 private:
  void open_csv();
  void write(std::string_view text);
  [[noreturn]] void fail() const;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::string csv_, titles_{};
  std::size_t width_;
  std::optional<std::size_t> output_{}, stroke_{};  ///< their columns
  std::vector<double> values_{}, stroke_left_{};
  std::optional<base::PartFile> part_{};
  std::unique_ptr<std::FILE, Close> file_{};
};

}  // namespace hydrapod::cli
