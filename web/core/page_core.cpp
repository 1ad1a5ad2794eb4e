/// What the browser calls: texts come and go through memory that the module hands out.
///
///     const at = core.room(bytes);               // write JSON as UTF-8 there
///     core.open(bytes); core.compute(bytes); …   // 0: done, 1: refused; the answer, or why,
///     core.answer(), core.answer_size()          // stands here until the next call
///
/// Nothing is kept but the machine that was opened, the responses of the last one computed, and the
/// measured responses that poles are fitted to.

#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "core.hpp"
#include "measured_fit.hpp"

namespace {

using hydrapod::page::Core;
using hydrapod::page::MeasuredFit;
using hydrapod::report::Json;

std::string& asked() {
  static std::string text;
  return text;
}
std::string& answered() {
  static std::string text;
  return text;
}
std::optional<Core>& core() {
  static std::optional<Core> opened;
  return opened;
}
std::optional<MeasuredFit>& measured() {
  static std::optional<MeasuredFit> given;
  return given;
}
std::vector<double>& numbers() {
  static std::vector<double> values;
  return values;
}

template <class Work>
int answer(Work work) {
  try {
    answered() = work(Json::parse(asked())).dump();
    return 0;
  } catch (const std::exception& error) {
    answered() = error.what();
    return 1;
  }
}

}  // namespace

#define CORE_EXPORT extern "C" __attribute__((used, visibility("default")))

CORE_EXPORT char* core_room(int bytes) {
  asked().resize(static_cast<std::size_t>(bytes));
  return asked().data();
}
CORE_EXPORT const char* core_answer() { return answered().data(); }
CORE_EXPORT int core_answer_size() { return static_cast<int>(answered().size()); }

CORE_EXPORT int core_open() {
  return answer([](const Json& editable) { return core().emplace(editable).parameters(); });
}
CORE_EXPORT int core_compute() {
  return answer([](const Json& request) { return core().value().compute(request); });
}
CORE_EXPORT int core_buckling() {
  return answer([](const Json& request) { return core().value().buckling(request); });
}
CORE_EXPORT int core_sensitivities() {
  return answer([](const Json& request) { return core().value().sensitivities(request); });
}
CORE_EXPORT int core_reach() {
  return answer([](const Json& request) { return core().value().reach(request); });
}
/// Displacements stand where core_lines() says; core_map() puts rows in their place. The answer of
/// these three is how many numbers there are.
CORE_EXPORT int core_map() {
  return answer([](const Json& request) {
    numbers() = core().value().map(request, numbers());
    return Json(numbers().size());
  });
}
CORE_EXPORT int core_curves() {
  return answer([](const Json& request) {
    numbers() = core().value().curves(request);
    return Json(numbers().size());
  });
}
CORE_EXPORT int core_scatter() {
  return answer([](const Json& request) {
    numbers() = core().value().scatter(request);
    return Json(numbers().size());
  });
}

/// The numbers of MeasuredFit() stand where core_lines() says; there need not be a machine.
CORE_EXPORT int core_measured() {
  return answer([](const Json& shape) {
    measured().reset();
    measured().emplace(shape, numbers());
    return Json(nullptr);
  });
}
CORE_EXPORT int core_fit() {
  return answer([](const Json& request) {
    numbers() = measured().value().fit(request);
    return Json(numbers().size());
  });
}

/// Room for `lines` angular frequencies; core_sweep() puts the responses in their place.
CORE_EXPORT double* core_lines(int lines) {
  numbers().resize(static_cast<std::size_t>(lines));
  return numbers().data();
}
/// Number of values at the returned place: 144 a line, of direct responses 24, or 0.
CORE_EXPORT int core_sweep() {
  numbers() = core() ? core()->sweep(numbers()) : std::vector<double>{};
  return static_cast<int>(numbers().size());
}
CORE_EXPORT const double* core_numbers() { return numbers().data(); }
