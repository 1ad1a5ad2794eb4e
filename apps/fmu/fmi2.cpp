/// The interface of FMI 2.0, written from the standard (version 2.0.4, chapters 2 to 4).

#include <cstdlib>

#include "component.hpp"

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

constexpr unsigned of_exchange = event | continuous;
/// After an error values can still be looked at.
constexpr unsigned can_be_read = readable | failed;

int no_such_variables(void* c, const char* function, std::size_t count) {
  return guarded(c, readable | instantiated, function, [&](Component&) {
    require(count == 0, "the FMU has no variables of this type");
    return ok;
  });
}

}  // namespace

HYDRAPOD_FMI const char* fmi2GetTypesPlatform() { return "default"; }
HYDRAPOD_FMI const char* fmi2GetVersion() { return "2.0"; }

HYDRAPOD_FMI void* fmi2Instantiate(const char* name, int kind, const char* guid,
                                   const char* location, const Callbacks* callbacks, Boolean,
                                   Boolean logging) {
  const std::string called = name == nullptr ? "" : name;
  const auto log = log_of(callbacks, called);
  try {
    require(!called.empty(), "the instance has no name");
    require(guid != nullptr && location != nullptr, "no GUID or no location of the resources");
    require(kind == model_exchange || kind == co_simulation, "the type of the FMU is unknown");
    return new Component{Instance(path_of(location), guid),
                         kind == co_simulation,
                         called,
                         log,
                         instantiated,
                         logging != 0};
  } catch (const std::exception& exception) {
    if (log) log(error, "logStatusError", std::string("fmi2Instantiate: ") + exception.what());
    return nullptr;
  }
}

HYDRAPOD_FMI void fmi2FreeInstance(void* c) { delete static_cast<Component*>(c); }

