/// modelDescription.xml after FMI 2.0 (chapters 2.2, 3.3, 4.3) and FMI 3.0 (2.4, 3.3, 4.3).

#include "fmu_description.hpp"

#include <fmt/format.h>

#include <set>

namespace hydrapod::exchange {

namespace {

constexpr double suggested_stop = 10.0, suggested_step = 1e-3, suggested_tolerance = 1e-6;

bool is_fmi3(const FmuContent& fmu) { return fmu.version == FmuVersion::fmi3; }

/// ` name="value"`.
std::string attribute(std::string_view name, std::string_view value) {
  return fmt::format(" {}=\"{}\"", name, escaped(value));
}
std::string attribute(std::string_view name, const std::optional<double>& value) {
  return value ? fmt::format(" {}=\"{}\"", name, *value) : std::string();
}

/// FMI 2.0 has event indicators by their number alone.
bool is_listed(const FmuContent& fmu, const FmuVariable& variable) {
  return is_fmi3(fmu) || variable.role != FmuRole::indicator;
}

/// In FMI 2.0 a variable is referred to by its place in the list, in 3.0 by its value reference.
std::vector<int> places(const FmuContent& fmu) {
  std::vector<int> result;
  int place = 0;
  for (const auto& variable : fmu.interface.variables) {
    if (is_listed(fmu, variable)) ++place;
    result.push_back(is_fmi3(fmu) ? static_cast<int>(result.size()) : place);
  }
  return result;
}

/// FMI 2.0 lists them in the model description, FMI 3.0 in the build description.
std::string source_files(const FmuContent& fmu) {
  std::string files;
  for (const auto& [name, text] : fmu.sources)
    if (is_compiled(name)) files += fmt::format("      <File{}/>\n", attribute("name", name));
  return files.empty() ? files : "    <SourceFiles>\n" + files + "    </SourceFiles>\n";
}

std::string interfaces(const FmuContent& fmu) {
  const std::string identifier = attribute("modelIdentifier", fmu.identifier);
  if (is_fmi3(fmu)) {
    const std::string common =
        identifier +
        R"( canGetAndSetFMUState="true" canSerializeFMUState="true" providesDirectionalDerivatives="true")"
        R"( providesAdjointDerivatives="true")";
    return fmt::format(
        "  <ModelExchange{}/>\n"
        "  <CoSimulation{} canHandleVariableCommunicationStepSize=\"true\" "
        "hasEventMode=\"true\" mightReturnEarlyFromDoStep=\"true\" "
        "providesIntermediateUpdate=\"true\" canReturnEarlyAfterIntermediateUpdate=\"true\"/>\n",
        common, common);
  }
  const std::string common =
      identifier + R"( canNotUseMemoryManagementFunctions="true" canGetAndSetFMUstate="true")"
                   R"( canSerializeFMUstate="true" providesDirectionalDerivative="true")";
  const auto files = source_files(fmu);
  return fmt::format(
      "  <ModelExchange{0} completedIntegratorStepNotNeeded=\"true\">\n{1}  </ModelExchange>\n"
      "  <CoSimulation{0} canHandleVariableCommunicationStepSize=\"true\">\n{1}"
      "  </CoSimulation>\n",
      common, files);
}

std::string units(const FmuContent& fmu) {
  std::set<std::string> names;
  for (const auto& variable : fmu.interface.variables) names.insert(variable.unit);
  std::string text = "  <UnitDefinitions>\n";
  for (const auto& name : names) {
    const auto powers = fmu_unit(name);
    std::string bases;
    const auto add = [&](const char* base, int power) {
      if (power != 0) bases += fmt::format(" {}=\"{}\"", base, power);
    };
    add("kg", powers.kg);
    add("m", powers.m);
    add("s", powers.s);
    add("rad", powers.rad);
    text += fmt::format("    <Unit{}><BaseUnit{}/></Unit>\n", attribute("name", name), bases);
  }
  return text + "  </UnitDefinitions>\n";
}

std::string causality(const FmuVariable& variable) {
  switch (variable.role) {
    case FmuRole::time:
      return R"( causality="independent" variability="continuous")";
    case FmuRole::input:
      return R"( causality="input" variability="continuous")";
    case FmuRole::parameter:
      return fmt::format(R"( causality="parameter" variability="{}" initial="exact")",
                         variable.tunable ? "tunable" : "fixed");
    case FmuRole::drive:
      return R"( causality="output" variability="discrete" initial="calculated")";
    case FmuRole::output:
      return R"( causality="output" variability="continuous" initial="calculated")";
    default:
      return fmt::format(R"( causality="{}" variability="continuous" initial="calculated")",
                         variable.is_output ? "output" : "local");
  }
}

std::string numbers(const FmuContent& fmu, const FmuVariable& variable,
                    const std::vector<int>& place) {
  std::string text = attribute("unit", variable.unit) + attribute("min", variable.low) +
                     attribute("max", variable.high) + attribute("nominal", variable.nominal) +
                     attribute("start", variable.start);
  if (variable.role != FmuRole::derivative) return text;
  const auto state = static_cast<std::size_t>(fmu.interface.first(FmuRole::state) + variable.index);
  return text + fmt::format(" derivative=\"{}\"", place[state]);
}

std::string variables(const FmuContent& fmu, const std::vector<int>& place) {
  std::string text = "  <ModelVariables>\n";
  std::size_t reference = 0;
  for (const auto& variable : fmu.interface.variables) {
    const std::string common = attribute("name", variable.name) +
                               fmt::format(" valueReference=\"{}\"", reference++) +
                               attribute("description", variable.description) + causality(variable);
    if (!is_listed(fmu, variable)) continue;
    const auto values = numbers(fmu, variable, place);
    const char* intermediate = variable.is_intermediate() ? " intermediateUpdate=\"true\"" : "";
    text += is_fmi3(fmu)
                ? fmt::format("    <Float64{}{}{}/>\n", common, intermediate, values)
                : fmt::format("    <ScalarVariable{}><Real{}/></ScalarVariable>\n", common, values);
  }
  return text + "  </ModelVariables>\n";
}

/// An element of the model structure. With `dependencies`, those of derivatives and outputs.
std::string unknown(const FmuContent& fmu, const std::vector<int>& place, int variable,
                    std::string_view element, bool dependencies) {
  const auto* key = is_fmi3(fmu) ? "valueReference" : "index";
  std::string on, kinds;
  if (dependencies)
    for (const auto& one : fmu_dependencies(fmu.interface, fmu.plant, variable)) {
      const char* gap = on.empty() ? "" : " ";
      on += fmt::format("{}{}", gap, place[static_cast<std::size_t>(one.variable)]);
      kinds += fmt::format("{}{}", gap, one.constant ? "constant" : "dependent");
    }
  std::string text =
      fmt::format("<{} {}=\"{}\"", element, key, place[static_cast<std::size_t>(variable)]);
  if (dependencies) text += fmt::format(" dependencies=\"{}\"", on);
  if (!on.empty()) text += fmt::format(" dependenciesKind=\"{}\"", kinds);
  return "    " + text + "/>\n";
}

struct Unknowns {
  std::string outputs{}, derivatives{}, initial{}, indicators{};
};

/// What is unknown at first depends on all parameters, by the rest of the machine. The drives of
/// the controller depend on all that it measures and is commanded.
Unknowns unknowns(const FmuContent& fmu, const std::vector<int>& place) {
  const bool three = is_fmi3(fmu);
  Unknowns found;
  for (std::size_t k = 0; k < fmu.interface.variables.size(); ++k) {
    const auto& variable = fmu.interface.variables[k];
    const int at = static_cast<int>(k);
    const bool is_output = variable.role == FmuRole::output || variable.is_output;
    const bool is_derivative = variable.role == FmuRole::derivative;
    const auto add = [&](std::string& list, const char* name, bool dependencies) {
      list += unknown(fmu, place, at, three ? name : "Unknown", dependencies);
    };
    const bool is_drive = variable.role == FmuRole::drive;
    if (is_output || is_drive) add(found.outputs, "Output", !is_drive);
    if (is_derivative) add(found.derivatives, "ContinuousStateDerivative", true);
    if (is_output || is_drive || is_derivative || variable.role == FmuRole::state)
      add(found.initial, "InitialUnknown", false);
    if (variable.role == FmuRole::indicator) add(found.indicators, "EventIndicator", true);
  }
  return found;
}

std::string structure(const FmuContent& fmu, const std::vector<int>& place) {
  const auto found = unknowns(fmu, place);
  if (is_fmi3(fmu))
    return "  <ModelStructure>\n" + found.outputs + found.derivatives + found.initial +
           found.indicators + "  </ModelStructure>\n";
  return fmt::format(
      "  <ModelStructure>\n  <Outputs>\n{}  </Outputs>\n  <Derivatives>\n{}  </Derivatives>\n"
      "  <InitialUnknowns>\n{}  </InitialUnknowns>\n  </ModelStructure>\n",
      found.outputs, found.derivatives, found.initial);
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result;
}

std::string fmu_description(const FmuContent& fmu) {
  const auto place = places(fmu);
  std::string head = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"{}\"",
      is_fmi3(fmu) ? "3.0" : "2.0");
  head +=
      attribute("modelName", fmu.title) +
      attribute(is_fmi3(fmu) ? "instantiationToken" : "guid", fmu.machine.token) +
      attribute("description",
                fmu.machine.drives() ? "electric hexapod: mechanics, screws, motors, speed loops"
                : fmu.machine.hydraulics ? "hydraulic hexapod: mechanics, chambers, valves, supply"
                                         : "hexapod: mechanics moved by axial forces in the legs") +
      attribute("generationTool", "hydrapod") + attribute("variableNamingConvention", "structured");
  if (!is_fmi3(fmu))
    head += fmt::format(" numberOfEventIndicators=\"{}\"", fmu.interface.indicators.size());
  return head + ">\n" + interfaces(fmu) + units(fmu) +
         "  <LogCategories>\n"
         "    <Category name=\"logStatusDiscard\" description=\"states that cannot be\"/>\n"
         "    <Category name=\"logStatusError\" description=\"calls that are not allowed\"/>\n"
         "  </LogCategories>\n" +
         fmt::format(
             "  <DefaultExperiment startTime=\"0\" stopTime=\"{}\" tolerance=\"{}\" "
             "stepSize=\"{}\"/>\n",
             suggested_stop, suggested_tolerance, suggested_step) +
         variables(fmu, place) + structure(fmu, place) + "</fmiModelDescription>\n";
}

}  // namespace hydrapod::exchange
