#pragma once
/// Files that hold named arrays, as MAT files and HDF5 files do, seen alike.

#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hydrapod/data/record_io.hpp"
#include "notes.hpp"

namespace hydrapod::data {

inline constexpr std::size_t longest_text = 64U << 20U;  ///< bytes

/// `array`: numbers that are no samples, for more than two dimensions or because they are complex.
enum class VariableKind { numbers, text, texts, array };

/// What is said of complex numbers where samples are read.
inline constexpr const char* complex_words =
    "is complex, and samples are real numbers (write its real and its imaginary part as two "
    "arrays)";

/// An array of one or two dimensions, but for kind `array`. Of two, `fast` is the one whose
/// neighbours stand side by side in the file: rows of a MATLAB matrix, the last index in HDF5. A
/// list has slow = 1.
struct Variable {
  std::string name{};
  VariableKind kind{VariableKind::numbers};
  std::uint64_t fast{1}, slow{1};
  std::uint64_t declared{};  ///< lines of numbers, where the file is cut off and has fewer
  std::vector<std::uint64_t> sizes{};  ///< of numbers and arrays, the fastest index first
  bool is_complex{};
  std::string unit{};                ///< from an attribute; empty: unknown
  double number{};                   ///< of a scalar
  std::string text{};                ///< of kind text
  std::vector<std::string> texts{};  ///< of kind texts
};

class VariableFile {
 public:
  VariableFile() = default;
  VariableFile(const VariableFile&) = delete;
  VariableFile& operator=(const VariableFile&) = delete;
  virtual ~VariableFile() = default;

  [[nodiscard]] RecordFormat format() const { return format_; }
  [[nodiscard]] const std::vector<Variable>& variables() const { return variables_; }
  /// Numbers of a variable: whole lines (fast_first = 0, fast_count = fast), or a part of one line
  /// (slow_count = 1), line by line. Reads on from where it was before are fast. False when the
  /// file is damaged there.
  virtual bool read(std::size_t variable, std::uint64_t slow_first, std::uint64_t slow_count,
                    std::uint64_t fast_first, std::uint64_t fast_count, double* out) = 0;
  /// All numbers of numbers or an array, in the order of the file; real ones with imaginary part 0.
  /// False when the file is damaged there or they are more than fit into memory.
  virtual bool read_all(std::size_t variable, std::vector<std::complex<double>>& out) = 0;

 protected:
  static constexpr std::uint64_t most_in_memory = std::uint64_t{1} << 26U;  ///< complex numbers

  RecordFormat format_{};
  std::vector<Variable> variables_;
};

/// Opens such a file. Throws base::InputError. What cannot be used is noted.
using OpenVariableFile = std::unique_ptr<VariableFile> (*)(const std::string& path, Notes& notes);
std::unique_ptr<VariableFile> open_mat5_file(const std::string& path, Notes& notes);
/// In a process of its own, see apart.hpp; sanitized builds and fuzz targets read here.
bool hdf5_is_read_apart();
std::unique_ptr<VariableFile> open_hdf5_variables(const std::string& path, Notes& notes);
std::unique_ptr<VariableFile> open_hdf5_here(const std::string& path, Notes& notes);
/// What is said of a file that HDF5 does not open.
inline constexpr const char* hdf5_not_opened =
    "the HDF5 file is damaged or cut off: it cannot be opened; `hydrapod record recover` reads "
    "what is left of a record of hydrapod";
/// What is left of a record of hydrapod in an HDF5 file that HDF5 does not open, see
/// hdf5_remains.cpp; in a process of its own, or here.
std::unique_ptr<VariableFile> open_hdf5_remains(const std::string& path, Notes& notes);
std::unique_ptr<VariableFile> open_hdf5_remains_here(const std::string& path, Notes& notes);

}  // namespace hydrapod::data
