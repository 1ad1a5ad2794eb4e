#include "response_comments.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "channel_units.hpp"

namespace hydrapod::data {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Json = nlohmann::ordered_json;

constexpr const char* key = "responses";

/// Members that say nothing are left out.
Json finding(const ResponseWarning& w) {
  Json json{{"kind", response_warning_names[static_cast<std::size_t>(w.kind)]}};
  const auto add = [&](const char* name, const auto& value) {
    if (value != std::decay_t<decltype(value)>()) json[name] = value;
  };
  add("channel", w.channel);
  add("other", w.other);
  add("value", w.value);
  add("share", w.share);
  add("lowest", w.lowest);
  add("highest", w.highest);
  add("count", w.count);
  add("total", w.total);
  if (w.estimator != Estimator::h1) json["estimator"] = estimator_text(w.estimator);
  return json;
}

std::string description(const FrequencyResponses& all) {
  std::vector<double> re, im;
  for (const auto& a : all.line_covariance) {
    re.push_back(a.real());
    im.push_back(a.imag());
  }
  Json json{{"outputs", all.outputs.size()},
            {"estimator", estimator_text(all.estimator)},
            {"averages", all.averages},
            {"degrees_of_freedom", all.degrees},
            {"line_covariance", {{"re", re}, {"im", im}}}};
  if (!all.id_lines.empty()) json["id_lines"] = all.id_lines;
  for (const auto& warning : all.warnings) json["findings"].push_back(finding(warning));
  if (all.shift > 0.0) json["shift_per_s"] = all.shift;
  if (all.taper.size() > 0) {
    json["sample_rate_hz"] = all.sample_rate;
    json["taper"] = std::vector<double>(all.taper.begin(), all.taper.end());
  }
  if (!all.leakage.line_covariance.empty())
    json["leakage"] = {{"rate_per_s2", all.leakage.rate},
                       {"line_covariance", all.leakage.line_covariance},
                       {"relation", all.leakage.relation}};
  return json.dump();
}

[[noreturn]] void refuse(const char* what) { throw std::invalid_argument(what); }

/// 0 where there is none.
double number(const Json& json, const char* member) {
  const double value = json.value(member, 0.0);
  if (!std::isfinite(value) || value < 0.0) refuse(member);
  return value;
}

/// Correlations: finite, none above 1, the first one 1.
void require_correlations(const std::vector<double>& size, const char* what) {
  constexpr double rounding = 1e-9;
  const auto sound = [](double value) { return std::abs(value) <= 1.0 + rounding; };
  if (size.empty() || std::abs(size[0] - 1.0) > rounding || !std::ranges::all_of(size, sound))
    refuse(what);
}

void take_line_covariance(const Json& json, FrequencyResponses& all) {
  const auto re = json.at("re").get<std::vector<double>>(),
             im = json.at("im").get<std::vector<double>>();
  if (re.size() != im.size()) refuse("line_covariance");
  std::vector<double> size;
  for (std::size_t d = 0; d < re.size(); ++d) size.push_back(std::hypot(re[d], im[d]));
  require_correlations(size, "line_covariance");
  all.line_covariance.clear();
  for (std::size_t d = 0; d < re.size(); ++d) all.line_covariance.emplace_back(re[d], im[d]);
}

void take_taper(const Json& json, FrequencyResponses& all) {
  const auto taper = json.at("taper").get<std::vector<double>>();
  require_correlations(taper, "taper");
  all.sample_rate = number(json, "sample_rate_hz");
  if (!(all.sample_rate > 0.0)) refuse("sample_rate_hz");
  all.taper = Eigen::VectorXd::Map(taper.data(), static_cast<Index>(taper.size()));
}

void take_leakage(const Json& json, FrequencyResponses& all) {
  auto& leakage = all.leakage;
  leakage.rate = number(json, "rate_per_s2");
  leakage.line_covariance = json.at("line_covariance").get<std::vector<double>>();
  leakage.relation = json.at("relation").get<std::vector<double>>();
  const auto sound = [](double a) { return std::abs(a) <= 1.0; };
  if (leakage.relation.size() != leakage.line_covariance.size() ||
      !std::ranges::all_of(leakage.line_covariance, sound) ||
      !std::ranges::all_of(leakage.relation, sound))
    refuse("leakage");
}

/// Of kinds that this version knows.
void take_findings(const Json& findings, FrequencyResponses& all) {
  for (const auto& json : findings) {
    const auto kind = std::ranges::find(response_warning_names, json.at("kind").get<std::string>());
    if (kind == response_warning_names.end()) continue;
    ResponseWarning w{
        .kind = static_cast<ResponseWarning::Kind>(kind - response_warning_names.begin())};
    w.channel = json.value("channel", w.channel);
    w.other = json.value("other", w.other);
    w.value = json.value("value", w.value);
    w.share = json.value("share", w.share);
    w.lowest = json.value("lowest", w.lowest);
    w.highest = json.value("highest", w.highest);
    w.count = json.value("count", w.count);
    w.total = json.value("total", w.total);
    const auto estimator = estimator_from_text(json.value("estimator", std::string("h1")));
    w.estimator = estimator.value_or(w.estimator);
    for (const double number : {w.value, w.share, w.lowest, w.highest})
      if (!std::isfinite(number)) refuse("findings");
    w.channel = clean_text(w.channel);
    w.other = clean_text(w.other);
    all.warnings.push_back(std::move(w));
  }
}

FrequencyResponses from_json(const std::string& text, const RecordHeader& header) {
  const Json json = Json::parse(text);
  FrequencyResponses all{.title = header.title, .date = header.date};
  const auto outputs = json.at("outputs").get<std::size_t>();
  if (outputs == 0 || outputs >= header.channels.size()) refuse("outputs");
  const auto border = header.channels.begin() + static_cast<std::ptrdiff_t>(outputs);
  all.outputs.assign(header.channels.begin(), border);
  all.inputs.assign(border, header.channels.end());
  const auto estimator = estimator_from_text(json.value("estimator", std::string("h1")));
  if (!estimator) refuse("estimator");
  all.estimator = *estimator;
  all.averages = number(json, "averages");
  all.degrees = number(json, "degrees_of_freedom");
  all.shift = number(json, "shift_per_s");
  take_line_covariance(json.at("line_covariance"), all);
  if (json.contains("taper")) take_taper(json, all);
  if (json.contains("leakage")) take_leakage(json.at("leakage"), all);
  if (json.contains("findings")) take_findings(json.at("findings"), all);
  all.geometry = header.geometry;
  all.id_lines = json.value("id_lines", std::vector<std::vector<std::string>>{});
  if (!all.id_lines.empty() && all.id_lines.size() != all.outputs.size() * all.inputs.size())
    refuse("id_lines");
  return all;
}

/// Fills the upper triangles; false where a matrix is no covariance. Positive definite matrices are
/// asked for where they are inverted.
bool become_covariances(std::vector<MatrixXcd>& matrices, bool definite) {
  return std::ranges::all_of(matrices, [&](MatrixXcd& matrix) {
    matrix = MatrixXcd(matrix.selfadjointView<Eigen::Lower>());
    return matrix.allFinite() && matrix.diagonal().real().minCoeff() >= 0.0 &&
           matrix.trace().real() > 0.0 &&
           (!definite || Eigen::LLT<MatrixXcd>(matrix).info() == Eigen::Success);
  });
}

/// Lines of an estimate with a window of n samples are multiples of the sample rate by n. Files of
/// six digits say them roughly; others are not those of the window.
void put_on_lines_of_window(Notes& notes, FrequencyResponses& all) {
  if (all.taper.size() == 0) return;
  constexpr double six_digits = 2e-5, same = 1e-9, clear = 0.4;
  const double n = static_cast<double>(all.taper.size()), step = all.sample_rate / n;
  auto lines = all.frequency;
  for (double& f : lines) {
    const double line = std::round(f / step), off = std::abs(f - line * step);
    if (line > 0.5 * n || off > six_digits * f || off > clear * step) {
      notes.add(
          "the frequencies are not lines of the window that is described: its taper is left aside, "
          "and sharp resonances are taken for wider ones");
      all.taper.resize(0);
      return;
    }
    if (off > same * step) f = line * step;
  }
  all.frequency = std::move(lines);
}

}  // namespace

