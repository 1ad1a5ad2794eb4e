#include "uff_write.hpp"

#include <fmt/format.h>

#include <array>

#include "hydrapod/base/version.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

std::string place_columns(const UffPlace& place) {
  return fmt::format(" {}{:10}{:4}", fortran_a(place.entity, 10), place.node, place.direction);
}

std::string axis_line(const UffAxis& axis) {
  std::string line = fmt::format("{:10}{:5}{:5}{:5} {} {}", axis.quantity, axis.length_exponent,
                                 axis.force_exponent, axis.temperature_exponent,
                                 fortran_a(axis.label, 20), fortran_a(axis.unit, 20));
  return line + '\n';
}

std::string dataset_number_line(const UffFunction& f) {
  if (!f.binary) return "    58\n";
  const std::uint64_t value = (f.is_double ? 8U : 4U) * tuple_size(f);
  constexpr int little_endian = 1, ieee = 2, header_lines = 11;
  return fmt::format("    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}\n", little_endian, ieee,
                     header_lines, f.declared * value, 0, 0, 0, 0);
}

int ordinate_type(const UffFunction& f) {
  return f.is_complex ? (f.is_double ? 6 : 5) : (f.is_double ? 4 : 2);
}

struct UnitQuantity {
  const char* unit;
  int quantity, length, force;
};
constexpr std::array unit_quantities{UnitQuantity{"m", uff_quantity::displacement, 1, 0},
                                     UnitQuantity{"rad", uff_quantity::displacement, 0, 0},
                                     UnitQuantity{"m/s", uff_quantity::velocity, 1, 0},
                                     UnitQuantity{"rad/s", uff_quantity::velocity, 0, 0},
                                     UnitQuantity{"m/s^2", uff_quantity::acceleration, 1, 0},
                                     UnitQuantity{"rad/s^2", uff_quantity::acceleration, 0, 0},
                                     UnitQuantity{"N", uff_quantity::excitation_force, 0, 1},
                                     UnitQuantity{"N m", uff_quantity::excitation_force, 1, 1},
                                     UnitQuantity{"Pa", uff_quantity::pressure, -2, 1},
                                     UnitQuantity{"kg", uff_quantity::mass, -1, 1},
                                     UnitQuantity{"s", uff_quantity::time, 0, 0},
                                     UnitQuantity{"Hz", uff_quantity::frequency, 0, 0}};

}  // namespace

std::string uff_function_head(const UffFunction& f) {
  std::string out = uff_delimiter + dataset_number_line(f);
  for (const std::string& id : f.id) out += fortran_a(id.empty() ? "NONE" : id, 80) + '\n';
  out += fmt::format("{:5}{:10}{:5}{:10}{}{}\n", f.type, f.number, f.version, f.load_case,
                     place_columns(f.response), place_columns(f.reference));
  out += fmt::format("{:10}{:10}{:10}{}{}{}\n", ordinate_type(f), f.declared, f.is_even ? 1 : 0,
                     fortran_e(f.first, 13, 5), fortran_e(f.step, 13, 5), fortran_e(f.z, 13, 5));
  return out + axis_line(f.abscissa) + axis_line(f.ordinate) + axis_line(f.denominator) +
         axis_line(f.z_axis);
}

std::string uff_file_header(const std::string& model, const std::string& description,
                            const std::string& date) {
  const std::string program = fmt::format("hydrapod {}", base::version);
  const std::string when = uff_date(date);
  const bool dated = when.size() == 18;
  const std::string day = dated ? when.substr(0, 9) : "NONE";
  const std::string time = dated ? when.substr(10) : "NONE";
  const std::string stamp = fortran_a(day, 10) + fortran_a(time, 10);
  std::string out = std::string(uff_delimiter) + "   151\n";
  for (const std::string& line : {model, description, program})
    out += fortran_a(line.empty() ? "NONE" : line, 80) + '\n';
  out += fmt::format("{}{:10}{:10}{:10}\n", stamp, 0, 0, 0);
  out += stamp + '\n';
  out += fortran_a(program, 80) + '\n';
  out += fmt::format("{}{:5}{:5}{:5}{:5}{:5}\n", stamp, 0, 0, 0, 0, 0);
  return out + uff_delimiter;
}

std::string uff_si_units() {
  const UffUnits si;
  return fmt::format("{}   164\n{:10}{}{:10}\n{}{}{}\n{}\n{}", uff_delimiter, si.code,
                     fortran_a(si.description, 20), 2, fortran_d(si.length), fortran_d(si.force),
                     fortran_d(si.temperature), fortran_d(si.temperature_offset), uff_delimiter);
}

UffAxis uff_axis_of(const std::string& label, const std::string& unit) {
  UffAxis axis{.quantity = uff_quantity::general, .label = label, .unit = unit};
  if (unit.empty()) axis.unit = "NONE";
  for (const UnitQuantity& known : unit_quantities) {
    if (unit != known.unit) continue;
    axis.quantity = known.quantity;
    axis.length_exponent = known.length;
    axis.force_exponent = known.force;
  }
  return axis;
}

UffLines::UffLines(const UffFunction& f) : widths_(uff_widths(f)) {}

void UffLines::add(double number, std::string& out) {
  const int width = widths_[column_];
  out += fortran_e(number, width, width == 13 ? 5 : 12);
  if (++column_ < widths_.size()) return;
  out += '\n';
  column_ = 0;
}

void UffLines::finish(std::string& out) {
  if (column_ > 0) out += '\n';
  column_ = 0;
}

}  // namespace hydrapod::data
