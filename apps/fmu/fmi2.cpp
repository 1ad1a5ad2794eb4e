/// The interface of FMI 2.0 (version 2.0.4, chapters 2 to 4).

#include <cstdlib>

#include "calls.hpp"

#define HYDRAPOD_FMI extern "C" __attribute__((visibility("default")))

namespace {

using namespace hydrapod::fmu;

using Reference = unsigned;
using Boolean = int;
using Logger = void (*)(void* environment, const char* instance, int status, const char* category,
                        const char* message, ...);

struct Callbacks {
  Logger logger;
  void* (*allocate)(std::size_t, std::size_t);
  void (*release)(void*);
  void (*step_finished)(void*, int);
  void* environment;
};

struct EventInfo {
  Boolean new_discrete_states, terminate, nominals_changed, values_changed, next_time_defined;
  double next_time;
};

enum Kind : int { model_exchange = 0, co_simulation = 1 };
enum StatusKind : int { do_step_status = 0, pending_status = 1, last_time = 2, is_terminated = 3 };

/// The path of "file:///a%20b", "file:/a", "file://localhost/a", or of a plain path.
std::string path_of(const std::string& location) {
  std::string rest = location;
  if (rest.starts_with("file:")) {
    rest.erase(0, 5);
    if (rest.starts_with("//")) {
      const auto slash = rest.find('/', 2);
      rest.erase(0, slash == std::string::npos ? rest.size() : slash);
    }
  }
  std::string path;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] == '%' && i + 2 < rest.size() && location.starts_with("file:")) {
      path += static_cast<char>(std::strtol(rest.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      path += rest[i];
    }
  }
  return path;
}

/// A message is a format there.
std::string without_format(const std::string& message) {
  std::string text;
  for (const char c : message) text += c == '%' ? std::string("%%") : std::string(1, c);
  return text;
}

Log log_of(const Callbacks* callbacks, const std::string& name) {
  if (callbacks == nullptr || callbacks->logger == nullptr) return {};
  return [logger = callbacks->logger, environment = callbacks->environment, name](
             int status, const char* category, const std::string& message) {
    logger(environment, name.c_str(), status, category, without_format(message).c_str());
  };
}

constexpr unsigned settable = instantiated | initialization | of_exchange | step_complete;
constexpr unsigned looks_at_states = of_exchange | terminated | failed;

/// Of other types than Real there are no variables.
int no_variables(void* c, const char* function, std::size_t count) {
  return calls::no_such_variables(c, readable | instantiated, function, count);
}

}  // namespace

HYDRAPOD_FMI const char* fmi2GetTypesPlatform() { return "default"; }
HYDRAPOD_FMI const char* fmi2GetVersion() { return "2.0"; }

HYDRAPOD_FMI void* fmi2Instantiate(const char* name, int kind, const char* guid,
                                   const char* location, const Callbacks* callbacks, Boolean,
                                   Boolean logging) {
  const auto folder = [&] {
    require(location != nullptr, "no location of the resources is given");
    require(kind == model_exchange || kind == co_simulation, "the type of the FMU is unknown");
    return path_of(location);
  };
  return calls::instantiate(__func__, name, guid, folder, logging != 0, kind == co_simulation,
                            log_of(callbacks, name == nullptr ? "" : name));
}

HYDRAPOD_FMI void fmi2FreeInstance(void* c) { delete static_cast<Component*>(c); }

HYDRAPOD_FMI int fmi2SetDebugLogging(void* c, Boolean on, std::size_t count,
                                     const char* const categories[]) {
  return calls::set_logging(c, __func__, on != 0, count, categories);
}