const PerLine<MatrixXcd>& required_on_axis(const FrequencyResponses& all) {
  if (!(all.shift > 0.0)) return all.H;
  if (all.on_axis.empty())
    refuse("frequency response: H is beside the imaginary axis, and files need H(iω) too");
  return all.on_axis;
}

std::string response_comments(const FrequencyResponses& all) {
  RecordHeader header;
  header.title = all.title;
  header.date = all.date;
  header.sample_rate = all.sample_rate > 0.0 ? all.sample_rate : 1.0;
  header.geometry = all.geometry;
  header.channels = all.outputs;
  header.channels.insert(header.channels.end(), all.inputs.begin(), all.inputs.end());
  return comment_lines(header) + "# " + key + ": " + description(all) + "\n";
}

std::optional<FrequencyResponses> described_responses(const RecordComments& comments,
                                                      Notes& notes) {
  const std::string text = comments.text_of(key);
  if (!comments.by_hydrapod(notes) || text.empty()) return {};
  std::string why;
  try {
    return from_json(text, comments.header(notes));
  } catch (const Json::exception& error) {
    why = error.what();
  } catch (const std::invalid_argument& error) {
    why = error.what();
  }
  notes.add("the description of the responses by hydrapod is damaged and left aside (" +
            clean_text(why) + "): intervals may be too narrow");
  return {};
}

