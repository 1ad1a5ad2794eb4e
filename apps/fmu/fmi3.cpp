/// The interface of FMI 3.0, written from the standard (version 3.0, chapters 2 to 4). There are no
/// clocks, no structural parameters and no scheduled execution: their functions answer by an error.

#include <cstdint>

#include "component.hpp"

#define HYDRAPOD_FMI extern "C" __attribute__((visibility("default")))

namespace {

using namespace hydrapod::fmu;

using Reference = std::uint32_t;
using LogMessage = void (*)(void* environment, int status, const char* category,
                            const char* message);

constexpr unsigned of_exchange = event | continuous;
constexpr unsigned settable = instantiated | initialization | of_exchange | step_complete;

void* instantiate(const char* name, const char* token, const char* resources, bool logging,
                  void* environment, LogMessage log_message, bool co_simulation) {
  Log log;
  if (log_message != nullptr)
    log = [=](int status, const char* category, const std::string& message) {
      log_message(environment, status, category, message.c_str());
    };
  try {
    require(name != nullptr && *name != '\0', "the instance has no name");
    require(token != nullptr && resources != nullptr, "no token or no path of the resources");
    return new Component{
        Instance(resources, token), co_simulation, name, log, instantiated, logging};
  } catch (const std::exception& exception) {
    if (log) log(error, "logStatusError", std::string("instantiation: ") + exception.what());
    return nullptr;
  }
}

/// Of a type that no variable has.
int no_such_variables(void* instance, const char* function, std::size_t count) {
  return guarded(instance, readable | instantiated, function, [&](Component&) {
    require(count == 0, "the FMU has no variables of this type");
    return ok;
  });
}

int not_provided(void* instance, const char* function) {
  return guarded(instance, any_mode, function, [&](Component&) -> int {
    throw Misuse("the FMU does not provide it, see its model description");
  });
}

}  // namespace

HYDRAPOD_FMI const char* fmi3GetVersion() { return "3.0"; }

HYDRAPOD_FMI int fmi3SetDebugLogging(void* instance, bool on, std::size_t count,
                                     const char* const categories[]) {
  return guarded(instance, any_mode, __func__, [&](Component& component) {
    set_categories(component, on, count, categories);
    return ok;
  });
}

HYDRAPOD_FMI void* fmi3InstantiateModelExchange(const char* name, const char* token,
                                                const char* resources, bool, bool logging,
                                                void* environment, LogMessage log_message) {
  return instantiate(name, token, resources, logging, environment, log_message, false);
}

HYDRAPOD_FMI void* fmi3InstantiateCoSimulation(const char* name, const char* token,
                                               const char* resources, bool, bool logging,
                                               bool event_mode_used, bool, const Reference[],
                                               std::size_t intermediate_count, void* environment,
                                               LogMessage log_message, void (*)()) {
  if (event_mode_used || intermediate_count > 0) {
    if (log_message != nullptr)
      log_message(environment, error, "logStatusError",
                  "fmi3InstantiateCoSimulation: the FMU has neither an event mode in co-simulation "
                  "nor intermediate variables, see its model description");
    return nullptr;
  }
  return instantiate(name, token, resources, logging, environment, log_message, true);
}

HYDRAPOD_FMI void* fmi3InstantiateScheduledExecution(const char*, const char*, const char*, bool,
                                                     bool, void* environment,
                                                     LogMessage log_message, void (*)(), void (*)(),
                                                     void (*)()) {
  if (log_message != nullptr)
    log_message(environment, error, "logStatusError",
                "fmi3InstantiateScheduledExecution: the FMU has no scheduled execution");
  return nullptr;
}

HYDRAPOD_FMI void fmi3FreeInstance(void* instance) { delete static_cast<Component*>(instance); }

