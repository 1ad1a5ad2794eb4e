#pragma once
/// What a Universal File holds: datasets 58 and 58b (functions), 55 and 2414 (modes), 250, 252 and 2453
/// (matrices), 151 (header), 164 (units), 15, 2411, 2412 and 82 (geometry).
///
/// Layouts: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File
/// Formats for Modal Analysis Testing", datasets 58, 151 and 164 and "The Binary 58 Universal File
/// Format".

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "channel_units.hpp"
#include "file_window.hpp"
#include "hydrapod/data/record_io.hpp"
#include "notes.hpp"
#include "record_comments.hpp"

namespace hydrapod::data {

inline constexpr int uff_own_dataset = 99001;  ///< header of a record as hydrapod's comment lines

inline constexpr int uff_modes = 55, uff_analysis = 2414;

inline constexpr int uff_header_lines = 11;  ///< of dataset 58
inline constexpr double uff_missing = std::numeric_limits<double>::quiet_NaN();

namespace uff_function {  // function types of dataset 58
inline constexpr int general = 0, time_response = 1, frequency_response = 4, coherence = 6,
                     multiple_coherence = 26;
}
namespace uff_quantity {  // specific data types of records 8 to 11
inline constexpr int unknown = 0, general = 1, stress = 2, strain = 3, temperature = 5,
                     displacement = 8, reaction_force = 9, velocity = 11, acceleration = 12,
                     excitation_force = 13, pressure = 15, mass = 16, time = 17, frequency = 18;
}

/// Records 8 to 11: what an axis shows.
struct UffAxis {
  int quantity{uff_quantity::unknown};
  int length_exponent{}, force_exponent{}, temperature_exponent{};
  std::string label{"NONE"};
  std::string unit{"NONE"};
};

/// Record 6: where and in which direction.
struct UffPlace {
  std::string entity{"NONE"};
  long long node{};
  int direction{};  ///< −6 … 6, as Direction
};

/// Dataset 164: value in SI = value in the file / factor, by powers; an absolute temperature is
/// value / factor + offset / factor.
struct UffUnits {
  int code{1};
  std::string description{"SI: Meter (newton)"};
  double length{1.0}, force{1.0}, temperature{1.0}, temperature_offset{273.15};
  bool usable{true};  ///< false: it does not say which units hold
};

/// Dataset 58 without its values.
struct UffFunction {
  std::size_t dataset{};  ///< its number in the file, from 1
  unsigned line{};        ///< of its first line; 0 where binary data stand before it
  std::array<std::string, 5> id{"NONE", "NONE", "NONE", "NONE", "NONE"};
  int type{uff_function::general};
  long long number{}, version{}, load_case{};
  UffPlace response{}, reference{};
  bool is_complex{}, is_double{true}, is_even{true};
  std::uint64_t declared{};  ///< number of values, complex ones counted once
  double first{}, step{};    ///< of an even abscissa
  double z{};
  UffAxis abscissa{}, ordinate{}, denominator{}, z_axis{};
  std::optional<UffUnits> units{};  ///< that hold for it, if the file states some

  // where the values are
  bool binary{};
  bool big_endian{};
  bool wide_abscissa{};          ///< binary and uneven: abscissae are doubles
  bool free_form{};              ///< ASCII, not in the columns of the format
  std::uint64_t begin{}, end{};  ///< bytes in the file
  unsigned data_line{};
  std::uint64_t count{};  ///< values that are really there
};

/// Dataset 55 or 2414 (a mode) or one of a matrix, line by line, without its number.
struct UffLines {
  int number{};
  std::vector<std::string> lines{};
  unsigned line{};  ///< of the first one in the file; 0 where binary data stand before it
  std::optional<UffUnits> units{};
};

struct UffContents {
  std::vector<UffFunction> functions{};
  std::vector<UffLines> modes{};
  std::vector<UffLines> matrices{};
  std::string model_name{}, description{}, program{}, date{};  ///< dataset 151
  Geometry geometry{};                                         ///< [m]
  RecordComments own{};
};

/// Reads all but the values of the functions. What is skipped or damaged is noted; throws
/// base::InputError only where there is no dataset at all. Matrices can be large: they are skipped
/// unless `with_matrices` is set, and then a binary one is an error.
UffContents scan_uff(const std::string& path, Notes& notes, bool with_matrices = false);

/// Is it a record, are frequency responses or modes in it? Reads heads of datasets and hardly any
/// values: files are large. Throws base::InputError as scan_uff.
FileKind uff_kind(const std::string& path);

/// A text of a Universal File; empty where it is "NONE".
inline std::string given(const std::string& text) { return text == "NONE" ? "" : text; }

/// The direction that is said by code or as the entity "LEG n".
Direction uff_direction(const UffPlace& place);
/// The node, unless it has more digits than a channel's point.
int uff_point(const UffPlace& place);
/// The part that it belongs to; empty where there is none.
std::string uff_entity(const UffPlace& place);
/// Node and direction of a channel.
UffPlace uff_place(const Channel& channel);

/// The lines of text of a function of another program, without those at the end that say nothing.
std::vector<std::string> uff_id_lines(const std::array<std::string, 5>& id);
/// And back: these lines in place of those that are there, unless there are none.
void put_id_lines(const std::vector<std::string>& lines, std::array<std::string, 5>& id);

/// Channels of another program that share a name, or have none, get their node and direction into
/// it.
void name_by_place(std::vector<Channel>& channels);

/// SI unit of an axis and the factor to it: its unit label if that is known, else dataset 164 with
/// the exponents of its quantity. Without dataset 164 SI is assumed, and noted.
ChannelUnit uff_unit(const UffAxis& axis, int direction, const std::optional<UffUnits>& units,
                     Notes& notes);
/// What one of the abscissa is in Hz or in seconds, by its unit label; none, "NONE" and one that is
/// not known, which is noted, are Hz or s. Another unit is refused.
double uff_hertz(const UffFunction& function, Notes& notes);
double uff_seconds(const UffFunction& function, Notes& notes);
/// Quantity, exponents and label of an axis that shows `unit`, a coherent SI unit.
UffAxis uff_axis_of(const std::string& label, const std::string& unit);

/// The values of a function one after the other.
class UffValues {
 public:
  UffValues(const FileWindow& file, const UffFunction& function, std::size_t window = 1U << 16U);

  /// The next number as it stands in the file: [abscissa,] value or [abscissa,] real, imaginary
  /// part. False at the end. Text where a number should be is NaN and noted.
  bool next(double& number, Notes& notes);

 private:
  bool next_binary(double& number);
  bool fill_from_line(Notes& notes);

  UffFunction function_;
  FileWindow file_;
  std::uint64_t offset_;
  unsigned line_;
  std::size_t place_in_tuple_{};
  std::vector<double> numbers_;
  std::size_t taken_{};
};

/// Numbers per value: abscissa if uneven, real and imaginary part.
std::size_t tuple_size(const UffFunction& function);

/// The numbers of a line of ASCII values; `widths` are the columns. Text is NaN, and `bad` then the
/// column (from 1) of the first one.
std::vector<double> uff_line_numbers(std::string_view line, const std::vector<int>& widths,
                                     bool free_form, unsigned& bad);
/// Columns of a line of ASCII values.
std::vector<int> uff_widths(const UffFunction& function);

}  // namespace hydrapod::data