HYDRAPOD_FMI int fmi2SetDebugLogging(void* c, Boolean on, std::size_t count,
                                     const char* const categories[]) {
  return guarded(c, any_mode, __func__, [&](Component& component) {
    set_categories(component, on != 0, count, categories);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2SetupExperiment(void* c, Boolean has_tolerance, double tolerance, double start,
                                     Boolean has_stop, double stop) {
  return guarded(c, instantiated, __func__, [&](Component& component) {
    component.instance.set_up(start, has_stop != 0, stop, has_tolerance != 0, tolerance);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2EnterInitializationMode(void* c) {
  return guarded(c, instantiated, __func__, [](Component& component) {
    component.mode = initialization;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2ExitInitializationMode(void* c) {
  return guarded(c, initialization, __func__, [](Component& component) {
    component.instance.prepare_if_needed();
    component.mode = component.co_simulation ? step_complete : event;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2Terminate(void* c) {
  return guarded(c, of_exchange | step_complete | step_failed, __func__, [](Component& component) {
    component.mode = terminated;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2Reset(void* c) {
  return guarded(c, any_mode, __func__, [](Component& component) {
    component.instance.reset();
    component.mode = instantiated;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2GetReal(void* c, const Reference references[], std::size_t count,
                             double values[]) {
  return guarded(c, can_be_read, __func__, [&](Component& component) {
    get_values(component, references, count, values);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2SetReal(void* c, const Reference references[], std::size_t count,
                             const double values[]) {
  constexpr unsigned settable = instantiated | initialization | of_exchange | step_complete;
  return guarded(c, settable, __func__, [&](Component& component) {
    set_values(component, references, count, values);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2GetInteger(void* c, const Reference[], std::size_t count, int[]) {
  return no_such_variables(c, __func__, count);
}
HYDRAPOD_FMI int fmi2GetBoolean(void* c, const Reference[], std::size_t count, Boolean[]) {
  return no_such_variables(c, __func__, count);
}
HYDRAPOD_FMI int fmi2GetString(void* c, const Reference[], std::size_t count, const char*[]) {
  return no_such_variables(c, __func__, count);
}
HYDRAPOD_FMI int fmi2SetInteger(void* c, const Reference[], std::size_t count, const int[]) {
  return no_such_variables(c, __func__, count);
}
HYDRAPOD_FMI int fmi2SetBoolean(void* c, const Reference[], std::size_t count, const Boolean[]) {
  return no_such_variables(c, __func__, count);
}
HYDRAPOD_FMI int fmi2SetString(void* c, const Reference[], std::size_t count, const char* const[]) {
  return no_such_variables(c, __func__, count);
}

HYDRAPOD_FMI int fmi2GetFMUstate(void* c, void** state) {
  return guarded(c, any_mode, __func__, [&](Component& component) {
    require(state != nullptr, "a null pointer");
    void* now = save(component);
    delete static_cast<SavedState*>(*state);
    *state = now;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2SetFMUstate(void* c, void* state) {
  return guarded(c, any_mode, __func__, [&](Component& component) {
    restore(component, state);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2FreeFMUstate(void* c, void** state) {
  return guarded(c, any_mode, __func__, [&](Component&) {
    if (state == nullptr) return ok;
    delete static_cast<SavedState*>(*state);
    *state = nullptr;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2SerializedFMUstateSize(void* c, void* state, std::size_t* size) {
  return guarded(c, any_mode, __func__, [&](Component&) {
    require(state != nullptr && size != nullptr, "a null pointer");
    *size = static_cast<SavedState*>(state)->bytes();
    return ok;
  });
}

HYDRAPOD_FMI int fmi2SerializeFMUstate(void* c, void* state, char bytes[], std::size_t size) {
  return guarded(c, any_mode, __func__, [&](Component&) {
    require(state != nullptr && bytes != nullptr, "a null pointer");
    const auto& saved = *static_cast<SavedState*>(state);
    require(size >= saved.bytes(), "too few bytes for the serialized state");
    saved.write(bytes);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2DeSerializeFMUstate(void* c, const char bytes[], std::size_t size,
                                         void** state) {
  return guarded(c, any_mode, __func__, [&](Component& component) {
    require(state != nullptr, "a null pointer");
    void* made = deserialized(component, bytes, size);
    delete static_cast<SavedState*>(*state);
    *state = made;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2GetDirectionalDerivative(void* c, const Reference unknowns[],
                                              std::size_t unknown_count, const Reference knowns[],
                                              std::size_t known_count, const double seed[],
                                              double sensitivity[]) {
  return guarded(c, can_be_read, __func__, [&](Component& component) {
    require((unknowns != nullptr && sensitivity != nullptr) || unknown_count == 0,
            "a null pointer");
    require((knowns != nullptr && seed != nullptr) || known_count == 0, "a null pointer");
    std::vector<double> column(unknown_count), sum(unknown_count, 0.0);
    const bool with_states = component.mode != initialization;
    for (std::size_t k = 0; k < known_count; ++k) {
      component.instance.derivative(knowns[k], unknowns, unknown_count, with_states, column.data());
      for (std::size_t u = 0; u < unknown_count; ++u) sum[u] += column[u] * seed[k];
    }
    std::ranges::copy(sum, sensitivity);
    return ok;
  });
}

// ---- Model exchange -------------------------------------------------------------------------

HYDRAPOD_FMI int fmi2EnterEventMode(void* c) {
  return guarded(c, of_exchange, __func__, [](Component& component) {
    component.mode = event;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2NewDiscreteStates(void* c, EventInfo* info) {
  return guarded(c, event, __func__, [&](Component& component) {
    require(info != nullptr, "a null pointer");
    *info = {};
    info->terminate = component.instance.has_ended() ? 1 : 0;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2EnterContinuousTimeMode(void* c) {
  return guarded(c, event, __func__, [](Component& component) {
    component.mode = continuous;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2CompletedIntegratorStep(void* c, Boolean, Boolean* enter_event_mode,
                                             Boolean* terminate) {
  return guarded(c, continuous, __func__, [&](Component& component) {
    require(enter_event_mode != nullptr && terminate != nullptr, "a null pointer");
    *enter_event_mode = 0;
    *terminate = component.instance.has_ended() ? 1 : 0;
    return ok;
  });
}

HYDRAPOD_FMI int fmi2SetTime(void* c, double time) {
  return guarded(c, of_exchange, __func__, [&](Component& component) {
    component.instance.set_time(time);
    return ok;
  });
}

HYDRAPOD_FMI int fmi2SetContinuousStates(void* c, const double x[], std::size_t count) {
  return guarded(c, continuous, __func__, [&](Component& component) {
    require(x != nullptr && count == static_cast<std::size_t>(component.instance.state_count()),
            "a null pointer, or another number of continuous states");
    component.instance.set_states(x);
    return ok;
  });
}

namespace {

constexpr unsigned looks_at_states = initialization | of_exchange | terminated | failed;

/// What fills one of the lists of model exchange.
template <class Fill>
int list_of(void* c, unsigned modes, const char* function, double* list, std::size_t count,
            bool of_states, const Fill& fill) {
  return guarded(c, modes, function, [&](Component& component) {
    require(!component.co_simulation, "the instance is one of co-simulation");
    auto& instance = component.instance;
    const int expected = of_states ? instance.state_count() : instance.indicator_count();
    require((list != nullptr || count == 0) && count == static_cast<std::size_t>(expected),
            "a null pointer, or another number of values");
    fill(instance);
    return ok;
  });
}

}  // namespace

HYDRAPOD_FMI int fmi2GetDerivatives(void* c, double rates[], std::size_t count) {
  return list_of(c, looks_at_states, __func__, rates, count, true,
                 [&](Instance& instance) { instance.derivatives(rates); });
}

HYDRAPOD_FMI int fmi2GetEventIndicators(void* c, double values[], std::size_t count) {
  return list_of(c, looks_at_states, __func__, values, count, false,
                 [&](Instance& instance) { std::ranges::copy(instance.indicators(), values); });
}

HYDRAPOD_FMI int fmi2GetContinuousStates(void* c, double x[], std::size_t count) {
  return list_of(c, looks_at_states, __func__, x, count, true, [&](Instance& instance) {
    instance.prepare_if_needed();
    std::ranges::copy(instance.states(), x);
  });
}

HYDRAPOD_FMI int fmi2GetNominalsOfContinuousStates(void* c, double nominals[], std::size_t count) {
  return list_of(c, looks_at_states | instantiated, __func__, nominals, count, true,
                 [&](Instance& instance) { std::ranges::copy(instance.nominals(), nominals); });
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

HYDRAPOD_FMI int fmi2DoStep(void* c, double from, double size, Boolean) {
  return guarded(c, step_complete, __func__, [&](Component& component) -> int {
    std::string message;
    if (component.instance.step(from, size, message)) return ok;
    component.mode = step_failed;
    component.say(discard, "fmi2DoStep: " + message);
    return discard;
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