HYDRAPOD_FMI int fmi3EnterInitializationMode(void* instance, bool has_tolerance, double tolerance,
                                             double start, bool has_stop, double stop) {
  return guarded(instance, instantiated, __func__, [&](Component& component) {
    component.instance.set_up(start, has_stop, stop, has_tolerance, tolerance);
    component.mode = initialization;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3ExitInitializationMode(void* instance) {
  return guarded(instance, initialization, __func__, [](Component& component) {
    component.instance.prepare_if_needed();
    component.mode = component.co_simulation ? step_complete : event;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3EnterEventMode(void* instance) {
  return guarded(instance, continuous, __func__, [](Component& component) {
    component.mode = event;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3Terminate(void* instance) {
  return guarded(instance, of_exchange | step_complete | step_failed, __func__,
                 [](Component& component) {
                   component.mode = terminated;
                   return ok;
                 });
}

HYDRAPOD_FMI int fmi3Reset(void* instance) {
  return guarded(instance, any_mode, __func__, [](Component& component) {
    component.instance.reset();
    component.mode = instantiated;
    return ok;
  });
}

// ---- Values ---------------------------------------------------------------------------------

HYDRAPOD_FMI int fmi3GetFloat64(void* instance, const Reference references[], std::size_t count,
                                double values[], std::size_t value_count) {
  return guarded(instance, readable, __func__, [&](Component& component) {
    require(count == value_count, "as many values as value references are expected");
    get_values(component, references, count, values);
    return ok;
  });
}

HYDRAPOD_FMI int fmi3SetFloat64(void* instance, const Reference references[], std::size_t count,
                                const double values[], std::size_t value_count) {
  return guarded(instance, settable, __func__, [&](Component& component) {
    require(count == value_count, "as many values as value references are expected");
    set_values(component, references, count, values);
    return ok;
  });
}

#define HYDRAPOD_NO_VARIABLES(Type, Value)                                                      \
  HYDRAPOD_FMI int fmi3Get##Type(void* instance, const Reference[], std::size_t count, Value[], \
                                 std::size_t) {                                                 \
    return no_such_variables(instance, __func__, count);                                        \
  }                                                                                             \
  HYDRAPOD_FMI int fmi3Set##Type(void* instance, const Reference[], std::size_t count,          \
                                 const Value[], std::size_t) {                                  \
    return no_such_variables(instance, __func__, count);                                        \
  }
HYDRAPOD_NO_VARIABLES(Float32, float)
HYDRAPOD_NO_VARIABLES(Int8, std::int8_t)
HYDRAPOD_NO_VARIABLES(UInt8, std::uint8_t)
HYDRAPOD_NO_VARIABLES(Int16, std::int16_t)
HYDRAPOD_NO_VARIABLES(UInt16, std::uint16_t)
HYDRAPOD_NO_VARIABLES(Int32, std::int32_t)
HYDRAPOD_NO_VARIABLES(UInt32, std::uint32_t)
HYDRAPOD_NO_VARIABLES(Int64, std::int64_t)
HYDRAPOD_NO_VARIABLES(UInt64, std::uint64_t)
HYDRAPOD_NO_VARIABLES(Boolean, bool)
using Text = const char*;
HYDRAPOD_NO_VARIABLES(String, Text)
#undef HYDRAPOD_NO_VARIABLES

HYDRAPOD_FMI int fmi3GetBinary(void* instance, const Reference[], std::size_t count, std::size_t[],
                               const std::uint8_t*[], std::size_t) {
  return no_such_variables(instance, __func__, count);
}
HYDRAPOD_FMI int fmi3SetBinary(void* instance, const Reference[], std::size_t count,
                               const std::size_t[], const std::uint8_t* const[], std::size_t) {
  return no_such_variables(instance, __func__, count);
}
HYDRAPOD_FMI int fmi3GetClock(void* instance, const Reference[], std::size_t count, bool[]) {
  return no_such_variables(instance, __func__, count);
}
HYDRAPOD_FMI int fmi3SetClock(void* instance, const Reference[], std::size_t count, const bool[]) {
  return no_such_variables(instance, __func__, count);
}

// ---- State and derivatives ------------------------------------------------------------------

HYDRAPOD_FMI int fmi3GetFMUState(void* instance, void** state) {
  return guarded(instance, any_mode, __func__, [&](Component& component) {
    require(state != nullptr, "a null pointer");
    void* now = save(component);
    delete static_cast<SavedState*>(*state);
    *state = now;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3SetFMUState(void* instance, void* state) {
  return guarded(instance, any_mode, __func__, [&](Component& component) {
    restore(component, state);
    return ok;
  });
}

HYDRAPOD_FMI int fmi3FreeFMUState(void* instance, void** state) {
  return guarded(instance, any_mode, __func__, [&](Component&) {
    if (state == nullptr) return ok;
    delete static_cast<SavedState*>(*state);
    *state = nullptr;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3SerializedFMUStateSize(void* instance, void* state, std::size_t* size) {
  return guarded(instance, any_mode, __func__, [&](Component&) {
    require(state != nullptr && size != nullptr, "a null pointer");
    *size = static_cast<SavedState*>(state)->bytes();
    return ok;
  });
}

HYDRAPOD_FMI int fmi3SerializeFMUState(void* instance, void* state, std::uint8_t bytes[],
                                       std::size_t size) {
  return guarded(instance, any_mode, __func__, [&](Component&) {
    require(state != nullptr && bytes != nullptr, "a null pointer");
    const auto& saved = *static_cast<SavedState*>(state);
    require(size >= saved.bytes(), "too few bytes for the serialized state");
    saved.write(reinterpret_cast<char*>(bytes));
    return ok;
  });
}

HYDRAPOD_FMI int fmi3DeserializeFMUState(void* instance, const std::uint8_t bytes[],
                                         std::size_t size, void** state) {
  return guarded(instance, any_mode, __func__, [&](Component& component) {
    require(state != nullptr, "a null pointer");
    void* made = deserialized(component, reinterpret_cast<const char*>(bytes), size);
    delete static_cast<SavedState*>(*state);
    *state = made;
    return ok;
  });
}

namespace {

/// Forward: sensitivity of each unknown, seeds of the knowns. Adjoint: the other way round.
int derivative(void* instance, const char* function, bool adjoint, const Reference unknowns[],
               std::size_t unknown_count, const Reference knowns[], std::size_t known_count,
               const double seed[], std::size_t seed_count, double sensitivity[],
               std::size_t sensitivity_count) {
  return guarded(instance, readable, function, [&](Component& component) {
    require(seed_count == (adjoint ? unknown_count : known_count) &&
                sensitivity_count == (adjoint ? known_count : unknown_count),
            "seeds and sensitivities do not go with knowns and unknowns");
    require(
        unknown_count == 0 || known_count == 0 ||
            (unknowns != nullptr && knowns != nullptr && seed != nullptr && sensitivity != nullptr),
        "a null pointer");
    std::vector<double> column(unknown_count), result(sensitivity_count, 0.0);
    const bool with_states = component.mode != initialization;
    for (std::size_t k = 0; k < known_count; ++k) {
      component.instance.derivative(knowns[k], unknowns, unknown_count, with_states, column.data());
      for (std::size_t u = 0; u < unknown_count; ++u)
        result[adjoint ? k : u] += column[u] * seed[adjoint ? u : k];
    }
    std::ranges::copy(result, sensitivity);
    return ok;
  });
}

}  // namespace

HYDRAPOD_FMI int fmi3GetDirectionalDerivative(void* instance, const Reference unknowns[],
                                              std::size_t unknown_count, const Reference knowns[],
                                              std::size_t known_count, const double seed[],
                                              std::size_t seed_count, double sensitivity[],
                                              std::size_t sensitivity_count) {
  return derivative(instance, __func__, false, unknowns, unknown_count, knowns, known_count, seed,
                    seed_count, sensitivity, sensitivity_count);
}

HYDRAPOD_FMI int fmi3GetAdjointDerivative(void* instance, const Reference unknowns[],
                                          std::size_t unknown_count, const Reference knowns[],
                                          std::size_t known_count, const double seed[],
                                          std::size_t seed_count, double sensitivity[],
                                          std::size_t sensitivity_count) {
  return derivative(instance, __func__, true, unknowns, unknown_count, knowns, known_count, seed,
                    seed_count, sensitivity, sensitivity_count);
}

// ---- What the model description does not promise --------------------------------------------

HYDRAPOD_FMI int fmi3GetNumberOfVariableDependencies(void* instance, Reference, std::size_t*) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3GetVariableDependencies(void* instance, Reference, std::size_t[], Reference[],
                                             std::size_t[], int[], std::size_t) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3EnterConfigurationMode(void* instance) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3ExitConfigurationMode(void* instance) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3GetIntervalDecimal(void* instance, const Reference[], std::size_t, double[],
                                        int[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3GetIntervalFraction(void* instance, const Reference[], std::size_t,
                                         std::uint64_t[], std::uint64_t[], int[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3GetShiftDecimal(void* instance, const Reference[], std::size_t, double[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3GetShiftFraction(void* instance, const Reference[], std::size_t,
                                      std::uint64_t[], std::uint64_t[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3SetIntervalDecimal(void* instance, const Reference[], std::size_t,
                                        const double[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3SetIntervalFraction(void* instance, const Reference[], std::size_t,
                                         const std::uint64_t[], const std::uint64_t[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3SetShiftDecimal(void* instance, const Reference[], std::size_t,
                                     const double[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3SetShiftFraction(void* instance, const Reference[], std::size_t,
                                      const std::uint64_t[], const std::uint64_t[]) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3EnterStepMode(void* instance) { return not_provided(instance, __func__); }
HYDRAPOD_FMI int fmi3GetOutputDerivatives(void* instance, const Reference[], std::size_t,
                                          const std::int32_t[], double[], std::size_t) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3ActivateModelPartition(void* instance, Reference, double) {
  return not_provided(instance, __func__);
}

// ---- Events and model exchange --------------------------------------------------------------

HYDRAPOD_FMI int fmi3EvaluateDiscreteStates(void* instance) {
  return guarded(instance, initialization | event, __func__, [](Component&) { return ok; });
}

HYDRAPOD_FMI int fmi3UpdateDiscreteStates(void* instance, bool* need_update, bool* terminate,
                                          bool* nominals_changed, bool* values_changed,
                                          bool* next_time_defined, double* next_time) {
  return guarded(instance, event, __func__, [&](Component& component) {
    for (const bool* flag :
         {need_update, terminate, nominals_changed, values_changed, next_time_defined})
      require(flag != nullptr, "a null pointer");
    require(next_time != nullptr, "a null pointer");
    *need_update = *nominals_changed = *values_changed = *next_time_defined = false;
    *next_time = 0.0;
    *terminate = component.instance.has_ended();
    return ok;
  });
}

HYDRAPOD_FMI int fmi3EnterContinuousTimeMode(void* instance) {
  return guarded(instance, event, __func__, [](Component& component) {
    component.mode = continuous;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3CompletedIntegratorStep(void* instance, bool, bool* enter_event_mode,
                                             bool* terminate) {
  return guarded(instance, continuous, __func__, [&](Component& component) {
    require(enter_event_mode != nullptr && terminate != nullptr, "a null pointer");
    *enter_event_mode = false;
    *terminate = component.instance.has_ended();
    return ok;
  });
}

HYDRAPOD_FMI int fmi3SetTime(void* instance, double time) {
  return guarded(instance, of_exchange, __func__, [&](Component& component) {
    component.instance.set_time(time);
    return ok;
  });
}

HYDRAPOD_FMI int fmi3SetContinuousStates(void* instance, const double x[], std::size_t count) {
  return guarded(instance, continuous, __func__, [&](Component& component) {
    require(x != nullptr && count == static_cast<std::size_t>(component.instance.state_count()),
            "a null pointer, or another number of continuous states");
    component.instance.set_states(x);
    return ok;
  });
}

namespace {

constexpr unsigned looks_at_states = initialization | of_exchange | terminated;

/// What fills one of the lists of model exchange.
template <class Fill>
int list_of(void* handle, unsigned modes, const char* function, double* list, std::size_t count,
            bool of_states, const Fill& fill) {
  return guarded(handle, modes, function, [&](Component& component) {
    require(!component.co_simulation, "the instance is one of co-simulation");
    auto& instance = component.instance;
    const int expected = of_states ? instance.state_count() : instance.indicator_count();
    require((list != nullptr || count == 0) && count == static_cast<std::size_t>(expected),
            "a null pointer, or another number of values");
    fill(instance);
    return ok;
  });
}

int count_of(void* handle, const char* function, std::size_t* count, bool of_states) {
  return guarded(handle, any_mode & ~static_cast<unsigned>(failed), function,
                 [&](Component& component) {
                   require(count != nullptr, "a null pointer");
                   const auto& instance = component.instance;
                   *count = static_cast<std::size_t>(of_states ? instance.state_count()
                                                               : instance.indicator_count());
                   return ok;
                 });
}

}  // namespace

HYDRAPOD_FMI int fmi3GetContinuousStateDerivatives(void* instance, double rates[],
                                                   std::size_t count) {
  return list_of(instance, looks_at_states, __func__, rates, count, true,
                 [&](Instance& of) { of.derivatives(rates); });
}

HYDRAPOD_FMI int fmi3GetEventIndicators(void* instance, double values[], std::size_t count) {
  return list_of(instance, looks_at_states, __func__, values, count, false,
                 [&](Instance& of) { std::ranges::copy(of.indicators(), values); });
}

HYDRAPOD_FMI int fmi3GetContinuousStates(void* instance, double x[], std::size_t count) {
  return list_of(instance, looks_at_states, __func__, x, count, true, [&](Instance& of) {
    of.prepare_if_needed();
    std::ranges::copy(of.states(), x);
  });
}

HYDRAPOD_FMI int fmi3GetNominalsOfContinuousStates(void* instance, double nominals[],
                                                   std::size_t count) {
  return list_of(instance, looks_at_states, __func__, nominals, count, true,
                 [&](Instance& of) { std::ranges::copy(of.nominals(), nominals); });
}

HYDRAPOD_FMI int fmi3GetNumberOfEventIndicators(void* instance, std::size_t* count) {
  return count_of(instance, __func__, count, false);
}

HYDRAPOD_FMI int fmi3GetNumberOfContinuousStates(void* instance, std::size_t* count) {
  return count_of(instance, __func__, count, true);
}

// ---- Co-simulation --------------------------------------------------------------------------

HYDRAPOD_FMI int fmi3DoStep(void* instance, double from, double size, bool,
                            bool* event_handling_needed, bool* terminate, bool* early_return,
                            double* last_successful_time) {
  return guarded(instance, step_complete, __func__, [&](Component& component) -> int {
    require(event_handling_needed != nullptr && terminate != nullptr && early_return != nullptr &&
                last_successful_time != nullptr,
            "a null pointer");
    *event_handling_needed = *terminate = *early_return = false;
    std::string message;
    const bool whole = component.instance.step(from, size, message);
    *last_successful_time = component.instance.time();
    if (whole) return ok;
    *terminate = component.instance.has_ended();
    component.mode = step_failed;
    component.say(discard, "fmi3DoStep: " + message);
    return discard;
  });
}
