#pragma once
/// The samples of channels in the arrays of a file, side by side.

#include <optional>
#include <span>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

/// Where the samples of some channels are.
struct Source {
  std::size_t variable{};
  bool samples_are_slow{};      ///< channels side by side
  std::size_t first_channel{};  ///< of all that there are
  std::size_t channels{};
};

class SampleSources {
 public:
  explicit SampleSources(VariableFile& file) : file_(&file) {}

  /// The channels of an array, behind those that are there.
  void add(std::size_t variable, bool samples_are_slow, std::size_t channels);
  /// A channel that is no longer one of the record: its numbers are the times.
  void set_times(std::size_t channel) { times_ = channel; }
  [[nodiscard]] const std::vector<Source>& all() const { return all_; }

  /// Samples from `first` on, as many as `block` has rows, without the times; these into `times`,
  /// if it is not empty. False when the file is damaged there.
  bool read(std::uint64_t first, Eigen::Ref<Samples> block, std::span<double> times = {});
  /// The times alone.
  bool read_times(std::uint64_t first, std::span<double> out);

 private:
  bool read_all(std::uint64_t first, Eigen::Ref<Samples> block);
  bool read_source(const Source& source, std::uint64_t first, Eigen::Ref<Samples> block);

  VariableFile* file_;
  std::vector<Source> all_{};
  std::optional<std::size_t> times_{};
  Samples buffer_{}, wide_{};
};

}  // namespace hydrapod::data
