#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "fields.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using spatial::direction_names;

constexpr std::array input_words{"wrench", "actuator"};
constexpr std::array output_words{"displacement", "velocity", "acceleration"};

}  // namespace

std::string response_unit(response::Output output, int out_direction, int in_direction) {
  constexpr std::array begins{"", "(", "("}, ends{"", "/s)", "/s²)"};
  const auto k = static_cast<std::size_t>(output);
  return fmt::format("{}{}{}/{}", begins.at(k), out_direction < 3 ? "m" : "rad", ends.at(k),
                     in_direction < 3 ? "N" : "(N m)");
}

template <class Fields>
void describe(Fields& f, response::Peak& peak) {
  f.word("direction", peak.direction, spatial::direction_names);
  f("omega_rad_s", peak.omega);
  f.derived("frequency_hz", peak.omega / two_pi);
  f.unbounded("magnitude", peak.magnitude);
  f.unbounded("prominence_db", peak.prominence_db);
  f.counted("mode", peak.mode);
  f.derived("label", "");  // peaks_json() knows it
  f("own", peak.own);
}

/// `[output][input]` by the names of directions, with re[] and im[] over frequency.
template <class Fields>
void describe_response(Fields& f, std::vector<response::Matrix6c>& H) {
  for (int out = 0; out < 6; ++out)
    f.object(direction_names.at(out), [&](auto& row) {
      for (int in = 0; in < 6; ++in) {
        Eigen::VectorXcd values(static_cast<Eigen::Index>(H.size()));
        for (std::size_t k = 0; k < H.size(); ++k)
          values[static_cast<Eigen::Index>(k)] = H[k](out, in);
        row(direction_names.at(in), values);
        if constexpr (Fields::reads) {
          if (values.size() != static_cast<Eigen::Index>(H.size()))
            row.bad(direction_names.at(in), "must have a number per frequency");
          for (std::size_t k = 0; k < H.size(); ++k)
            H[k](out, in) = values[static_cast<Eigen::Index>(k)];
        }
      }
    });
}

Json peaks_json(const std::vector<response::Peak>& peaks, const modal::AnalysedModel& model) {
  Json list = written(peaks);
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const int mode = model.tabled_of_normal[static_cast<std::size_t>(peaks[k].mode)];
    list[k]["mode"] = mode + 1;
    list[k]["label"] = model.modes[static_cast<std::size_t>(mode)].label;
  }
  return list;
}

namespace {

/// Peaks, and of the modes as much as they say of them.
std::vector<response::Peak> peaks_from_json(const Reader& fields, const char* key,
                                            const std::string& file, modal::AnalysedModel& model) {
  std::vector<response::Peak> peaks;
  fields(key, peaks);
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const auto mode = static_cast<std::size_t>(peaks[k].mode);
    if (mode >= static_cast<std::size_t>(dynamics::max_dof))
      fields.bad(key, "holds a mode that no model has");
    while (model.modes.size() <= mode) {
      model.tabled_of_normal.push_back(static_cast<int>(model.modes.size()));
      model.modes.emplace_back();
    }
    Reader(fields.at(key)[k], file, key)("label", model.modes[mode].label);
  }
  return peaks;
}

}  // namespace

template <class Fields>
void describe(Fields& f, BodeOptions& options) {
  f.word("input", options.input, input_words);
  f.word("output", options.output, output_words);
  f("point_m", options.p_PQ);
}

Json response_json(const std::vector<double>& omega, const std::vector<response::Matrix6c>& H) {
  std::vector<double> hertz;
  for (const double value : omega) hertz.push_back(value / two_pi);
  Writer response;
  describe_response(response, const_cast<std::vector<response::Matrix6c>&>(H));
  return {{"omega_rad_s", omega}, {"frequency_hz", hertz}, {"response", response.json}};
}

std::vector<double> response_from_json(const Json& json, const std::string& file,
                                       std::vector<response::Matrix6c>& H) {
  const Reader fields(json, file);
  std::vector<double> omega;
  fields("omega_rad_s", omega);
  H.resize(omega.size());
  fields.object("response", [&](auto& f) { describe_response(f, H); });
  return omega;
}

Json bode_json(const Bode& bode) {
  Json json{{"model", dynamics::name(bode.table.kind)}};
  json.update(written(bode.options));
  json["peaks"] = peaks_json(bode.real_peaks, bode.table.real);
  json["rigid_peaks"] = peaks_json(bode.rigid_peaks, bode.table.rigid);
  json.update(response_json(bode.omega, bode.real));
  json["rigid_response"] = response_json(bode.omega, bode.rigid)["response"];
  return json;
}

Bode bode_from_json(const Json& json, const std::string& file) {
  const Reader fields(json, file);
  Bode bode;
  fields.word("model", bode.table.kind, model_words);
  read(json, file, bode.options);
  bode.omega = response_from_json(json, file, bode.real);
  bode.rigid.resize(bode.omega.size());
  fields.object("rigid_response", [&](auto& f) { describe_response(f, bode.rigid); });
  bode.real_peaks = peaks_from_json(fields, "peaks", file, bode.table.real);
  bode.rigid_peaks = peaks_from_json(fields, "rigid_peaks", file, bode.table.rigid);
  if (bode.omega.empty()) fields.bad("omega_rad_s", "is empty");
  bode.options.from = bode.omega.front();
  bode.options.to = bode.omega.back();
  bode.options.points = static_cast<int>(bode.omega.size());
  return bode;
}

std::string bode_csv(const Bode& bode) {
  std::string text = "frequency_hz,omega_rad_s";
  for (const char* model : {"", "rigid "})
    for (int out = 0; out < 6; ++out)
      for (int in = 0; in < 6; ++in)
        for (const char* part : {"re", "im"})
          text += fmt::format(",{}{} {}/{} [{}]", model, part, direction_names[out],
                              direction_names[in], response_unit(bode.options.output, out, in));
  text += '\n';
  for (size_t i = 0; i < bode.omega.size(); ++i) {
    text += fmt::format("{:.12g},{:.12g}", bode.omega[i] / two_pi, bode.omega[i]);
    for (const auto* H : {&bode.real[i], &bode.rigid[i]})
      for (int out = 0; out < 6; ++out)
        for (int in = 0; in < 6; ++in)
          text += fmt::format(",{:.12g},{:.12g}", (*H)(out, in).real(), (*H)(out, in).imag());
    text += '\n';
  }
  return text;
}

}  // namespace hydrapod::report
