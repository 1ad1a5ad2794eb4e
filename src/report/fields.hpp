#pragma once
/// One description of a JSON object for its writer and its reader. Private to the module.
///
///     template <class Fields>
///     void describe(Fields& f, LegCheck& leg) {
///       f("length_m", leg.length);
///       f.optional("retract_left_m", leg.retract_left);
///     }
///
/// written(leg) is the JSON; read(json, file, leg) fills `leg` from it, read<LegCheck>(json, file)
/// makes one. All call describe(), which stands in namespace report. A number that is not finite is
/// null; null is read as not a number. Reading throws base::InputError with file and key.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

class Writer;
class Reader;

template <class T>
Json written(const T& value);

template <class T>
concept Described = requires(Writer& f, T& value) {
  describe(f, value);
};

inline constexpr std::array model_words{"rigid", "guide", "full"};

/// The words of an enum with `N` values.
template <class Enum, std::size_t N>
std::array<const char*, N> words_of(const char* (*name)(Enum)) {
  std::array<const char*, N> words{};
  for (std::size_t k = 0; k < N; ++k) words[k] = name(static_cast<Enum>(k));
  return words;
}

/// `axial`: what the share `oil` of the elastic energy is of, where it is no oil.
template <class Fields>
void describe_axial_part(Fields& f, model::LegType& of) {
  std::string axial{model::axial_part(of)};
  f.unless(std::string("oil"), "axial", axial);
  for (const auto type : {model::LegType::cylinder, model::LegType::strut, model::LegType::screw})
    if (axial == model::axial_part(type)) of = type;
}

class Writer {
 public:
  static constexpr bool reads = false;
  Json json = Json::object();

  [[nodiscard]] static bool has(const char*) { return false; }
  [[nodiscard]] static std::size_t size(const char*) { return 0; }

  template <class T>
  void operator()(const char* key, const T& value) {
    json[key] = written(value);
  }
  /// Absent where there is none.
  template <class T>
  void optional(const char* key, const std::optional<T>& value) {
    if (value) json[key] = written(*value);
  }
  /// Need not be there for a reader.
  template <class T>
  void maybe(const char* key, const T& value) {
    json[key] = written(value);
  }
  /// Absent where it is `usual`.
  template <class T>
  void unless(const T& usual, const char* key, const T& value) {
    if (value != usual) json[key] = written(value);
  }
  /// Follows from other fields; not read.
  template <class T>
  void derived(const char* key, const T& value) {
    json[key] = written(value);
  }
  /// A number counted from 1 in JSON, from 0 here.
  template <class Integer>
  void counted(const char* key, Integer value) {
    json[key] = value + 1;
  }
  /// Null stands for infinite.
  void unbounded(const char* key, double value) { json[key] = written(value); }
  /// In another unit: JSON holds `value` / `unit`.
  void scaled(const char* key, double value, double unit) { json[key] = written(value / unit); }
  void percent(const char* key, double value) { json[key] = written(100.0 * value); }
  /// Two numbers as one list.
  void pair(const char* key, double first, double second) {
    json[key] = written(std::array{first, second});
  }
  /// An enum by its words; value 0 is the first.
  template <class Enum>
  void word(const char* key, Enum value, std::span<const char* const> words) {
    const auto number = static_cast<std::size_t>(value);
    if (number >= words.size())
      throw std::logic_error(fmt::format("{}: value {} has no word", key, number));
    json[key] = words[number];
  }
  /// Fields of the same value in an object of their own.
  template <class Describe>
  void object(const char* key, const Describe& describe_fields) {
    Writer inner;
    describe_fields(inner);
    json[key] = std::move(inner.json);
  }
  /// A list of `count` objects: describe_fields(fields, index).
  template <class Describe>
  void list(const char* key, std::size_t count, const Describe& describe_fields) {
    Json& all = json[key] = Json::array();
    for (std::size_t k = 0; k < count; ++k) {
      Writer inner;
      describe_fields(inner, k);
      all.push_back(std::move(inner.json));
    }
  }
};

class Reader {
 public:
  static constexpr bool reads = true;

  Reader(const Json& json, const std::string& file, std::string path = {})
      : json_(json), file_(file), path_(std::move(path)) {
    if (!json.is_object()) bad({}, "expected an object");
  }

