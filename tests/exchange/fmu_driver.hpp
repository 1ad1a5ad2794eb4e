#pragma once
/// An FMU as a simulator sees it: its archive unpacked by another program, its shared object
/// loaded, its functions found by name. Declared from the standards, apart from apps/fmu.

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "hydrapod/base/file.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {

enum Status { ok = 0, warning = 1, discard = 2, error = 3 };

/// The bytes of an FMU of this build.
inline std::string archive_of(const model::Machine& machine, exchange::FmuOptions options) {
  const auto object = exchange::fmu_object_file();
  if (object.empty()) throw std::runtime_error("build the target hydrapod_fmu");
  options.object = read_text(object);
  options.notices = "none";
  return exchange::fmu(machine, machine.poses.front(), options, {.title = machine.name}).archive;
}
inline std::string archive_of(const model::Machine& machine, exchange::FmuVersion version,
                              bool hydraulics,
                              dynamics::ModelKind kind = dynamics::ModelKind::guide) {
  return archive_of(machine, {.version = version, .kind = kind, .hydraulics = hydraulics});
}

class Unpacked {
 public:
  /// `other_object`: instead of the one in the archive.
  explicit Unpacked(const std::string& archive,
                    const std::function<std::string(const Unpacked&)>& other_object = {}) {
    base::write_file_whole(file(), archive);
    const auto made = run_program("/usr/bin/python3",
                                  {"-m", "zipfile", "-e", file(), (folder_ / "all").string()});
    if (made.exit_code != 0) throw std::runtime_error(made.err);
    description = read_text(folder_ / "all/modelDescription.xml");
    const auto word = [&](const char* attribute) {
      std::smatch found;
      std::regex_search(description, found, std::regex(std::string(attribute) + "=\"([^\"]*)\""));
      return found[1].str();
    };
    three = word("fmiVersion") == "3.0";
    token = word(three ? "instantiationToken" : "guid");
    object = (folder_ / "all/binaries").string() + (three ? "/x86_64-linux/" : "/linux64/") +
             word("modelIdentifier") + ".so";
    if (other_object) object = other_object(*this);
    library_ = dlopen(object.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) throw std::runtime_error(dlerror());
    const std::regex variable("name=\"([^\"]*)\" valueReference=\"(\\d+)\"");
    for (std::sregex_iterator at(description.begin(), description.end(), variable), end; at != end;
         ++at)
      references[(*at)[1]] = static_cast<unsigned>(std::stoul((*at)[2]));
  }
  Unpacked(const Unpacked&) = delete;
  Unpacked& operator=(const Unpacked&) = delete;
  ~Unpacked() {
    if (library_ != nullptr) dlclose(library_);
  }

  /// Calls the function of that name; what it takes is what is given.
  template <class Result = int, class... Arguments>
  Result call(const char* name, Arguments... arguments) const {
    auto* found = dlsym(library_, name);
    if (found == nullptr) throw std::runtime_error(std::string("there is no ") + name);
    return reinterpret_cast<Result (*)(Arguments...)>(found)(arguments...);
  }

  [[nodiscard]] std::string file() const { return (folder_ / "machine.fmu").string(); }
  [[nodiscard]] std::string folder() const { return (folder_ / "all").string(); }
  [[nodiscard]] std::string resources() const { return (folder_ / "all/resources").string(); }
  [[nodiscard]] unsigned reference(const std::string& name) const { return references.at(name); }

  std::string description{}, token{}, object{};
  bool three{};
  std::map<std::string, unsigned> references{};

 private:
  TemporaryFolder folder_{};
  void* library_{};
};

inline void ignore_message(void*, const char*, int, const char*, const char*, ...) {}
inline void ignore_message_3(void*, int, const char*, const char*) {}

using IntermediateUpdate = void (*)(void*, double, bool, bool, bool, bool, bool*, double*);

/// What an importer of FMI 3.0 can do in co-simulation.
struct Importer {
  bool event_mode{}, early_return{};
  std::vector<unsigned> intermediate_variables{};
  IntermediateUpdate intermediate_update{};
  void* environment{};
  void (*log)(void*, int, const char*, const char*){ignore_message_3};
};

struct Reached {
  bool event{}, terminate{}, early{};
  double time{};
};

struct Callbacks {
  void (*logger)(void*, const char*, int, const char*, const char*, ...){ignore_message};
  void* (*allocate)(std::size_t, std::size_t){};
  void (*release)(void*){};
  void (*step_finished)(void*, int){};
  void* environment{};
};

/// An instance, by the functions that both versions have.
class Slave {
 public:
  Slave(const Unpacked& fmu, bool co_simulation, bool initialize = true, double tolerance = 1e-6,
        const Importer& importer = {})
      : fmu_(fmu) {
    if (fmu.three && co_simulation)
      instance_ = fmu.call<void*>("fmi3InstantiateCoSimulation", "one", fmu.token.c_str(),
                                  fmu.resources().c_str(), false, false, importer.event_mode,
                                  importer.early_return, importer.intermediate_variables.data(),
                                  importer.intermediate_variables.size(), importer.environment,
                                  importer.log, importer.intermediate_update);
    else if (fmu.three)
      instance_ = fmu.call<void*>("fmi3InstantiateModelExchange", "one", fmu.token.c_str(),
                                  fmu.resources().c_str(), false, false,
                                  static_cast<void*>(nullptr), &ignore_message_3);
    else
      instance_ = fmu.call<void*>("fmi2Instantiate", "one", co_simulation ? 1 : 0,
                                  fmu.token.c_str(), ("file://" + fmu.resources()).c_str(),
                                  static_cast<const Callbacks*>(&callbacks_), 0, 0);
    if (instance_ == nullptr) throw std::runtime_error("no instance");
    if (initialize) begin(tolerance);
  }
  Slave(const Slave&) = delete;
  Slave& operator=(const Slave&) = delete;
  ~Slave() { fmu_.call<void>(fmu_.three ? "fmi3FreeInstance" : "fmi2FreeInstance", instance_); }

