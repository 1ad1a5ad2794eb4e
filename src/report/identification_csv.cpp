#include "hydrapod/report/identification_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/numerics/quantiles.hpp"

namespace hydrapod::report {

using Eigen::Index;
using identification::FrequencyResponses;

namespace {

using base::two_pi;

/// A name as a field of a title row: in quotes where it holds what would end the field.
std::string csv_field(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

}  // namespace

std::string responses_csv(const FrequencyResponses& r) {
  std::string text = "frequency_hz";
  for (const auto& o : r.outputs)
    for (const auto& i : r.inputs) {
      const std::string pair = o.name + "/" + i.name;
      text += "," + csv_field("re " + pair) + "," + csv_field("im " + pair);
      if (r.has_errors()) text += "," + csv_field("deviation " + pair);
    }
  for (const auto& o : r.outputs) text += "," + csv_field("coherence " + o.name);
  text += ",condition\n";
  for (std::size_t k = 0; k < r.lines(); ++k) {
    text += fmt::format("{:.17g}", r.frequency[k]);
    for (Index o = 0; o < r.H[k].rows(); ++o)
      for (Index i = 0; i < r.H[k].cols(); ++i) {
        text += fmt::format(",{:.17g},{:.17g}", r.H[k](o, i).real(), r.H[k](o, i).imag());
        if (r.has_errors())
          text += fmt::format(",{:.6g}",
                              std::sqrt(r.variance(k, static_cast<int>(o), static_cast<int>(i))));
      }
    for (Index o = 0; o < r.H[k].rows(); ++o)
      text +=
          r.multiple_coherence.empty() ? "," : fmt::format(",{:.6g}", r.multiple_coherence[k][o]);
    text += r.condition.empty() ? ",\n" : fmt::format(",{:.6g}\n", r.condition[k]);
  }
  return text;
}

std::string output_only_csv(const std::vector<identification::OutputOnlyMode>& modes) {
  std::string text =
      "mode,frequency_hz,frequency_scatter,damping_ratio,damping_scatter,mpc,persistence\n";
  int number = 0;
  for (const auto& m : modes)
    text += fmt::format("{},{:.17g},{:.6g},{:.17g},{:.6g},{:.6g},{:.6g}\n", ++number,
                        std::abs(m.pole) / two_pi, m.frequency_scatter,
                        -m.pole.real() / std::abs(m.pole), m.damping_scatter, m.mpc, m.persistence);
  return text;
}

std::string identified_modes_csv(const identification::Identification& result) {
  std::string text =
      "mode,frequency_hz,frequency_95_hz,damping_ratio,damping_95,mpc,mpd_rad,quality,significance";
  for (const auto& o : result.responses.outputs)
    text += "," + csv_field("re " + o.name) + "," + csv_field("im " + o.name);
  text += '\n';
  int number = 0;
  for (const auto& m : result.modes) {
    text += fmt::format(
        "{},{:.17g},{:.6g},{:.17g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", ++number,
        m.fit.omega() / two_pi, numerics::normal_half_width * m.fit.omega_deviation / two_pi,
        m.fit.damping_ratio(), numerics::normal_half_width * m.fit.damping_deviation, m.mpc, m.mpd,
        m.quality(), m.fit.significance);
    for (const auto& value : m.displacement)
      text += fmt::format(",{:.9g},{:.9g}", value.real(), value.imag());
    text += '\n';
  }
  return text;
}

}  // namespace hydrapod::report
