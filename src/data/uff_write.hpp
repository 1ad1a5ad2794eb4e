#pragma once
/// Datasets of Universal Files as text, column by column.

#include <string>

#include "uff_dataset.hpp"

namespace hydrapod::data {

inline constexpr const char* uff_delimiter = "    -1\n";

/// From the first delimiter to the last line before the values. Of a binary function the number of
/// bytes is that of `f.declared` values.
std::string uff_function_head(const UffFunction& f);

/// Dataset 151; `date` as in RecordHeader.
std::string uff_file_header(const std::string& model, const std::string& description,
                            const std::string& date);
/// Dataset 164 for SI.
std::string uff_si_units();

/// Quantity, exponents and label of an axis that shows `unit`, a coherent SI unit.
UffAxis uff_axis_of(const std::string& label, const std::string& unit);

/// ASCII values, line by line.
class UffLines {
 public:
  explicit UffLines(const UffFunction& f);
  /// Adds a number; a line that is full goes to `out`.
  void add(double number, std::string& out);
  /// What is left of a line.
  void finish(std::string& out);

 private:
  std::vector<int> widths_;
  std::size_t column_{};
};

}  // namespace hydrapod::data