  [[noreturn]] void bad(const std::string& key, const std::string& message) const {
    throw base::InputError({{.file = file_, .key = key_of(key), .message = message}});
  }
  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }
  [[nodiscard]] std::size_t size(const char* key) const { return at(key).size(); }  ///< of a list
  [[nodiscard]] const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) bad(key, "is missing");
    return *found;
  }

  template <class T>
  void operator()(const char* key, T& value) const {
    get(at(key), key_of(key), value);
  }
  template <class T>
  void optional(const char* key, std::optional<T>& value) const {
    if (has(key)) get(json_[key], key_of(key), value);
  }
  template <class T>
  void maybe(const char* key, T& value) const {
    if (has(key)) (*this)(key, value);
  }
  template <class T>
  void unless(const T& usual, const char* key, T& value) const {
    value = usual;
    if (has(key)) (*this)(key, value);
  }
  template <class T>
  void derived(const char*, const T&) const {}
  template <class Integer>
  void counted(const char* key, Integer& value) const {
    (*this)(key, value);
    if (value < 1) bad(key, "expected a number from 1");
    --value;
  }
  void unbounded(const char* key, double& value) const {
    (*this)(key, value);
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  }
  void scaled(const char* key, double& value, double unit) const {
    (*this)(key, value);
    value *= unit;
  }
  void percent(const char* key, double& value) const {
    (*this)(key, value);
    value /= 100.0;
  }
  void pair(const char* key, double& first, double& second) const {
    std::array<double, 2> both{};
    (*this)(key, both);
    first = both[0];
    second = both[1];
  }
  template <class Enum>
  void word(const char* key, Enum& value, std::span<const char* const> words) const {
    std::string text;
    (*this)(key, text);
    for (std::size_t k = 0; k < words.size(); ++k)
      if (text == words[k]) {
        value = static_cast<Enum>(k);
        return;
      }
    bad(key, fmt::format("is \"{}\", expected one of {}", text, fmt::join(words, ", ")));
  }
  template <class Describe>
  void object(const char* key, const Describe& describe_fields) const {
    const Reader inner(at(key), file_, key_of(key));
    describe_fields(inner);
  }
  template <class Describe>
  void list(const char* key, std::size_t count, const Describe& describe_fields) const {
    if (!at(key).is_array() || at(key).size() != count)
      bad(key, fmt::format("expected a list of {}", count));
    for (std::size_t k = 0; k < count; ++k) {
      const Reader inner(at(key)[k], file_, fmt::format("{}[{}]", key_of(key), k));
      describe_fields(inner, k);
    }
  }

 private:
  [[nodiscard]] std::string key_of(const std::string& key) const {
    return path_.empty() || key.empty() ? path_ + key : fmt::format("{}.{}", path_, key);
  }
  [[noreturn]] void refuse(const std::string& path, const std::string& message) const {
    throw base::InputError({{.file = file_, .key = path, .message = message}});
  }
  const Json& list(const Json& json, const std::string& path) const {
    if (!json.is_array()) refuse(path, "expected a list");
    return json;
  }

  void get(const Json& json, const std::string& path, double& value) const {
    if (!json.is_number() && !json.is_null()) refuse(path, "expected a number");
    value = json.is_null() ? std::nan("") : json.get<double>();
  }
  template <class Integer>
  requires std::is_integral_v<Integer>
  void get(const Json& json, const std::string& path, Integer& value) const {
    if constexpr (std::is_same_v<Integer, bool>) {
      if (!json.is_boolean()) refuse(path, "expected true or false");
    } else {
      if (!json.is_number_integer()) refuse(path, "expected a whole number");
      const bool fits = json.is_number_unsigned()
                            ? std::in_range<Integer>(json.get<std::uint64_t>())
                            : std::in_range<Integer>(json.get<std::int64_t>());
      if (!fits) refuse(path, fmt::format("is {}, which does not fit", json.dump()));
    }
    value = json.get<Integer>();
  }
  void get(const Json& json, const std::string& path, std::string& value) const {
    if (!json.is_string()) refuse(path, "expected a text");
    value = json.get<std::string>();
  }
  void get(const Json& json, const std::string& path, std::complex<double>& value) const {
    double re = 0.0, im = 0.0;
    const Reader parts(json, file_, path);
    parts("re", re);
    parts("im", im);
    value = {re, im};
  }
  template <class T>
  void get(const Json& json, const std::string& path, std::optional<T>& value) const {
    if (json.is_null()) return value.reset();
    get(json, path, value.emplace());
  }
  template <class T>
  void get(const Json& json, const std::string& path, std::vector<T>& values) const {
    values.resize(list(json, path).size());
    for (std::size_t k = 0; k < values.size(); ++k)
      get(json[k], fmt::format("{}[{}]", path, k), values[k]);
  }
  template <class T, std::size_t N>
  void get(const Json& json, const std::string& path, std::array<T, N>& values) const {
    if (list(json, path).size() != N) refuse(path, fmt::format("expected {} entries", N));
    for (std::size_t k = 0; k < N; ++k) get(json[k], fmt::format("{}[{}]", path, k), values[k]);
  }
  template <class S, int Rows, int Columns, int Options, int MaxRows, int MaxColumns>
  void get(const Json& json, const std::string& path,
           Eigen::Matrix<S, Rows, Columns, Options, MaxRows, MaxColumns>& values) const {
    if constexpr (Columns == 1 && !std::is_same_v<S, double>) {
      if (json.is_array()) {  // real numbers alone
        Eigen::VectorXd real;
        get(json, path, real);
        make_room(path, real.size(), 1, values);
        values = real.cast<S>();
        return;
      }
    }
    if constexpr (Columns == 1 && std::is_same_v<S, double>) {
      const auto size = static_cast<Eigen::Index>(list(json, path).size());
      make_room(path, size, 1, values);
      for (Eigen::Index k = 0; k < size; ++k)
        get(json[static_cast<std::size_t>(k)], fmt::format("{}[{}]", path, k), values[k]);
    } else if constexpr (Columns == 1) {  // complex
      const Reader parts(json, file_, path);
      Eigen::VectorXd re, im;
      parts("re", re);
      parts("im", im);
      if (re.size() != im.size()) refuse(path, "needs as many numbers in re as in im");
      make_room(path, re.size(), 1, values);
      for (Eigen::Index k = 0; k < re.size(); ++k) values[k] = {re[k], im[k]};
    } else {
      const auto rows = static_cast<Eigen::Index>(list(json, path).size());
      for (Eigen::Index i = 0; i < rows; ++i) {
        Eigen::Matrix<S, Eigen::Dynamic, 1> row;
        get(json[static_cast<std::size_t>(i)], fmt::format("{}[{}]", path, i), row);
        if (i == 0) make_room(path, rows, row.size(), values);
        if (row.size() != values.cols()) refuse(path, "has rows of different lengths");
        values.row(i) = row.transpose();
      }
    }
  }
  /// Resizes `values`, whose type may set its size or a limit to it.
  template <class Matrix>
  void make_room(const std::string& path, Eigen::Index rows, Eigen::Index columns,
                 Matrix& values) const {
    const auto fits = [](Eigen::Index size, int fixed, int most) {
      return fixed != Eigen::Dynamic ? size == fixed : most == Eigen::Dynamic || size <= most;
    };
    if (!fits(rows, Matrix::RowsAtCompileTime, Matrix::MaxRowsAtCompileTime))
      refuse(path, fmt::format("expected {}{} numbers",
                               Matrix::RowsAtCompileTime == Eigen::Dynamic ? "at most " : "",
                               int{Matrix::MaxRowsAtCompileTime}));
    if (!fits(columns, Matrix::ColsAtCompileTime, Matrix::MaxColsAtCompileTime))
      refuse(path, fmt::format("expected rows of {}{} numbers",
                               Matrix::ColsAtCompileTime == Eigen::Dynamic ? "at most " : "",
                               int{Matrix::MaxColsAtCompileTime}));
    values.resize(rows, columns);
  }
  template <Described T>
  void get(const Json& json, const std::string& path, T& value) const {
    Reader fields(json, file_, path);
    describe(fields, value);
  }

  const Json& json_;
  const std::string& file_;
  std::string path_;
};