void take_description(const FrequencyResponses& described, Notes& notes, FrequencyResponses& all) {
  all.estimator = described.estimator;
  all.averages = described.averages;
  all.degrees = described.degrees;
  all.line_covariance = described.line_covariance;
  all.leakage = described.leakage;
  all.shift = described.shift;
  all.taper = described.taper;
  all.sample_rate = described.sample_rate;
  all.geometry = described.geometry;
  all.id_lines = described.id_lines;
  all.warnings.insert(all.warnings.begin(), described.warnings.begin(), described.warnings.end());
  put_on_lines_of_window(notes, all);
}

void take_errors(WrittenErrors written, Notes& notes, FrequencyResponses& all) {
  const auto lines = all.lines();
  if (written.noise.size() == lines && written.input_factor.size() == lines) {
    if (become_covariances(written.noise, false) &&
        become_covariances(written.input_factor, true)) {
      all.noise = std::move(written.noise);
      all.input_factor = std::move(written.input_factor);
      return;
    }
    notes.add("the noise of the responses is not complete or damaged: left aside");
  }
  if (written.variance.size() != lines) return;
  const auto sound = [](const Eigen::MatrixXd& V) {
    return V.allFinite() && V.minCoeff() >= 0.0 && V.maxCoeff() > 0.0;
  };
  if (!std::ranges::all_of(written.variance, sound)) {
    notes.add("the variances of the responses are not complete or not positive: left aside");
    return;
  }
  for (const auto& V : written.variance) {
    const Eigen::VectorXd noise = V.rowwise().mean(),
                          factor = V.colwise().mean().transpose() / V.mean();
    all.noise.emplace_back(noise.cast<std::complex<double>>().asDiagonal());
    all.input_factor.emplace_back(factor.cast<std::complex<double>>().asDiagonal());
  }
}

void take_beside_axis(std::vector<MatrixXcd> beside, Notes& notes, FrequencyResponses& all) {
  if (!(all.shift > 0.0)) return;
  if (beside.size() == all.lines() &&
      std::ranges::all_of(beside, [](const MatrixXcd& H) { return H.allFinite(); })) {
    all.on_axis = std::exchange(all.H, std::move(beside));
    return;
  }
  all.shift = 0.0;
  notes.add(
      "the responses beside the axis are not complete; those on it are used, and intervals "
      "will be too narrow");
}

}  // namespace hydrapod::data
