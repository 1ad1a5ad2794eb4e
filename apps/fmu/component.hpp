#pragma once
/// What both versions of the interface do alike: an instance with its place in the call sequence,
/// its messages, and statuses instead of exceptions.

#include <functional>
#include <new>
#include <set>
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
  step_failed = 1U << 5U,    ///< FMI 2.0: the last step was not completed
  terminated = 1U << 6U,
  failed = 1U << 7U,        ///< after an error: values can be looked at, nothing goes on
  intermediate = 1U << 8U,  ///< FMI 3.0: within a step, in the callback
  any_mode = (1U << 9U) - 1U
};
inline constexpr unsigned between_calls = any_mode & ~unsigned{intermediate};
inline constexpr unsigned of_exchange = event | continuous;
inline constexpr unsigned initialized =
    of_exchange | step_complete | step_failed | terminated | failed;
/// Values can be asked for.
inline constexpr unsigned readable = initialization | initialized;

/// The categories of messages that the model description lists.
inline constexpr const char* discard_category = "logStatusDiscard";
inline constexpr const char* error_category = "logStatusError";

using Log = std::function<void(int status, const char* category, const std::string& message)>;

struct Component {
  Instance instance;
  bool co_simulation;
  std::string name;
  Log log;
  std::set<std::string> categories;  ///< that are wanted
  unsigned mode{instantiated};
  /// Of co-simulation in FMI 3.0.
  bool event_mode_used{}, early_return_allowed{};
  std::vector<unsigned> intermediate_variables{};
  std::function<std::optional<double>(double)> between{};  ///< see StepOptions

  /// Errors are always said; discards where they are wanted.
  void say(int status, const std::string& message) const {
    const char* category = status == discard ? discard_category : error_category;
    if (log && (status >= error || categories.contains(category))) log(status, category, message);
  }

  int fail(const std::string& message) {
    mode = failed;
    say(error, message);
    return error;
  }

  int refuse(const std::string& message) const {
    say(discard, message);
    return discard;
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
  } catch (const Refusal& refusal) {
    return component.refuse(std::string(function) + ": " + refusal.what());
  } catch (const Misuse& misuse) {
    return component.fail(std::string(function) + ": " + misuse.what());
  } catch (const std::bad_alloc&) {
    return component.fail(std::string(function) + ": no memory");
  } catch (const std::exception& exception) {
    const std::string message = std::string(function) + ": " + exception.what();
    if ((component.mode & (instantiated | initialization)) != 0) return component.fail(message);
    return component.refuse(message);
  }
}

inline void require(bool good, const char* what) {
  if (!good) throw Misuse(what);
}

}  // namespace hydrapod::fmu
