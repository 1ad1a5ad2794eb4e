#include "support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <thread>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::python {

namespace {

std::atomic<int> calls{0};
std::atomic<bool> ending{false};

/// Numbers of NumPy may be complex, truths or durations, and PyFloat_AsDouble() would take their
/// real part or their count.
bool is_real(const py::handle& value) {
  if (PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr()) || !py::hasattr(value, "dtype"))
    return true;
  const auto kind = py::str(py::getattr(value.attr("dtype"), "kind", py::str("O")));
  return std::string_view("fiuO").find(kind.cast<std::string>()) != std::string_view::npos;
}

/// What the option `--word` of the command line is called here.
std::string argument_of(const std::string& word) {
  static const std::map<std::string, std::string, std::less<>> others{
      {"accelerometer", "accelerometers"},
      {"amplitude", "amplitudes"},
      {"command", "commands"},
      {"from", "from_"},
      {"from-drive", "input_from=\"drive\""},
      {"from-excitation", "input_from=\"excitation\""},
      {"limit", "limits"},
      {"open-loop", "closed=False"},
      {"pade", "pade_order"},
      {"parameter", "parameters"},
      {"prior", "priors"},
      {"profile", "profiles"},
      {"sensor", "sensors"},
      {"set", "with_"},
      {"shm", "shared_memory"},
      {"udp", "address"},
      {"variable", "variables"}};
  if (const auto at = others.find(word); at != others.end()) return at->second;
  std::string name = word;
  std::ranges::replace(name, '-', '_');
  return name;
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Json joined(Json head, const Json& result) {
  head.update(result);
  return head;
}

Json head_of_model(const char* kind, const Subject& machine) {
  auto json = report::head_json(kind, machine);
  json["model"] = dynamics::name(machine.kind);
  return json;
}

std::string in_words_of_python(const std::string& message) {
  std::string out;
  bool quoted = false;
  for (std::size_t at = 0; at < message.size();) {
    quoted = quoted != (message[at] == '`');
    const bool begins =
        at == 0 || std::string_view(" (\",\n").find(message[at - 1]) != std::string_view::npos;
    std::size_t end = at + 2;
    while (end < message.size() && (std::islower(static_cast<unsigned char>(message[end])) != 0 ||
                                    (message[end] == '-' && end > at + 2)))
      ++end;
    if (quoted || !begins || !message.substr(at).starts_with("--") || end == at + 2) {
      out += message[at++];
      continue;
    }
    out += argument_of(message.substr(at + 2, end - at - 2));
    at = end;
  }
  return out;
}

Call::Call() {
  ++calls;
  if (!ending) return;
  --calls;
  throw std::runtime_error("the interpreter is ending");
}

Call::~Call() { --calls; }

bool is_ending() { return ending; }

void forget_calls() { calls = 0; }

void end_all() {
  ending = true;
  const py::gil_scoped_release release;
  while (calls > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

numerics::Progress Watcher::progress() {
  return [this](double share) { return ask(share); };
}

bool Watcher::ask(double share) {
  constexpr double interval = 0.02;  // [s]: what a person takes for at once
  const std::lock_guard lock(mutex_);
  if (stop_ || is_ending()) return stop_ = true;
  const double now = seconds();
  if (share < 1.0 && asked_ >= 0.0 && now - asked_ < interval) return false;
  asked_ = now;
  const py::gil_scoped_acquire acquire;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!callback_.is_none()) {
      const py::object answer = callback_(share);
      const int truth = PyObject_IsTrue(answer.ptr());
      if (truth < 0) throw py::error_already_set();
      stop_ = truth == 1;
    }
  } catch (py::error_already_set& error) {
    error_ = std::make_unique<py::error_already_set>(error);
    stop_ = true;
  }
  return stop_;
}

void Watcher::rethrow() {
  if (error_) throw py::error_already_set(*error_);
}

void refuse_type(const py::handle& value, const std::string& name, const std::string& expected) {
  throw py::type_error(fmt::format("{}: expected {}, got a value of the type {}", name, expected,
                                   py::type::of(value).attr("__name__").cast<std::string>()));
}

std::string text_of(const py::handle& value, const std::string& name) {
  if (!py::isinstance<py::str>(value)) refuse_type(value, name, "a text");
  Py_ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  if (text == nullptr) {
    PyErr_Clear();
    throw std::invalid_argument(name + ": is no text in UTF-8");
  }
  const std::string found(text, static_cast<std::size_t>(size));
  if (found.find('\0') != std::string::npos)
    throw std::invalid_argument(name + ": has a character 0");
  return found;
}

std::string path_of(const py::handle& given, const std::string& name) {
  const auto path = py::reinterpret_steal<py::object>(PyOS_FSPath(given.ptr()));
  if (!path) {
    PyErr_Clear();
    refuse_type(given, name, "a text or a path");
  }
  if (!py::isinstance<py::str>(path)) refuse_type(path, name, "a text or a path");
  return text_of(path, name);
}

double quantity(const py::handle& value, const char* unit, const std::string& name) {
  if (py::isinstance<py::str>(value)) {
    const auto text = text_of(value, name);
    const auto read = base::read_plain_or_quantity(text, unit);
    if (!read.ok()) base::refuse(name + "=" + text, read.problem);
    return read.value;
  }
  if (PyBool_Check(value.ptr())) throw py::type_error(name + ": expected a quantity, got a bool");
  const bool real = is_real(value);
  const double number = real ? PyFloat_AsDouble(value.ptr()) : 0.0;
  if (!real || (number == -1.0 && PyErr_Occurred() != nullptr)) {
    PyErr_Clear();
    throw py::type_error(
        fmt::format("{}: expected a number in SI or a text such as \"2.5 {}\", got {}", name, unit,
                    py::str(py::type::of(value)).cast<std::string>()));
  }
  if (!std::isfinite(number)) base::refuse(name, "must be finite");
  return number;
}

double angular(const py::handle& value, const std::string& name) {
  double omega = 0.0;
  if (py::isinstance<py::str>(value)) {
    const auto text = text_of(value, name);
    const auto hertz = base::read_plain_or_quantity(text, "Hz");
    const auto radians = base::read_quantity(text, "rad/s");
    if (!hertz.ok() && !radians.ok()) base::refuse(name + "=" + text, hertz.problem);
    omega = hertz.ok() ? base::two_pi * hertz.value : radians.value;
  } else {
    omega = base::two_pi * quantity(value, "Hz", name);
  }
  if (!(omega > 0.0)) base::refuse(name, "a frequency must be positive");
  return omega;
}

std::size_t choice(const std::string& name, const std::string& word,
                   const std::vector<std::string_view>& words) {
  for (std::size_t k = 0; k < words.size(); ++k)
    if (words[k] == word) return k;
  const auto near = base::nearest(word, words);
  base::refuse(name + "=" + word, fmt::format("unknown value; {}accepted are {}",
                                              near ? fmt::format("did you mean '{}'? ", *near) : "",
                                              fmt::join(words, ", ")));
}

bool Options::has(const char* name) const {
  return values_.contains(name) && !values_[name].is_none();
}

std::optional<double> Options::amount(const char* name, const char* unit) const {
  if (!has(name)) return {};
  return quantity((*this)[name], unit, argument_of(name));
}

std::optional<double> Options::at_least_zero(const char* name, const char* unit) const {
  const auto value = amount(name, unit);
  if (value && *value < 0.0) base::refuse(argument_of(name), "cannot be negative");
  return value;
}

std::optional<double> Options::positive(const char* name, const char* unit) const {
  const auto value = amount(name, unit);
  if (value && !(*value > 0.0)) base::refuse(argument_of(name), "must be positive");
  return value;
}

std::vector<std::string> texts(const std::vector<base::Diagnostic>& diagnostics) {
  std::vector<std::string> list;
  for (const auto& one : diagnostics) list.push_back(one.text());
  return list;
}

}  // namespace hydrapod::python
