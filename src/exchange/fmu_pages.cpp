#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "fmu_description.hpp"
#include "hydrapod/base/version.hpp"

namespace hydrapod::exchange {

namespace {

std::string table_of(const FmuContent& fmu, const char* title, const auto& is_shown) {
  std::string text = fmt::format(
      "<h2>{}</h2>\n<table>\n<tr><th>name<th>unit<th>start<th>what it is</tr>\n", title);
  for (const auto& variable : fmu.interface.variables)
    if (is_shown(variable))
      text += fmt::format("<tr><td>{}<td>{}<td>{}<td>{}</tr>\n", escaped(variable.name),
                          escaped(variable.unit),
                          variable.start ? fmt::format("{:.6g}", *variable.start) : std::string(),
                          escaped(variable.description) + (variable.tunable ? " (tunable)" : ""));
  return text + "</table>\n";
}

/// How the sources are compiled, on Debian for instance.
std::string building(const FmuContent& fmu) {
  if (fmu.sources.empty()) return {};
  return fmt::format(
      "<h2>Sources</h2>\n<p>The folder sources holds the C++20 sources of the shared object; "
      "sources/buildDescription.xml says how they are compiled. They need the headers of Eigen "
      "3.4, "
      "fmt 9, JSON for Modern C++ 3.11, toml++ 3.3 and SUNDIALS 6.4 (Debian 12: libeigen3-dev, "
      "libfmt-dev, "
      "nlohmann-json3-dev, libtomlplusplus-dev, libsundials-dev), and link to three libraries of "
      "SUNDIALS:</p>\n"
      "<pre>g++ -std=c++20 -O2 -fPIC -shared -fvisibility=hidden -DEIGEN_MAX_ALIGN_BYTES=16 "
      "-DFMT_HEADER_ONLY \\\n  -I sources -I /usr/include/eigen3 $(find sources -name '*.cpp') "
      "\\\n  -lsundials_arkode -lsundials_cvode -lsundials_nvecserial -o {}.so</pre>\n",
      fmu.identifier);
}

std::string resources(const FmuContent& fmu) {
  const auto count = [&](FmuRole role) { return fmu.interface.count(role); };
  return fmt::format(
      "<h2>Resources</h2>\n<ul>\n<li>{} continuous states, {} event indicators, {} inputs, {} "
      "parameters\n<li>one shared object of {:.1f} MB for x86-64 Linux, linked to libc and libm "
      "alone\n<li>one file is read, resources/machine.json, when an instance is made; nothing is "
      "written\n<li>instances share nothing: each may run in a thread of its own\n</ul>\n",
      count(FmuRole::state), count(FmuRole::indicator), count(FmuRole::input),
      count(FmuRole::parameter), 1e-6 * static_cast<double>(fmu.object_size));
}

using Picture = std::array<std::array<unsigned char, 64>, 64>;

void draw_line(Picture& picture, std::array<double, 2> from, std::array<double, 2> to) {
  constexpr int points = 128;
  for (int k = 0; k <= points; ++k) {
    const double share = static_cast<double>(k) / points;
    const auto column = static_cast<std::size_t>(from[0] + share * (to[0] - from[0]));
    const auto row = static_cast<std::size_t>(from[1] + share * (to[1] - from[1]));
    picture.at(row).at(column) = 0;
    picture.at(row).at(column + 1) = 0;
  }
}

std::string big(std::uint32_t number) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U})
    bytes += static_cast<char>(number >> shift & 0xFFU);
  return bytes;
}

std::string chunk(const std::string& kind, const std::string& data) {
  const std::string body = kind + data;
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size());
  return big(static_cast<std::uint32_t>(data.size())) + body + big(static_cast<std::uint32_t>(crc));
}

}  // namespace