  void begin(double tolerance) {
    if (fmu_.three) {
      EXPECT_EQ(ok, call("fmi3EnterInitializationMode", true, tolerance, 0.0, false, 0.0));
      EXPECT_EQ(ok, call("fmi3ExitInitializationMode"));
      return;
    }
    EXPECT_EQ(ok, call("fmi2SetupExperiment", 1, tolerance, 0.0, 0, 0.0));
    EXPECT_EQ(ok, call("fmi2EnterInitializationMode"));
    EXPECT_EQ(ok, call("fmi2ExitInitializationMode"));
  }

  template <class... Arguments>
  int call(const char* name, Arguments... arguments) const {
    return fmu_.call(name, instance_, arguments...);
  }

  int set(const std::vector<unsigned>& references, const std::vector<double>& values) const {
    if (fmu_.three)
      return call("fmi3SetFloat64", references.data(), references.size(), values.data(),
                  values.size());
    return call("fmi2SetReal", references.data(), references.size(), values.data());
  }
  int set(const std::string& name, double value) const {
    return set(std::vector{fmu_.reference(name)}, {value});
  }
  [[nodiscard]] std::vector<double> get(const std::vector<unsigned>& references) const {
    std::vector<double> values(references.size());
    const int status =
        fmu_.three ? call("fmi3GetFloat64", references.data(), references.size(), values.data(),
                          values.size())
                   : call("fmi2GetReal", references.data(), references.size(), values.data());
    EXPECT_EQ(ok, status);
    return values;
  }
  [[nodiscard]] double get(const std::string& name) const {
    return get(std::vector{fmu_.reference(name)})[0];
  }

  int step(double from, double size) const {
    if (!fmu_.three) return call("fmi2DoStep", from, size, 1);
    bool event{}, terminate{}, early{};
    double last{};
    return call("fmi3DoStep", from, size, true, &event, &terminate, &early, &last);
  }

  int step(double from, double size, Reached& reached) const {
    return call("fmi3DoStep", from, size, true, &reached.event, &reached.terminate, &reached.early,
                &reached.time);
  }

  void enter_continuous_time() const {
    EXPECT_EQ(ok, call(fmu_.three ? "fmi3EnterContinuousTimeMode" : "fmi2EnterContinuousTimeMode"));
  }
  int set_states(const std::vector<double>& x) const {
    return call(fmu_.three ? "fmi3SetContinuousStates" : "fmi2SetContinuousStates", x.data(),
                x.size());
  }
  int derivatives(double* rates, std::size_t count) const {
    return call(fmu_.three ? "fmi3GetContinuousStateDerivatives" : "fmi2GetDerivatives", rates,
                count);
  }
  int states(double* x, std::size_t count) const {
    return call(fmu_.three ? "fmi3GetContinuousStates" : "fmi2GetContinuousStates", x, count);
  }

  int save(void** state) const { return call(named("fmi2GetFMUstate", "fmi3GetFMUState"), state); }
  int restore(void* state) const {
    return call(named("fmi2SetFMUstate", "fmi3SetFMUState"), state);
  }
  int release(void** state) const {
    return call(named("fmi2FreeFMUstate", "fmi3FreeFMUState"), state);
  }
  [[nodiscard]] std::vector<char> bytes_of(void* state) const {
    std::size_t size = 0;
    EXPECT_EQ(
        ok, call(named("fmi2SerializedFMUstateSize", "fmi3SerializedFMUStateSize"), state, &size));
    std::vector<char> bytes(size);
    EXPECT_EQ(ok, call(named("fmi2SerializeFMUstate", "fmi3SerializeFMUState"), state, bytes.data(),
                       size));
    return bytes;
  }
  int state_from(const std::vector<char>& bytes, void** state) const {
    return call(named("fmi2DeSerializeFMUstate", "fmi3DeserializeFMUState"), bytes.data(),
                bytes.size(), state);
  }

  /// d unknowns / d known.
  [[nodiscard]] std::vector<double> directional(const std::vector<unsigned>& unknowns,
                                                unsigned known) const {
    std::vector<double> result(unknowns.size());
    const double seed = 1.0;
    const int status =
        fmu_.three ? call("fmi3GetDirectionalDerivative", unknowns.data(), unknowns.size(), &known,
                          std::size_t{1}, &seed, std::size_t{1}, result.data(), result.size())
                   : call("fmi2GetDirectionalDerivative", unknowns.data(), unknowns.size(), &known,
                          std::size_t{1}, &seed, result.data());
    EXPECT_EQ(ok, status);
    return result;
  }

  [[nodiscard]] const Unpacked& fmu() const { return fmu_; }

 private:
  [[nodiscard]] const char* named(const char* in_2, const char* in_3) const {
    return fmu_.three ? in_3 : in_2;
  }

  const Unpacked& fmu_;
  Callbacks callbacks_{};
  void* instance_{};
};

}  // namespace hydrapod::test