template <class T>
Json written(const T& value) {
  if constexpr (std::is_same_v<T, Json>) {
    return value;
  } else if constexpr (std::is_same_v<T, double>) {
    return std::isfinite(value) ? Json(value) : Json();
  } else if constexpr (std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string>) {
    return Json(value);
  } else if constexpr (requires { value.has_value(); }) {
    return value ? written(*value) : Json();
  } else if constexpr (requires { value.real(), value.imag(), value.size(); }) {  // Eigen
    using Matrix = std::remove_cvref_t<decltype(value.eval())>;
    if constexpr (Matrix::ColsAtCompileTime != 1) {
      Json rows = Json::array();
      for (Eigen::Index i = 0; i < value.rows(); ++i)
        rows.push_back(written(value.row(i).transpose().eval()));
      return rows;
    } else if constexpr (std::is_same_v<typename Matrix::Scalar, double>) {
      Json list = Json::array();
      for (Eigen::Index i = 0; i < value.size(); ++i) list.push_back(written(double(value[i])));
      return list;
    } else {
      return {{"re", written(value.real().eval())}, {"im", written(value.imag().eval())}};
    }
  } else if constexpr (requires { value.real(), value.imag(); }) {
    return {{"re", value.real()}, {"im", value.imag()}};
  } else if constexpr (requires { value.begin(), value.size(); }) {
    Json list = Json::array();
    for (const auto& item : value) list.push_back(written(item));
    return list;
  } else {
    Writer fields;
    describe(fields, const_cast<T&>(value));  // a Writer changes nothing
    return std::move(fields.json);
  }
}

template <class Fields>
void describe(Fields& f, model::NamedPose& pose) {
  spatial::Vector3 rpy = spatial::rpy_from_rotation(pose.X_BP.R_BP);
  f("name", pose.name);
  f("position_m", pose.X_BP.p_BP);
  f("rotation_rad", rpy);
  if constexpr (Fields::reads) pose.X_BP.R_BP = spatial::rotation_from_rpy(rpy);
}

/// `file` is what messages call it.
template <class T>
void read(const Json& json, const std::string& file, T& value) {
  Reader fields(json, file);
  describe(fields, value);
}
template <class T>
T read(const Json& json, const std::string& file) {
  T value;
  read(json, file, value);
  return value;
}

}  // namespace hydrapod::report