std::string fmu_page(const FmuContent& fmu) {
  const auto of = [](FmuRole role) {
    return [role](const FmuVariable& variable) { return variable.role == role; };
  };
  const bool three = fmu.version == FmuVersion::fmi3;
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n"
             "<style>body{{font-family:sans-serif;max-width:60em;margin:2em auto}}"
             "td,th{{text-align:left;padding:0 1em 0 0}}</style></head><body>\n<h1>{0}</h1>\n"
             "<p>FMI {1}, co-simulation and model exchange, written by hydrapod {2}. All numbers "
             "are in SI units and radians; pressures are absolute.</p>\n"
             "<p>The machine begins at rest at the reference pose (the last of its poses). {3} "
             "Wrenches act about the mass centre of platform and payload. Motions are against the "
             "base, in its axes.</p>\n",
             escaped(fmu.title), three ? "3.0" : "2.0", base::version,
             fmu.machine.controlled
                 ? "The controller inside reads the true lengths and pressures at its samples."
             : fmu.machine.drives() ? "The drives hold it there at the command 0."
             : fmu.machine.hydraulics
                 ? "The start values of the valve commands hold it there."
                 : "The start values of the axial forces hold it there; there is no oil spring.") +
         (fmu.instability.empty() ? std::string()
                                  : "<p><strong>UNSTABLE at this pose:</strong> " +
                                        escaped(fmu.instability) + "</p>\n") +
         "<p>Model exchange: the event indicators mark end stops, cavitation and the piston that "
         "leaves its guide sleeve, where the model ends. Co-simulation: an embedded Runge–Kutta "
         "method of order 5(4) with the tolerance that the environment gives (1e-6 unless it gives "
         "one); it starts anew in every step, so a saved state continues bit by bit. A step that "
         "cannot be completed is answered by Discard. In FMI 3.0 a step returns early at an event "
         "where that is allowed, and calls the intermediate update every millisecond.</p>\n"
         "<p>Parameters that change no length, such as masses, stiffnesses, dampers, friction, "
         "valves "
         "and the supply, are tunable: they can be set at events and between steps. The state "
         "stays, "
         "the equations change. All others are fixed.</p>\n" +
         resources(fmu) + building(fmu) + table_of(fmu, "Inputs", of(FmuRole::input)) +
         table_of(fmu, "Outputs",
                  [](const FmuVariable& variable) {
                    return variable.role == FmuRole::output || variable.is_output ||
                           variable.role == FmuRole::drive;
                  }) +
         table_of(fmu, "Parameters", of(FmuRole::parameter)) + "</body></html>\n";
}

std::string fmu_icon() {
  Picture picture{};
  for (auto& row : picture) row.fill(255);
  constexpr std::array<double, 3> base{6, 31, 56}, platform{14, 31, 48};
  constexpr double top = 12, bottom = 54;
  draw_line(picture, {platform[0], top}, {platform[2], top});
  draw_line(picture, {platform[0], top + 1}, {platform[2], top + 1});
  draw_line(picture, {base[0], bottom}, {base[2], bottom});
  draw_line(picture, {base[0], bottom + 1}, {base[2], bottom + 1});
  for (const auto& [from, to] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 2}, {2, 1}, {2, 2}})
    draw_line(picture, {base.at(static_cast<std::size_t>(from)), bottom},
              {platform.at(static_cast<std::size_t>(to)), top});
  std::string rows;
  for (const auto& row : picture) {
    rows += '\0';  // no filter
    rows.append(reinterpret_cast<const char*>(row.data()), row.size());
  }
  std::string packed(compressBound(rows.size()), '\0');
  auto size = static_cast<uLongf>(packed.size());
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(rows.data()), rows.size(), Z_BEST_COMPRESSION);
  packed.resize(size);
  constexpr std::uint32_t side = 64;
  const std::string grey_of_8_bits("\x08\x00\x00\x00\x00", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", big(side) + big(side) + grey_of_8_bits) +
         chunk("IDAT", packed) + chunk("IEND", "");
}

}  // namespace hydrapod::exchange
