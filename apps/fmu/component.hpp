#pragma once
/// What both versions of the interface do alike: an instance with its place in the call sequence,
/// its messages, and statuses instead of exceptions.

#include <algorithm>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "instance.hpp"

namespace hydrapod::fmu {

/// The same numbers in FMI 2.0 and 3.0.
enum Status : int { ok = 0, warning = 1, discard = 2, error = 3, fatal = 4 };

/// Places in the call sequence, as bits.
enum Mode : unsigned {
  instantiated = 1U << 0U,
  initialization = 1U << 1U,
  event = 1U << 2U,
  continuous = 1U << 3U,
  step_complete = 1U << 4U,  ///< of co-simulation
  step_failed = 1U << 5U,    ///< the last step was not completed
  terminated = 1U << 6U,
  failed = 1U << 7U,  ///< after an error; another state, a reset and freeing are possible
  any_mode = (1U << 8U) - 1U
};
inline constexpr unsigned initialized =
    event | continuous | step_complete | step_failed | terminated;
/// Values can be asked for.
inline constexpr unsigned readable = initialization | initialized;

using Log = std::function<void(int status, const char* category, const std::string& message)>;

struct Component {
  Instance instance;
  bool co_simulation;
  std::string name;
  Log log;
  unsigned mode{instantiated};
  bool logging{};
  std::vector<std::string> categories{};  ///< that are wanted; empty: all

  /// Errors and discards are always said, unless their category was not asked for.
  void say(int status, const std::string& message) const {
    const char* category = status == discard ? "logStatusDiscard" : "logStatusError";
    const bool wanted = categories.empty() || std::ranges::count(categories, "logAll") > 0 ||
                        std::ranges::count(categories, category) > 0;
    if (log && wanted) log(status, category, message);
  }

  int fail(const std::string& message) {
    mode = failed;
    say(error, message);
    return error;
  }

  [[nodiscard]] bool may_set() const {
    return (mode & (instantiated | initialization | event | continuous | step_complete)) != 0;
  }
};

/// Runs `work`, which returns a status, where the component is in one of the modes.
template <class Work>
int guarded(void* handle, unsigned modes, const char* function, const Work& work) {
  if (handle == nullptr) return error;
  auto& component = *static_cast<Component*>(handle);
  if ((component.mode & modes) == 0)
    return component.fail(std::string(function) + ": not allowed here in the call sequence");
  try {
    return work(component);
  } catch (const Misuse& misuse) {
    return component.fail(std::string(function) + ": " + misuse.what());
  } catch (const std::bad_alloc&) {
    return component.fail(std::string(function) + ": no memory");
  } catch (const std::exception& exception) {
    const std::string message = std::string(function) + ": " + exception.what();
    if ((component.mode & (instantiated | initialization)) != 0) return component.fail(message);
    component.say(discard, message);
    return discard;
  }
}

inline void require(bool good, const char* what) {
  if (!good) throw Misuse(what);
}

inline void get_values(Component& component, const unsigned* references, std::size_t count,
                       double* values) {
  require(count == 0 || (references != nullptr && values != nullptr), "a null pointer");
  for (std::size_t k = 0; k < count; ++k) values[k] = component.instance.get(references[k]);
}

inline void set_values(Component& component, const unsigned* references, std::size_t count,
                       const double* values) {
  require(count == 0 || (references != nullptr && values != nullptr), "a null pointer");
  const bool late = (component.mode & (instantiated | initialization)) == 0;
  for (std::size_t k = 0; k < count; ++k) component.instance.set(references[k], values[k], late);
}

inline void* save(Component& component) {
  return new SavedState(component.instance.save(component.mode));
}

inline void restore(Component& component, const void* state) {
  require(state != nullptr, "a null pointer");
  const auto& saved = *static_cast<const SavedState*>(state);
  component.instance.restore(saved);
  component.mode = static_cast<unsigned>(saved.mode);
}

inline void* deserialized(Component& component, const char* bytes, std::size_t size) {
  require(bytes != nullptr, "a null pointer");
  auto state = SavedState::read(bytes, size, component.instance.save(0));
  const auto mode = state.mode;
  const bool one = mode > 0 && mode <= failed && (mode & (mode - 1)) == 0;
  const unsigned other = component.co_simulation ? unsigned{event | continuous}
                                                 : unsigned{step_complete | step_failed};
  require(one && (static_cast<unsigned>(mode) & other) == 0,
          "the state is of another kind of instance");
  return new SavedState(std::move(state));
}

inline void set_categories(Component& component, bool on, std::size_t count,
                           const char* const* categories) {
  require(count == 0 || categories != nullptr, "a null pointer");
  component.logging = on;
  component.categories.assign(categories, categories + count);
}

}  // namespace hydrapod::fmu
