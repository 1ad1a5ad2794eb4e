#pragma once
/// What all files of the extension share: results, views of their arrays, long work without the
/// GIL, quantities.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::python {

namespace py = pybind11;
using report::Json;
using report::Subject;

/// What a task gives: arrays, and the document that the command line prints as JSON but for its
/// `reproduction`.
struct Result {
  Result() = default;
  Result(const Result&) = default;
  Result& operator=(const Result&) = default;
  virtual ~Result() = default;
  [[nodiscard]] virtual Json document() const = 0;
};

/// `head` with what `result` has.
Json joined(Json head, const Json& result);
/// As the command line heads a result that depends on the model.
Json head_of_model(const char* kind, const Subject& machine);

/// Arrays of results are made anew at each call: a number written into one would be lost.
inline py::array read_only(py::array array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// A read-only array over memory that `owner` keeps.
template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const py::handle& owner) {
  return read_only(
      py::array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner));
}

/// A dense Eigen matrix or vector, stored by columns or rows.
template <class Matrix>
py::array view_of(const Matrix& matrix, const py::handle& owner) {
  using Scalar = typename Matrix::Scalar;
  constexpr auto size = static_cast<py::ssize_t>(sizeof(Scalar));
  if constexpr (Matrix::ColsAtCompileTime == 1)
    return view<Scalar>(matrix.data(), {matrix.rows()}, {size}, owner);
  else
    return view<Scalar>(matrix.data(), {matrix.rows(), matrix.cols()},
                        {size * matrix.rowStride(), size * matrix.colStride()}, owner);
}

template <class T>
py::array view_of(const std::vector<T>& values, const py::handle& owner) {
  return view<T>(values.data(), {static_cast<py::ssize_t>(values.size())},
                 {static_cast<py::ssize_t>(sizeof(T))}, owner);
}

/// count × rows × columns of matrices of fixed size.
template <class Matrix>
py::array pages_of(const std::vector<Matrix>& pages, const py::handle& owner) {
  using Scalar = typename Matrix::Scalar;
  constexpr auto size = static_cast<py::ssize_t>(sizeof(Scalar));
  constexpr auto page = static_cast<py::ssize_t>(sizeof(Matrix));
  const auto count = static_cast<py::ssize_t>(pages.size());
  const auto* first = reinterpret_cast<const Scalar*>(pages.data());
  if constexpr (Matrix::ColsAtCompileTime == 1)
    return view<Scalar>(first, {count, Matrix::RowsAtCompileTime}, {page, size}, owner);
  else
    return view<Scalar>(first, {count, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime},
                        {page, size, size * Matrix::RowsAtCompileTime}, owner);
}

/// A new, read-only array of `values`, of any shape.
template <class T>
py::array array_of(const std::vector<T>& values, std::vector<py::ssize_t> shape = {}) {
  if (shape.empty()) shape = {static_cast<py::ssize_t>(values.size())};
  return read_only(py::array_t<T>(std::move(shape), values.data()));
}

/// get(element) of each element of `list`.
template <class List, class Get>
py::array array_of_each(const List& list, Get get) {
  std::vector<std::decay_t<decltype(get(list.front()))>> values;
  for (const auto& element : list) values.push_back(get(element));
  return array_of(values);
}

/// Counts calls that are at work: the end of the interpreter asks them to stop and waits for them,
/// because a thread that comes back to an interpreter that is gone would be torn out of C++ code.
class Call {
 public:
  Call();  ///< throws std::runtime_error when the interpreter is ending
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
};
bool is_ending();
/// In the child of a fork, where the threads of the calls are not there.
void forget_calls();
void end_all();  ///< at exit, with the GIL

/// Asks Python now and then, from any thread, whether to go on: signals, the user's callback.
class Watcher {
 public:
  explicit Watcher(py::object callback) : callback_(std::move(callback)) {}
  [[nodiscard]] numerics::Progress progress();
  /// Throws what a signal handler or the callback raised.
  void rethrow();

 private:
  bool ask(double share);
  py::object callback_;
  std::mutex mutex_{};
  double asked_{-1.0};  ///< [s] when last, by a steady clock
  bool stop_{};
  std::unique_ptr<py::error_already_set> error_{};
};