HYDRAPOD_FMI int fmi2SetupExperiment(void* c, Boolean has_tolerance, double tolerance, double start,
                                     Boolean has_stop, double stop) {
  return guarded(c, instantiated, __func__, [&](Component& component) {
    component.instance.set_up(start, has_stop != 0, stop, has_tolerance != 0, tolerance);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2EnterInitializationMode(void* c) {
  return calls::enter(c, instantiated, __func__, initialization);
}
HYDRAPOD_FMI int fmi2ExitInitializationMode(void* c) {
  return calls::exit_initialization(c, __func__);
}
HYDRAPOD_FMI int fmi2Terminate(void* c) {
  return calls::enter(c, of_exchange | step_complete | step_failed, __func__, terminated);
}
HYDRAPOD_FMI int fmi2Reset(void* c) { return calls::reset(c, __func__); }

// ---- Values ---------------------------------------------------------------------------------

HYDRAPOD_FMI int fmi2GetReal(void* c, const Reference references[], std::size_t count,
                             double values[]) {
  return calls::get_values(c, readable, __func__, references, count, values, count);
}
HYDRAPOD_FMI int fmi2SetReal(void* c, const Reference references[], std::size_t count,
                             const double values[]) {
  return calls::set_values(c, settable, __func__, references, count, values, count, false);
}

#define HYDRAPOD_NO_VARIABLES(Type, Value)                                                       \
  HYDRAPOD_FMI int fmi2Get##Type(void* c, const Reference[], std::size_t count, Value[]) {       \
    return no_variables(c, __func__, count);                                                     \
  }                                                                                              \
  HYDRAPOD_FMI int fmi2Set##Type(void* c, const Reference[], std::size_t count, const Value[]) { \
    return no_variables(c, __func__, count);                                                     \
  }
HYDRAPOD_NO_VARIABLES(Integer, int)
HYDRAPOD_NO_VARIABLES(Boolean, Boolean)
using Text = const char*;
HYDRAPOD_NO_VARIABLES(String, Text)
#undef HYDRAPOD_NO_VARIABLES

// ---- State and derivatives ------------------------------------------------------------------

HYDRAPOD_FMI int fmi2GetFMUstate(void* c, void** state) {
  return calls::get_state(c, __func__, state);
}
HYDRAPOD_FMI int fmi2SetFMUstate(void* c, void* state) {
  return calls::set_state(c, __func__, state);
}
HYDRAPOD_FMI int fmi2FreeFMUstate(void* c, void** state) {
  return calls::free_state(c, __func__, state);
}
HYDRAPOD_FMI int fmi2SerializedFMUstateSize(void* c, void* state, std::size_t* size) {
  return calls::state_size(c, __func__, state, size);
}
HYDRAPOD_FMI int fmi2SerializeFMUstate(void* c, void* state, char bytes[], std::size_t size) {
  return calls::serialize(c, __func__, state, bytes, size);
}
HYDRAPOD_FMI int fmi2DeSerializeFMUstate(void* c, const char bytes[], std::size_t size,
                                         void** state) {
  return calls::deserialize(c, __func__, bytes, size, state);
}

HYDRAPOD_FMI int fmi2GetDirectionalDerivative(void* c, const Reference unknowns[],
                                              std::size_t unknown_count, const Reference knowns[],
                                              std::size_t known_count, const double seed[],
                                              double sensitivity[]) {
  return calls::derivative(c, __func__, false,
                           {unknowns, unknown_count, knowns, known_count, seed, sensitivity});
}

// ---- Model exchange -------------------------------------------------------------------------

HYDRAPOD_FMI int fmi2EnterEventMode(void* c) {
  return calls::enter(c, of_exchange, __func__, event, true);
}

HYDRAPOD_FMI int fmi2NewDiscreteStates(void* c, EventInfo* info) {
  if (info == nullptr)
    return guarded(c, event, __func__, [](Component&) -> int { throw Misuse("a null pointer"); });
  calls::Update update;
  const int status = calls::update_discrete_states(c, __func__, update);
  *info = {};
  info->terminate = update.terminate ? 1 : 0;
  info->next_time_defined = update.next_time ? 1 : 0;
  info->next_time = update.next_time.value_or(0.0);
  return status;
}

HYDRAPOD_FMI int fmi2EnterContinuousTimeMode(void* c) {
  return calls::enter(c, event, __func__, continuous, true);
}

HYDRAPOD_FMI int fmi2CompletedIntegratorStep(void* c, Boolean, Boolean* enter_event_mode,
                                             Boolean* terminate) {
  const bool given = enter_event_mode != nullptr && terminate != nullptr;
  bool enters = false, ends = false;
  const int status = calls::completed_step(c, __func__, given ? &enters : nullptr, &ends);
  if (!given) return status;
  *enter_event_mode = enters ? 1 : 0;
  *terminate = ends ? 1 : 0;
  return status;
}

HYDRAPOD_FMI int fmi2SetTime(void* c, double time) {
  return calls::set_time(c, of_exchange, __func__, time);
}
HYDRAPOD_FMI int fmi2SetContinuousStates(void* c, const double x[], std::size_t count) {
  return calls::set_states(c, __func__, x, count);
}
HYDRAPOD_FMI int fmi2GetDerivatives(void* c, double rates[], std::size_t count) {
  return calls::get_list(c, looks_at_states, __func__, calls::List::rates, rates, count);
}
HYDRAPOD_FMI int fmi2GetEventIndicators(void* c, double values[], std::size_t count) {
  return calls::get_list(c, looks_at_states | initialization, __func__, calls::List::indicators,
                         values, count);
}
HYDRAPOD_FMI int fmi2GetContinuousStates(void* c, double x[], std::size_t count) {
  return calls::get_list(c, looks_at_states | initialization, __func__, calls::List::states, x,
                         count);
}
HYDRAPOD_FMI int fmi2GetNominalsOfContinuousStates(void* c, double nominals[], std::size_t count) {
  return calls::get_list(c, looks_at_states | instantiated, __func__, calls::List::nominals,
                         nominals, count);
}

// ---- Co-simulation --------------------------------------------------------------------------

HYDRAPOD_FMI int fmi2SetRealInputDerivatives(void* c, const Reference[], std::size_t, const int[],
                                             const double[]) {
  return guarded(c, instantiated | initialization | step_complete, __func__,
                 [](Component&) -> int { throw Misuse("the FMU does not interpolate inputs"); });
}

HYDRAPOD_FMI int fmi2GetRealOutputDerivatives(void* c, const Reference[], std::size_t, const int[],
                                              double[]) {
  return guarded(c, step_complete | step_failed | terminated, __func__, [](Component&) -> int {
    throw Misuse("the FMU gives no derivatives of outputs");
  });
}

/// What was computed of a step that is discarded stays; fmi2GetRealStatus tells to which time.
HYDRAPOD_FMI int fmi2DoStep(void* c, double from, double size, Boolean) {
  return guarded(c, step_complete, __func__, [&](Component& component) -> int {
    const auto result = component.instance.step(from, size, {});
    if (result.whole) return ok;
    component.mode = step_failed;
    return component.refuse("fmi2DoStep: " + result.message);
  });
}

HYDRAPOD_FMI int fmi2CancelStep(void* c) {
  return guarded(c, 0U, __func__, [](Component&) { return ok; });  // a step is never pending
}

namespace {

template <class Value>
int status_of(void* c, const char* function, Value* value, bool known, const auto& get) {
  return guarded(c, step_complete | step_failed | terminated, function, [&](Component& component) {
    require(value != nullptr && component.co_simulation, "a null pointer, or no co-simulation");
    if (!known) return discard;
    *value = get(component);
    return ok;
  });
}

}  // namespace

HYDRAPOD_FMI int fmi2GetStatus(void* c, int kind, int* status) {
  return status_of(c, __func__, status, kind == do_step_status,
                   [](Component& one) { return one.mode == step_failed ? discard : ok; });
}
HYDRAPOD_FMI int fmi2GetRealStatus(void* c, int kind, double* value) {
  return status_of(c, __func__, value, kind == last_time,
                   [](Component& one) { return one.instance.time(); });
}
HYDRAPOD_FMI int fmi2GetIntegerStatus(void* c, int, int* value) {
  return status_of(c, __func__, value, false, [](Component&) { return 0; });
}
HYDRAPOD_FMI int fmi2GetBooleanStatus(void* c, int kind, Boolean* value) {
  return status_of(c, __func__, value, kind == is_terminated,
                   [](Component& one) { return one.mode == step_failed ? 1 : 0; });
}
HYDRAPOD_FMI int fmi2GetStringStatus(void* c, int, const char** value) {
  return status_of(c, __func__, value, false, [](Component&) { return ""; });
}
