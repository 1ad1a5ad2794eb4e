#pragma once
/// What stands beside the samples in files of named arrays: times, rates, names, units.

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "notes.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

/// Is the last part of `name` ("group/name", "structure.name") one of `words`? All small letters.
bool is_one_of(std::span<const std::string_view> words, const std::string& name);

bool is_time_variable(const std::string& name);
/// Of numbers in one dimension, more than one, with such a name.
bool are_times(const Variable& variable);
/// Numbers of a list from `first` on. False when the file is damaged there.
bool read_list(VariableFile& file, std::size_t variable, std::uint64_t first,
               std::span<double> out);
/// Of a number that is the time of the first sample.
bool is_start_name(const std::string& name);

/// A sample rate that a variable states.
struct RateVariable {
  double hertz{};  ///< NaN: its unit is of something else
  std::string name{}, unit{};
  const char* accepted{};  ///< units
  bool is_step{};          ///< of time
  bool has_unit{};         ///< stated by the file, else Hz or s is assumed
};

/// What to do about a number without a unit that is not in `unit`.
inline std::string state_the_unit(std::string_view unit) {
  return "write " + std::string(unit) + " into the file, or (HDF5) an attribute \"unit\"";
}

/// All of them; where some stand beside the arrays `samples`, in their group or structure or on
/// top, only these. One in a unit that is none of a rate or of a time, as a step of a stage, is
/// left aside with a note; where a rate is `needed` and there is no other, this fails.
std::vector<RateVariable> rates_beside(const std::vector<Variable>& variables,
                                       const std::vector<std::string>& samples, bool needed,
                                       Notes& notes);

struct ChannelTexts {
  std::vector<std::string> names{}, units{};  ///< one per channel, or none at all
};

/// What analysers put beside the samples of some channels.
ChannelTexts texts_beside(const std::vector<Variable>& variables, const std::string& samples,
                          std::size_t channels);

/// Fails where parts of the file, groups or structures, have times or starts of their own that
/// differ from those of another part: they are several records.
void require_one_record(VariableFile& file, const Notes& notes);

/// Fails where an axis is in another unit than one of time: it belongs to spectra.
void require_time_axes(const std::vector<Variable>& variables, const Notes& notes);

}  // namespace hydrapod::data
