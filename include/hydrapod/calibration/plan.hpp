#pragma once
/// What a calibration may change, and what it is to compare.

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hydrapod::calibration {

/// A number [SI], or a quantity as somebody wrote it, "12 kg", in a unit of the path it is meant
/// for.
using Amount = std::variant<double, std::string>;

/// Knowledge about a parameter besides the data: Gaussian, value ± spread.
struct PriorAmounts {
  Amount value{};
  Amount spread{};  ///< > 0
};

/// Where something was asked for.
struct Origin {
  std::string file{};  ///< or the argument: `--free legs.rod.mass`
  unsigned line{};
  unsigned column{};
};

/// A number of the machine file that the fit may change; several paths are tied to one value.
struct FreeParameter {
  std::vector<std::string> paths{};
  std::optional<Amount> start{};  ///< default: the value in the file
  std::optional<Amount> lower{};  ///< default: a tenth of the start
  std::optional<Amount> upper{};  ///< default: ten times the start
  std::optional<PriorAmounts> prior{};
  Origin origin{};
};

/// One of several things that may be true of a machine, as overrides `PATH=VALUE` of its file.
struct Choice {
  std::string name{};
  std::vector<std::string> overrides{};
};

/// Choices of which one is true; every combination of all alternatives is fitted.
struct Alternative {
  std::string name{};
  std::vector<Choice> choices{};
  Origin origin{};
};

enum class Loss {
  automatic,  ///< squares; where single targets lie far off the others, Cauchy
  squares,
  cauchy  ///< a target off by many deviations pulls little
};

struct FitOptions {
  int starts{8};          ///< per combination, the first at the start values, the others at random
  std::uint64_t seed{1};  ///< of the random starts
  /// Starts that go on after `trial_iterations`: those of least cost that differ; 0: all do.
  int kept{};
  int trial_iterations{10};
  Loss loss{Loss::automatic};
  int max_iterations{200};
  double tolerance{1e-9};  ///< relative change of the cost that ends a fit
  int threads{0};          ///< 0: as many as there are processors; results do not depend on it
};

struct Plan {
  std::vector<FreeParameter> free{};
  std::vector<Alternative> alternatives{};
  FitOptions options{};
};

}  // namespace hydrapod::calibration
