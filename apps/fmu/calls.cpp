#include "calls.hpp"

#include <algorithm>

namespace hydrapod::fmu::calls {

Component* instantiate(const char* function, const char* name, const char* token,
                       const std::function<std::string()>& folder, bool logging, bool co_simulation,
                       Log log) {
  const auto is_blank = [](const std::string& text) {
    return text.find_first_not_of(" \t\n") == std::string::npos;
  };
  try {
    require(name != nullptr && !is_blank(name), "the instance has no name");
    require(token != nullptr, "no token of the model description is given");
    std::set<std::string> categories;
    if (logging) categories = {discard_category, error_category};
    return new Component{Instance(folder(), token), co_simulation, name, log, categories};
  } catch (const std::exception& exception) {
    if (log) log(error, error_category, std::string(function) + ": " + exception.what());
    return nullptr;
  }
}

int set_logging(void* handle, const char* function, bool on, std::size_t count,
                const char* const categories[]) {
  return guarded(handle, any_mode, function, [&](Component& component) {
    require(count == 0 || categories != nullptr, "a null pointer");
    std::set<std::string> named;
    for (std::size_t k = 0; k < count; ++k) {
      require(categories[k] != nullptr, "a null pointer");
      named.insert(categories[k]);
    }
    const bool all = count == 0 || named.contains("logAll");
    for (const char* known : {discard_category, error_category}) {
      if (!all && !named.contains(known)) continue;
      if (on)
        component.categories.insert(known);
      else
        component.categories.erase(known);
    }
    return ok;
  });
}

int exit_initialization(void* handle, const char* function) {
  return guarded(handle, initialization, function, [](Component& component) {
    component.instance.prepare_if_needed();
    const bool steps = component.co_simulation && !component.event_mode_used;
    component.mode = steps ? step_complete : event;
    return ok;
  });
}

int enter(void* handle, unsigned modes, const char* function, Mode to, bool exchange) {
  return guarded(handle, modes, function, [&](Component& component) {
    require(!exchange || !component.co_simulation, "the instance is one of co-simulation");
    component.mode = to;
    return ok;
  });
}

int reset(void* handle, const char* function) {
  return guarded(handle, between_calls, function, [](Component& component) {
    component.instance.reset();
    component.mode = instantiated;
    return ok;
  });
}

namespace {

/// In the callback of a step only what was asked for at the start can be reached.
void require_reachable(const Component& component, const unsigned references[], std::size_t count) {
  if (component.mode != intermediate) return;
  for (std::size_t k = 0; k < count; ++k)
    require(std::ranges::count(component.intermediate_variables, references[k]) > 0,
            "the variable is not among the required intermediate variables");
}

}  // namespace

int get_values(void* handle, unsigned modes, const char* function, const unsigned references[],
               std::size_t count, double values[], std::size_t value_count) {
  return guarded(handle, modes, function, [&](Component& component) {
    require(count == value_count, "as many values as value references are expected");
    require(count == 0 || (references != nullptr && values != nullptr), "a null pointer");
    require_reachable(component, references, count);
    for (std::size_t k = 0; k < count; ++k) values[k] = component.instance.get(references[k]);
    return ok;
  });
}

int set_values(void* handle, unsigned modes, const char* function, const unsigned references[],
               std::size_t count, const double values[], std::size_t value_count, bool states) {
  return guarded(handle, modes, function, [&](Component& component) {
    require(count == value_count, "as many values as value references are expected");
    require(count == 0 || (references != nullptr && values != nullptr), "a null pointer");
    require_reachable(component, references, count);
    const unsigned mode = component.mode;
    Settable settable;
    settable.fixed = (mode & (instantiated | initialization)) != 0;
    settable.tunable = settable.fixed || (mode & (event | step_complete)) != 0;
    settable.states = states && !component.co_simulation && (mode & of_exchange) != 0;
    component.instance.set(references, count, values, settable);
    return ok;
  });
}

int no_such_variables(void* handle, unsigned modes, const char* function, std::size_t count) {
  return guarded(handle, modes, function, [&](Component&) {
    require(count == 0, "the FMU has no variables of this type");
    return ok;
  });
}

int get_state(void* handle, const char* function, void** state) {
  return guarded(handle, between_calls, function, [&](Component& component) {
    require(state != nullptr, "a null pointer");
    auto* now = new SavedState(component.instance.save(component.mode));
    delete static_cast<SavedState*>(*state);
    *state = now;
    return ok;
  });
}

int set_state(void* handle, const char* function, void* state) {
  return guarded(handle, between_calls, function, [&](Component& component) {
    require(state != nullptr, "a null pointer");
    const auto& saved = *static_cast<const SavedState*>(state);
    component.instance.restore(saved);
    component.mode = static_cast<unsigned>(saved.mode);
    return ok;
  });
}

int free_state(void* handle, const char* function, void** state) {
  return guarded(handle, between_calls, function, [&](Component&) {
    if (state == nullptr) return ok;
    delete static_cast<SavedState*>(*state);
    *state = nullptr;
    return ok;
  });
}

int state_size(void* handle, const char* function, void* state, std::size_t* size) {
  return guarded(handle, between_calls, function, [&](Component&) {
    require(state != nullptr && size != nullptr, "a null pointer");
    *size = static_cast<SavedState*>(state)->bytes();
    return ok;
  });
}

int serialize(void* handle, const char* function, void* state, char bytes[], std::size_t size) {
  return guarded(handle, between_calls, function, [&](Component&) {
    require(state != nullptr && bytes != nullptr, "a null pointer");
    const auto& saved = *static_cast<SavedState*>(state);
    require(size >= saved.bytes(), "too few bytes for the serialized state");
    saved.write(bytes);
    return ok;
  });
}

int deserialize(void* handle, const char* function, const char bytes[], std::size_t size,
                void** state) {
  return guarded(handle, between_calls, function, [&](Component& component) {
    require(state != nullptr && bytes != nullptr, "a null pointer");
    auto read = SavedState::read(bytes, size, component.instance.save(0));
    const auto mode = read.mode;
    const bool one = mode > 0 && mode < intermediate && (mode & (mode - 1)) == 0;
    const unsigned other = component.co_simulation
                               ? continuous | (component.event_mode_used ? 0U : unsigned{event})
                               : unsigned{step_complete | step_failed};
    require(one && (static_cast<unsigned>(mode) & other) == 0,
            "the state is of another kind of instance");
    auto* made = new SavedState(std::move(read));
    delete static_cast<SavedState*>(*state);
    *state = made;
    return ok;
  });
}

int derivative(void* handle, const char* function, bool adjoint, const Direction& of) {
  return guarded(handle, readable, function, [&](Component& component) {
    require((of.unknowns != nullptr && (adjoint ? of.seed : of.sensitivity) != nullptr) ||
                of.unknown_count == 0,
            "a null pointer");
    require((of.knowns != nullptr && (adjoint ? of.sensitivity : of.seed) != nullptr) ||
                of.known_count == 0,
            "a null pointer");
    std::vector<double> column(of.unknown_count),
        result(adjoint ? of.known_count : of.unknown_count, 0.0);
    const bool with_states = component.mode != initialization;
    for (std::size_t k = 0; k < of.known_count; ++k) {
      component.instance.derivative(of.knowns[k], of.unknowns, of.unknown_count, with_states,
                                    column.data());
      for (std::size_t u = 0; u < of.unknown_count; ++u)
        result[adjoint ? k : u] += column[u] * of.seed[adjoint ? u : k];
    }
    std::ranges::copy(result, of.sensitivity);
    return ok;
  });
}

int completed_step(void* handle, const char* function, bool* enter_event_mode, bool* terminate) {
  return guarded(handle, continuous, function, [&](Component& component) {
    require(enter_event_mode != nullptr && terminate != nullptr, "a null pointer");
    *enter_event_mode = false;
    *terminate = component.instance.has_ended();
    return ok;
  });
}

int set_time(void* handle, unsigned modes, const char* function, double time) {
  return guarded(handle, modes, function, [&](Component& component) {
    require(!component.co_simulation, "the instance is one of co-simulation");
    component.instance.set_time(time);
    return ok;
  });
}

int set_states(void* handle, const char* function, const double x[], std::size_t count) {
  return guarded(handle, continuous, function, [&](Component& component) {
    require(x != nullptr && count == static_cast<std::size_t>(component.instance.state_count()),
            "a null pointer, or another number of continuous states");
    component.instance.set_states(x);
    return ok;
  });
}

int get_list(void* handle, unsigned modes, const char* function, List list, double values[],
             std::size_t count) {
  return guarded(handle, modes, function, [&](Component& component) {
    require(!component.co_simulation, "the instance is one of co-simulation");
    auto& instance = component.instance;
    const int expected =
        list == List::indicators ? instance.indicator_count() : instance.state_count();
    require((values != nullptr || count == 0) && count == static_cast<std::size_t>(expected),
            "a null pointer, or another number of values");
    switch (list) {
      case List::states:
        instance.prepare_if_needed();
        std::ranges::copy(instance.states(), values);
        break;
      case List::rates:
        instance.derivatives(values);
        break;
      case List::nominals:
        std::ranges::copy(instance.nominals(), values);
        break;
      case List::indicators:
        std::ranges::copy(instance.indicators(), values);
        break;
    }
    return ok;
  });
}

int update_discrete_states(void* handle, const char* function, Update& update) {
  return guarded(handle, event, function, [&](Component& component) {
    update.next_time = component.instance.update_discrete_states(!component.co_simulation);
    update.terminate = component.instance.has_ended();
    return ok;
  });
}

}  // namespace hydrapod::fmu::calls
