/// The interface of FMI 3.0 (chapters 2 to 4). There are no clocks, no structural parameters and no
/// scheduled execution: their functions answer by an error.

#include <cstdint>

#include "calls.hpp"

#define HYDRAPOD_FMI extern "C" __attribute__((visibility("default")))

namespace {

using namespace hydrapod::fmu;

using Reference = std::uint32_t;
using LogMessage = void (*)(void* environment, int status, const char* category,
                            const char* message);
using IntermediateUpdate = void (*)(void* environment, double time, bool set_requested,
                                    bool get_allowed, bool step_finished, bool can_return_early,
                                    bool* early_return_requested, double* early_return_time);

constexpr unsigned settable =
    instantiated | initialization | of_exchange | step_complete | intermediate;
constexpr unsigned looks_at_states = initialization | of_exchange | terminated | failed;

Log log_of(void* environment, LogMessage log_message) {
  if (log_message == nullptr) return {};
  return [=](int status, const char* category, const std::string& message) {
    log_message(environment, status, category, message.c_str());
  };
}

Component* instantiate(const char* function, const char* name, const char* token,
                       const char* resources, bool logging, bool co_simulation, Log log) {
  const auto folder = [&] {
    require(resources != nullptr, "the FMU needs the path of its resources");
    return std::string(resources);
  };
  return calls::instantiate(function, name, token, folder, logging, co_simulation, std::move(log));
}

int no_variables(void* instance, const char* function, std::size_t count) {
  return calls::no_such_variables(instance, readable | instantiated, function, count);
}

int not_provided(void* instance, const char* function) {
  return guarded(instance, any_mode, function, [&](Component&) -> int {
    throw Misuse("the FMU does not provide it, see its model description");
  });
}

/// Each of them an input or an output that the model description allows there.
void require_intermediate(const Component& component, const std::vector<unsigned>& references) {
  for (const auto reference : references)
    require(component.instance.is_intermediate(reference),
            "a required intermediate variable has no intermediateUpdate in the model description");
}

/// What happens between the parts of a step: the callback, in a mode of its own.
std::function<std::optional<double>(double)> between_parts(Component* component, void* environment,
                                                           IntermediateUpdate update) {
  return [=](double time) -> std::optional<double> {
    bool requested = false;
    double until = time;
    const bool early = component->early_return_allowed;
    component->mode = intermediate;
    update(environment, time, true, true, true, early, &requested, &until);
    if (component->mode != intermediate)
      throw Misuse("a call within the intermediate update failed");
    component->mode = step_complete;
    if (!early || !requested) return std::nullopt;
    return until;
  };
}

}  // namespace

HYDRAPOD_FMI const char* fmi3GetVersion() { return "3.0"; }

HYDRAPOD_FMI int fmi3SetDebugLogging(void* instance, bool on, std::size_t count,
                                     const char* const categories[]) {
  return calls::set_logging(instance, __func__, on, count, categories);
}

HYDRAPOD_FMI void* fmi3InstantiateModelExchange(const char* name, const char* token,
                                                const char* resources, bool, bool logging,
                                                void* environment, LogMessage log_message) {
  return instantiate(__func__, name, token, resources, logging, false,
                     log_of(environment, log_message));
}

HYDRAPOD_FMI void* fmi3InstantiateCoSimulation(const char* name, const char* token,
                                               const char* resources, bool, bool logging,
                                               bool event_mode_used, bool early_return_allowed,
                                               const Reference required[],
                                               std::size_t required_count, void* environment,
                                               LogMessage log_message, IntermediateUpdate update) {
  const auto log = log_of(environment, log_message);
  auto* made = instantiate(__func__, name, token, resources, logging, true, log);
  if (made == nullptr) return nullptr;
  made->event_mode_used = event_mode_used;
  made->early_return_allowed = early_return_allowed;
  if (update == nullptr) return made;
  try {
    require(required_count == 0 || required != nullptr, "a null pointer");
    if (required_count > 0)
      made->intermediate_variables.assign(required, required + required_count);
    require_intermediate(*made, made->intermediate_variables);
  } catch (const std::exception& exception) {
    made->say(error, std::string(__func__) + ": " + exception.what());
    delete made;
    return nullptr;
  }
  made->between = between_parts(made, environment, update);
  return made;
}