/// work(progress) without the GIL.
template <class Work>
auto at_work(const py::object& callback, const Work& work) {
  const Call call;
  Watcher watcher(callback);
  try {
    auto result = [&] {
      const py::gil_scoped_release release;
      return work(watcher.progress());
    }();
    watcher.rethrow();
    return result;
  } catch (const py::error_already_set&) {
    throw;
  } catch (...) {
    watcher.rethrow();
    throw;
  }
}

/// Short work without the GIL.
template <class Work>
auto without_gil(const Work& work) {
  const Call call;
  const py::gil_scoped_release release;
  return work();
}

/// A text in UTF-8 without a character 0; `name`: what messages call it. Throws py::type_error or
/// std::invalid_argument.
std::string text_of(const py::handle& value, const std::string& name);
/// A path as os.fspath() has it, a text. Throws as text_of() does.
std::string path_of(const py::handle& given, const std::string& name);
[[noreturn]] void refuse_type(const py::handle& value, const std::string& name,
                              const std::string& expected);

/// What messages say of a type.
template <class T>
std::string words_of_type() {
  if constexpr (std::is_same_v<T, bool>) return "True or False";
  if constexpr (std::is_integral_v<T>) return "a whole number";
  if constexpr (std::is_floating_point_v<T>) return "a number";
  if constexpr (std::is_same_v<T, std::vector<int>>) return "a list of whole numbers";
  if constexpr (std::is_base_of_v<py::dict, T>) return "a dict";
  return "another kind of value";
}

/// `value` as a T; `name`: what messages call it. Throws as text_of() does.
template <class T>
T read_as(const py::handle& value, const std::string& name) {
  if constexpr (std::is_same_v<T, std::string>) {
    return text_of(value, name);
  } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
    if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value))
      refuse_type(value, name, "a list of texts");
    T texts;
    for (const auto& one : value) texts.push_back(text_of(one, name));
    return texts;
  } else {
    try {
      return value.cast<T>();
    } catch (const py::cast_error&) {
      refuse_type(value, name, words_of_type<T>());
    }
  }
}

/// A message of the library, which calls options as the command line does, with the names of the
/// arguments here; commands between backquotes stay.
std::string in_words_of_python(const std::string& message);

/// A number in SI, or a text with a unit; `name`: what messages call it. Throws base::InputError.
double quantity(const py::handle& value, const char* unit, const std::string& name);
/// A number in Hz or a text in Hz or rad/s [rad/s].
double angular(const py::handle& value, const std::string& name);

/// One of `words`, by its number. Throws base::InputError with the nearest of them.
std::size_t choice(const std::string& name, const std::string& word,
                   const std::vector<std::string_view>& words);

/// Options as the Python side passes them on: what is None or missing has its default.
class Options {
 public:
  explicit Options(py::dict values) : values_(std::move(values)) {}
  [[nodiscard]] bool has(const char* name) const;
  [[nodiscard]] py::object operator[](const char* name) const { return values_[name]; }
  template <class T>
  [[nodiscard]] T get(const char* name, T otherwise = {}) const {
    return has(name) ? read_as<T>((*this)[name], argument_of(name)) : otherwise;
  }
  /// What the option is called in Python.
  [[nodiscard]] static std::string argument_of(const std::string& name) {
    return name == "from" ? "from_" : name;
  }
  [[nodiscard]] std::optional<double> amount(const char* name, const char* unit) const;
  [[nodiscard]] std::optional<double> at_least_zero(const char* name, const char* unit) const;
  [[nodiscard]] std::optional<double> positive(const char* name, const char* unit) const;

 private:
  py::dict values_;
};

/// All digits of a number.
std::string digits_of(double value);

/// `machine` with other numbers [SI], at one of its poses or a displacement.
std::shared_ptr<Subject> changed_machine(const Subject& machine,
                                         const std::vector<std::string>& paths,
                                         std::span<const double> values, const std::string& pose);

std::vector<std::string> texts(const std::vector<base::Diagnostic>& diagnostics);

void add_machine(py::module_& module);
void add_linear(py::module_& module);
void add_measurement(py::module_& module);
void add_fit(py::module_& module);
void add_simulation(py::module_& module);
void add_plant(py::module_& module);
void add_study(py::module_& module);
void add_design(py::module_& module);
void add_compare(py::module_& module);
void add_exchange(py::module_& module);
void add_kinematics(py::module_& module);
void add_record(py::module_& module);
void add_records(py::module_& module);
void add_realtime(py::module_& module);

}  // namespace hydrapod::python
