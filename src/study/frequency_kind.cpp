/// A file of its own: the reports of `hydrapod demo` need it, and nothing else of studies.

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

std::string frequency_kind(const model::Machine& machine) {
  return model::has_elastomers(machine) ? "damped" : "undamped";
}

}  // namespace hydrapod::study
