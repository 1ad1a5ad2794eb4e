#pragma once
/// Functions that FMI 2.0 and 3.0 have alike under other names. `function` is the name of the one
/// that is called, `modes` where it is allowed; a status is returned.

#include "component.hpp"

namespace hydrapod::fmu::calls {

/// A null pointer, with a message, where there can be no instance. `folder`: of the resources.
Component* instantiate(const char* function, const char* name, const char* token,
                       const std::function<std::string()>& folder, bool logging, bool co_simulation,
                       Log log);
/// On or off: the categories, or all where there are none.
int set_logging(void* handle, const char* function, bool on, std::size_t count,
                const char* const categories[]);

int exit_initialization(void* handle, const char* function);
/// To another place in the call sequence. `exchange`: of model exchange alone.
int enter(void* handle, unsigned modes, const char* function, Mode to, bool exchange = false);
int reset(void* handle, const char* function);

int get_values(void* handle, unsigned modes, const char* function, const unsigned references[],
               std::size_t count, double values[], std::size_t value_count);
/// Nothing is set where one of the values is refused. `states`: states may be set in event and
/// continuous-time mode of model exchange.
int set_values(void* handle, unsigned modes, const char* function, const unsigned references[],
               std::size_t count, const double values[], std::size_t value_count, bool states);
/// Of a type that no variable has.
int no_such_variables(void* handle, unsigned modes, const char* function, std::size_t count);

int get_state(void* handle, const char* function, void** state);
int set_state(void* handle, const char* function, void* state);
int free_state(void* handle, const char* function, void** state);
int state_size(void* handle, const char* function, void* state, std::size_t* size);
int serialize(void* handle, const char* function, void* state, char bytes[], std::size_t size);
int deserialize(void* handle, const char* function, const char bytes[], std::size_t size,
                void** state);

/// Unknowns and knowns as the standards name them.
struct Direction {
  const unsigned* unknowns{};
  std::size_t unknown_count{};
  const unsigned* knowns{};
  std::size_t known_count{};
  const double* seed{};
  double* sensitivity{};
};
/// Forward: sensitivity of each unknown, seeds of the knowns. Adjoint: the other way round.
int derivative(void* handle, const char* function, bool adjoint, const Direction& of);

int completed_step(void* handle, const char* function, bool* enter_event_mode, bool* terminate);
int set_time(void* handle, unsigned modes, const char* function, double time);
int set_states(void* handle, const char* function, const double x[], std::size_t count);

/// The lists of model exchange.
enum class List { states, rates, nominals, indicators };
int get_list(void* handle, unsigned modes, const char* function, List list, double values[],
             std::size_t count);

/// What event mode answers.
struct Update {
  bool terminate{};
  std::optional<double> next_time{};  ///< of the controller's next instant
};
int update_discrete_states(void* handle, const char* function, Update& update);

}  // namespace hydrapod::fmu::calls
