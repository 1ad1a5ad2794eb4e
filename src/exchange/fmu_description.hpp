#pragma once
/// modelDescription.xml, the page and the icon of an FMU.

#include "fmu_interface.hpp"
#include "hydrapod/exchange/exchange.hpp"

namespace hydrapod::exchange {

struct FmuContent {
  const FmuMachine& machine;
  const FmuInterface& interface;
  const simulation::Plant& plant;
  FmuVersion version{};
  std::string identifier{};  ///< of the shared object: letters, digits, underscores
  std::string title{};
  std::size_t object_size{};
  std::string instability{};  ///< why the machine does not stay at its rest; empty: it does
  const FmuSources& sources;
};

/// Is the file compiled, or included by others?
bool is_compiled(std::string_view name);
/// sources/buildDescription.xml of FMI 3.0, which says how the sources become a shared object. FMI
/// 2.0 has no such file of its own and takes this one.
std::string fmu_build_description(const FmuContent& fmu);

std::string fmu_description(const FmuContent& fmu);
/// In HTML.
std::string fmu_page(const FmuContent& fmu);
/// A hexapod of 64 × 64 points, PNG.
std::string fmu_icon();

/// For XML and HTML, also within quotes.
std::string escaped(std::string_view text);

}  // namespace hydrapod::exchange
