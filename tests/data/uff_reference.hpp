#pragma once
/// A reader of Universal Files of its own, written from the format's public description only and
/// used to read back what hydrapod writes. It takes columns literally and believes nothing else: a
/// field one column off is a failure.

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace hydrapod::test::uff {

/// FORTRAN A: columns from … to, counted from 1 as the description does.
inline std::string field(const std::string& line, std::size_t from, std::size_t to) {
  if (line.size() < to) throw std::runtime_error("line too short: '" + line + "'");
  return line.substr(from - 1, to - from + 1);
}
inline std::string text(const std::string& line, std::size_t from, std::size_t to) {
  std::string all = field(line, from, to);
  return all.erase(all.find_last_not_of(' ') + 1);
}
/// FORTRAN I: right-justified.
inline long integer(const std::string& line, std::size_t from, std::size_t to) {
  const std::string all = field(line, from, to);
  if (all.back() == ' ') throw std::runtime_error("not right-justified: '" + all + "'");
  char* end = nullptr;
  const long value = std::strtol(all.c_str(), &end, 10);
  if (*end != '\0') throw std::runtime_error("no integer: '" + all + "'");
  return value;
}
/// FORTRAN E and D.
inline double real(const std::string& line, std::size_t from, std::size_t to) {
  std::string all = field(line, from, to);
  for (char& c : all)
    if (c == 'D') c = 'E';
  char* end = nullptr;
  const double value = std::strtod(all.c_str(), &end);
  if (*end != '\0' || all.back() == ' ') throw std::runtime_error("no number: '" + all + "'");
  return value;
}

struct Function {
  std::string id[5];
  long type{}, number{}, version{}, load_case{};
  std::string response_entity{}, reference_entity{};
  long response_node{}, response_direction{}, reference_node{}, reference_direction{};
  long data_type{}, count{}, spacing{};
  double first{}, increment{}, z{};
  long quantity[4]{}, length[4]{}, force[4]{}, temperature[4]{};
  std::string label[4], unit[4];
  std::vector<double> values{};
};

struct Node {
  long number{}, systems[2]{}, color{};
  double x[3]{};
};
struct TraceLine {
  std::string name{};
  long number{}, color{};
  std::vector<long> nodes{};
};

struct File {
  std::vector<long> datasets{};
  std::vector<Node> nodes{};
  std::vector<TraceLine> lines{};
  std::vector<Function> functions{};
  std::string model_name{}, program{};
  long units_code{};
  double unit_factors[4]{};
};

class Reader {
 public:
  explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}

  File read() {
    while (at_ < bytes_.size()) {
      delimiter();
      const std::string head = line();
      const long number = integer(head, 1, 6);
      file_.datasets.push_back(number);
      if (number == 58)
        function(head);
      else if (number == 151)
        header();
      else if (number == 164)
        units();
      else if (number == 15 || number == 2411)
        while (peek() != "    -1") node(number == 2411);
      else if (number == 82)
        trace_line();
      else
        while (peek() != "    -1") line();
      delimiter();
    }
    return file_;
  }

 private:
  [[nodiscard]] std::string peek() const {
    return bytes_.substr(at_, bytes_.find('\n', at_) - at_);
  }
  std::string line() {
    if (at_ >= bytes_.size()) throw std::runtime_error("the file ends early");
    const std::string all = peek();
    if (all.size() > 82 && all[0] != '#')
      throw std::runtime_error("longer than 82 columns: " + all);
    at_ += all.size() + 1;
    return all;
  }
  void delimiter() {
    const std::string all = line();
    if (all != "    -1") throw std::runtime_error("no delimiter: '" + all + "'");
  }

  /// Format(2(I5,I10),2(1X,10A1,I10,I4)), Format(3I10,3E13.5), Format(I10,3I5,2(1X,20A1)).
  void function(const std::string& head) {
    Function f;
    for (std::string& id : f.id) id = text(line(), 1, 80);
    const std::string place = line(), form = line();
    f.type = integer(place, 1, 5);
    f.number = integer(place, 6, 15);
    f.version = integer(place, 16, 20);
    f.load_case = integer(place, 21, 30);
    f.response_entity = text(place, 32, 41);
    f.response_node = integer(place, 42, 51);
    f.response_direction = integer(place, 52, 55);
    f.reference_entity = text(place, 57, 66);
    f.reference_node = integer(place, 67, 76);
    f.reference_direction = integer(place, 77, 80);
    f.data_type = integer(form, 1, 10);
    f.count = integer(form, 11, 20);
    f.spacing = integer(form, 21, 30);
    f.first = real(form, 31, 43);
    f.increment = real(form, 44, 56);
    f.z = real(form, 57, 69);
    for (int axis = 0; axis < 4; ++axis) {
      const std::string what = line();
      f.quantity[axis] = integer(what, 1, 10);
      f.length[axis] = integer(what, 11, 15);
      f.force[axis] = integer(what, 16, 20);
      f.temperature[axis] = integer(what, 21, 25);
      f.label[axis] = text(what, 27, 46);
      f.unit[axis] = text(what, 48, 67);
    }
    const bool complex = f.data_type == 6;
    const auto numbers =
        static_cast<std::size_t>(f.count * (complex ? 2 : 1) + (f.spacing == 1 ? 0 : f.count));
    if (head.size() > 6 && head[6] == 'b')
      binary(head, f, numbers);
    else
      ascii(f, numbers);
    file_.functions.push_back(f);
  }

  /// Column 7 b; I6 byte order, I6 floating point, I12 ASCII lines, I12 bytes, then zeros.
  void binary(const std::string& head, Function& f, std::size_t numbers) {
    if (integer(head, 8, 13) != 1 || integer(head, 14, 19) != 2 || integer(head, 20, 31) != 11)
      throw std::runtime_error("not little-endian IEEE behind 11 lines");
    if (integer(head, 32, 43) != static_cast<long>(8 * numbers))
      throw std::runtime_error("a wrong number of bytes");
    for (const auto& [from, to] : {std::pair{44, 49}, {50, 55}, {56, 67}, {68, 79}})
      if (integer(head, static_cast<std::size_t>(from), static_cast<std::size_t>(to)) != 0)
        throw std::runtime_error("unused fields must be zero");
    f.values.resize(numbers);
    std::memcpy(f.values.data(), bytes_.data() + at_, 8 * numbers);
    at_ += 8 * numbers;
  }

  /// 4E20.12 for even double values, 2(E13.5,E20.12) for uneven ones, E13.5,2E20.12 for complex
  /// ones.
  void ascii(Function& f, std::size_t numbers) {
    std::vector<std::size_t> widths{20, 20, 20, 20};
    if (f.spacing == 0) widths = {13, 20, 13, 20};
    if (f.spacing == 0 && f.data_type == 6) widths = {13, 20, 20};
    while (f.values.size() < numbers) {
      const std::string all = line();
      std::size_t column = 1;
      for (const std::size_t width : widths) {
        if (f.values.size() == numbers) break;
        f.values.push_back(real(all, column, column + width - 1));
        column += width;
      }
      if (all.size() != column - 1) throw std::runtime_error("columns beyond the format: " + all);
    }
  }

  void header() {
    file_.model_name = text(line(), 1, 80);
    text(line(), 1, 80);
    file_.program = text(line(), 1, 80);
    const std::string created = line();
    for (std::size_t from : {21U, 31U, 41U}) integer(created, from, from + 9);
    text(line(), 1, 20);
    text(line(), 1, 80);
    const std::string written = line();
    for (std::size_t from : {21U, 26U, 31U, 36U, 41U}) integer(written, from, from + 4);
  }

  void units() {
    const std::string code = line(), factors = line(), offset = line();
    file_.units_code = integer(code, 1, 10);
    integer(code, 31, 40);
    for (int i = 0; i < 3; ++i)
      file_.unit_factors[i] = real(factors, static_cast<std::size_t>(25 * i + 1),
                                   static_cast<std::size_t>(25 * i + 25));
    file_.unit_factors[3] = real(offset, 1, 25);
  }

  /// Dataset 15: Format(4I10,3E13.5). Dataset 2411: Format(4I10), Format(3D25.17).
  void node(bool in_double) {
    std::string all = line();
    Node& n = file_.nodes.emplace_back();
    n.number = integer(all, 1, 10);
    n.systems[0] = integer(all, 11, 20);
    n.systems[1] = integer(all, 21, 30);
    n.color = integer(all, 31, 40);
    if (in_double && all.size() != 40) throw std::runtime_error("columns beyond: " + all);
    if (in_double) all = line();
    const std::size_t before = in_double ? 0 : 40, width = in_double ? 25 : 13;
    for (std::size_t k = 0; k < 3; ++k)
      n.x[k] = real(all, before + width * k + 1, before + width * (k + 1));
    if (all.size() != before + 3 * width) throw std::runtime_error("columns beyond: " + all);
  }

  /// Dataset 82: Format(3I10), Format(80A1), Format(8I10).
  void trace_line() {
    const std::string head = line();
    TraceLine& l = file_.lines.emplace_back();
    l.number = integer(head, 1, 10);
    const auto count = static_cast<std::size_t>(integer(head, 11, 20));
    l.color = integer(head, 21, 30);
    l.name = text(line(), 1, 80);
    while (l.nodes.size() < count) {
      const std::string all = line();
      for (std::size_t k = 0; k < 8 && l.nodes.size() < count; ++k)
        l.nodes.push_back(integer(all, 10 * k + 1, 10 * k + 10));
    }
  }

  std::string bytes_;
  std::size_t at_{};
  File file_;
};

}  // namespace hydrapod::test::uff