HYDRAPOD_FMI void* fmi3InstantiateScheduledExecution(const char*, const char*, const char*, bool,
                                                     bool, void* environment,
                                                     LogMessage log_message, void (*)(), void (*)(),
                                                     void (*)()) {
  if (log_message != nullptr)
    log_message(environment, error, error_category,
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
  return calls::exit_initialization(instance, __func__);
}

HYDRAPOD_FMI int fmi3EnterEventMode(void* instance) {
  return guarded(instance, continuous | step_complete, __func__, [](Component& component) {
    require(!component.co_simulation || component.event_mode_used,
            "the instance was made without an event mode");
    component.mode = event;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3Terminate(void* instance) {
  return calls::enter(instance, of_exchange | step_complete, __func__, terminated);
}
HYDRAPOD_FMI int fmi3Reset(void* instance) { return calls::reset(instance, __func__); }

// ---- Values ---------------------------------------------------------------------------------

HYDRAPOD_FMI int fmi3GetFloat64(void* instance, const Reference references[], std::size_t count,
                                double values[], std::size_t value_count) {
  return calls::get_values(instance, readable | instantiated | intermediate, __func__, references,
                           count, values, value_count);
}

HYDRAPOD_FMI int fmi3SetFloat64(void* instance, const Reference references[], std::size_t count,
                                const double values[], std::size_t value_count) {
  return calls::set_values(instance, settable, __func__, references, count, values, value_count,
                           true);
}

#define HYDRAPOD_NO_VARIABLES(Type, Value)                                                      \
  HYDRAPOD_FMI int fmi3Get##Type(void* instance, const Reference[], std::size_t count, Value[], \
                                 std::size_t) {                                                 \
    return no_variables(instance, __func__, count);                                             \
  }                                                                                             \
  HYDRAPOD_FMI int fmi3Set##Type(void* instance, const Reference[], std::size_t count,          \
                                 const Value[], std::size_t) {                                  \
    return no_variables(instance, __func__, count);                                             \
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
  return no_variables(instance, __func__, count);
}
HYDRAPOD_FMI int fmi3SetBinary(void* instance, const Reference[], std::size_t count,
                               const std::size_t[], const std::uint8_t* const[], std::size_t) {
  return no_variables(instance, __func__, count);
}
HYDRAPOD_FMI int fmi3GetClock(void* instance, const Reference[], std::size_t count, bool[]) {
  return no_variables(instance, __func__, count);
}
HYDRAPOD_FMI int fmi3SetClock(void* instance, const Reference[], std::size_t count, const bool[]) {
  return no_variables(instance, __func__, count);
}

// ---- State and derivatives ------------------------------------------------------------------

HYDRAPOD_FMI int fmi3GetFMUState(void* instance, void** state) {
  return calls::get_state(instance, __func__, state);
}
HYDRAPOD_FMI int fmi3SetFMUState(void* instance, void* state) {
  return calls::set_state(instance, __func__, state);
}
HYDRAPOD_FMI int fmi3FreeFMUState(void* instance, void** state) {
  return calls::free_state(instance, __func__, state);
}
HYDRAPOD_FMI int fmi3SerializedFMUStateSize(void* instance, void* state, std::size_t* size) {
  return calls::state_size(instance, __func__, state, size);
}
HYDRAPOD_FMI int fmi3SerializeFMUState(void* instance, void* state, std::uint8_t bytes[],
                                       std::size_t size) {
  return calls::serialize(instance, __func__, state, reinterpret_cast<char*>(bytes), size);
}
HYDRAPOD_FMI int fmi3DeserializeFMUState(void* instance, const std::uint8_t bytes[],
                                         std::size_t size, void** state) {
  return calls::deserialize(instance, __func__, reinterpret_cast<const char*>(bytes), size, state);
}

namespace {

int derivative(void* instance, const char* function, bool adjoint, const calls::Direction& of,
               std::size_t seed_count, std::size_t sensitivity_count) {
  const bool fit = seed_count == (adjoint ? of.unknown_count : of.known_count) &&
                   sensitivity_count == (adjoint ? of.known_count : of.unknown_count);
  if (fit) return calls::derivative(instance, function, adjoint, of);
  return guarded(instance, readable, function, [](Component&) -> int {
    throw Misuse("seeds and sensitivities do not go with knowns and unknowns");
  });
}

}  // namespace

HYDRAPOD_FMI int fmi3GetDirectionalDerivative(void* instance, const Reference unknowns[],
                                              std::size_t unknown_count, const Reference knowns[],
                                              std::size_t known_count, const double seed[],
                                              std::size_t seed_count, double sensitivity[],
                                              std::size_t sensitivity_count) {
  return derivative(instance, __func__, false,
                    {unknowns, unknown_count, knowns, known_count, seed, sensitivity}, seed_count,
                    sensitivity_count);
}

HYDRAPOD_FMI int fmi3GetAdjointDerivative(void* instance, const Reference unknowns[],
                                          std::size_t unknown_count, const Reference knowns[],
                                          std::size_t known_count, const double seed[],
                                          std::size_t seed_count, double sensitivity[],
                                          std::size_t sensitivity_count) {
  return derivative(instance, __func__, true,
                    {unknowns, unknown_count, knowns, known_count, seed, sensitivity}, seed_count,
                    sensitivity_count);
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
HYDRAPOD_FMI int fmi3GetOutputDerivatives(void* instance, const Reference[], std::size_t,
                                          const std::int32_t[], double[], std::size_t) {
  return not_provided(instance, __func__);
}
HYDRAPOD_FMI int fmi3ActivateModelPartition(void* instance, Reference, double) {
  return not_provided(instance, __func__);
}

HYDRAPOD_FMI int fmi3EvaluateDiscreteStates(void* instance) {
  return not_provided(instance, __func__);
}

// ---- Events and model exchange --------------------------------------------------------------

HYDRAPOD_FMI int fmi3UpdateDiscreteStates(void* instance, bool* need_update, bool* terminate,
                                          bool* nominals_changed, bool* values_changed,
                                          bool* next_time_defined, double* next_time) {
  const bool given = need_update != nullptr && terminate != nullptr &&
                     nominals_changed != nullptr && values_changed != nullptr &&
                     next_time_defined != nullptr && next_time != nullptr;
  if (!given)
    return guarded(instance, event, __func__,
                   [](Component&) -> int { throw Misuse("a null pointer"); });
  calls::Update update;
  const int status = calls::update_discrete_states(instance, __func__, update);
  *need_update = *nominals_changed = *values_changed = false;
  *terminate = update.terminate;
  *next_time_defined = update.next_time.has_value();
  *next_time = update.next_time.value_or(0.0);
  return status;
}

HYDRAPOD_FMI int fmi3EnterContinuousTimeMode(void* instance) {
  return calls::enter(instance, event, __func__, continuous, true);
}

HYDRAPOD_FMI int fmi3EnterStepMode(void* instance) {
  return guarded(instance, event, __func__, [](Component& component) {
    require(component.co_simulation, "the instance is one of model exchange");
    component.mode = step_complete;
    return ok;
  });
}

HYDRAPOD_FMI int fmi3CompletedIntegratorStep(void* instance, bool, bool* enter_event_mode,
                                             bool* terminate) {
  return calls::completed_step(instance, __func__, enter_event_mode, terminate);
}
HYDRAPOD_FMI int fmi3SetTime(void* instance, double time) {
  return calls::set_time(instance, continuous, __func__, time);
}
HYDRAPOD_FMI int fmi3SetContinuousStates(void* instance, const double x[], std::size_t count) {
  return calls::set_states(instance, __func__, x, count);
}
HYDRAPOD_FMI int fmi3GetContinuousStateDerivatives(void* instance, double rates[],
                                                   std::size_t count) {
  return calls::get_list(instance, looks_at_states, __func__, calls::List::rates, rates, count);
}
HYDRAPOD_FMI int fmi3GetEventIndicators(void* instance, double values[], std::size_t count) {
  return calls::get_list(instance, looks_at_states, __func__, calls::List::indicators, values,
                         count);
}
HYDRAPOD_FMI int fmi3GetContinuousStates(void* instance, double x[], std::size_t count) {
  return calls::get_list(instance, looks_at_states, __func__, calls::List::states, x, count);
}
HYDRAPOD_FMI int fmi3GetNominalsOfContinuousStates(void* instance, double nominals[],
                                                   std::size_t count) {
  return calls::get_list(instance, looks_at_states, __func__, calls::List::nominals, nominals,
                         count);
}

namespace {

int count_of(void* handle, const char* function, std::size_t* count, bool of_states) {
  constexpr unsigned allowed = instantiated | initialization | of_exchange;
  return guarded(handle, allowed, function, [&](Component& component) {
    require(!component.co_simulation, "the instance is one of co-simulation");
    require(count != nullptr, "a null pointer");
    const auto& instance = component.instance;
    *count =
        static_cast<std::size_t>(of_states ? instance.state_count() : instance.indicator_count());
    return ok;
  });
}

}  // namespace

HYDRAPOD_FMI int fmi3GetNumberOfEventIndicators(void* instance, std::size_t* count) {
  return count_of(instance, __func__, count, false);
}
HYDRAPOD_FMI int fmi3GetNumberOfContinuousStates(void* instance, std::size_t* count) {
  return count_of(instance, __func__, count, true);
}

// ---- Co-simulation --------------------------------------------------------------------------

namespace {

/// What fmi3DoStep answers beside the status.
struct Answer {
  bool *event_handling_needed, *terminate, *early_return;
  double* last_successful_time;
};

/// A step within which the model ends is returned early where that is allowed. Another one that
/// cannot be completed is discarded, and the instance is what it was before.
int do_step(Component& component, double from, double size, const Answer& answer) {
  const bool early = component.early_return_allowed;
  const auto before = component.instance.save(0);
  try {
    const auto result = component.instance.step(
        from, size, {.stops_at_events = early, .between = component.between});
    *answer.last_successful_time = component.instance.time();
    *answer.event_handling_needed = result.event && component.event_mode_used;
    *answer.early_return = result.early;
    if (result.whole) return ok;
    *answer.terminate = early && component.instance.has_ended();
    if (*answer.terminate) return ok;
    *answer.early_return = false;
    component.instance.restore(before);
    *answer.last_successful_time = component.instance.time();
    return component.refuse("fmi3DoStep: " + result.message);
  } catch (...) {
    component.instance.restore(before);
    throw;
  }
}

}  // namespace

HYDRAPOD_FMI int fmi3DoStep(void* instance, double from, double size, bool,
                            bool* event_handling_needed, bool* terminate, bool* early_return,
                            double* last_successful_time) {
  return guarded(instance, step_complete, __func__, [&](Component& component) -> int {
    require(event_handling_needed != nullptr && terminate != nullptr && early_return != nullptr &&
                last_successful_time != nullptr,
            "a null pointer");
    *event_handling_needed = *terminate = *early_return = false;
    return do_step(component, from, size,
                   {event_handling_needed, terminate, early_return, last_successful_time});
  });
}
