#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "measured_fields.hpp"

namespace hydrapod::report {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using identification::FrequencyResponses;

/// `[row][column]` with re[] and im[] over the lines.
Json lines_json(const data::PerLine<MatrixXcd>& lines) {
  Json rows = Json::array();
  if (lines.empty()) return rows;
  for (Index i = 0; i < lines[0].rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < lines[0].cols(); ++j) {
      Eigen::VectorXcd values(static_cast<Index>(lines.size()));
      for (std::size_t k = 0; k < lines.size(); ++k) values[static_cast<Index>(k)] = lines[k](i, j);
      row.push_back(written(values));
    }
    rows.push_back(row);
  }
  return rows;
}

/// And back.
std::vector<MatrixXcd> read_lines(const Reader& fields, const char* key, std::size_t rows,
                                  std::size_t columns, std::size_t lines) {
  std::vector<std::vector<Eigen::VectorXcd>> all;
  fields(key, all);
  if (all.size() != rows) fields.bad(key, fmt::format("must have {} rows, one per output", rows));
  for (std::size_t i = 0; i < rows; ++i) {
    if (all[i].size() != columns)
      fields.bad(key, fmt::format("row {} must have {} entries", i + 1, columns));
    for (std::size_t j = 0; j < columns; ++j)
      if (const auto count = static_cast<std::size_t>(all[i][j].size()); count != lines)
        fields.bad(fmt::format("{}[{}][{}]", key, i, j),
                   fmt::format("has {} numbers, but there are {} frequencies", count, lines));
  }
  // only now is it known that the file has as many numbers as that
  std::vector<MatrixXcd> result(lines,
                                MatrixXcd(static_cast<Index>(rows), static_cast<Index>(columns)));
  for (std::size_t k = 0; k < lines; ++k)
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j)
        result[k](static_cast<Index>(i), static_cast<Index>(j)) = all[i][j][static_cast<Index>(k)];
  return result;
}

template <class Number>
Json over_lines(std::size_t lines, const Number& number) {
  Json list = Json::array();
  for (std::size_t k = 0; k < lines; ++k) list.push_back(number(k));
  return list;
}

Json entry_json(const FrequencyResponses& r, const data::PerLine<MatrixXcd>& H, Index o, Index i) {
  Json entry{{"re", over_lines(r.lines(), [&](auto k) { return H[k](o, i).real(); })},
             {"im", over_lines(r.lines(), [&](auto k) { return H[k](o, i).imag(); })}};
  if (r.has_errors())
    entry["deviation"] =
        over_lines(r.lines(), [&](auto k) { return std::sqrt(r.variance(k, o, i)); });
  if (!r.coherence.empty())
    entry["coherence"] = over_lines(r.lines(), [&](auto k) { return r.coherence[k](o, i); });
  return entry;
}

}  // namespace

Json responses_json(const FrequencyResponses& r) {
  const bool with_axis = !r.on_axis.empty();
  Json response = Json::array();
  for (std::size_t o = 0; o < r.outputs.size(); ++o) {
    Json row = Json::array();
    for (std::size_t i = 0; i < r.inputs.size(); ++i)
      row.push_back(
          entry_json(r, with_axis ? r.on_axis : r.H, static_cast<Index>(o), static_cast<Index>(i)));
    response.push_back(row);
  }
  Json json{{"inputs", written(r.inputs)},
            {"outputs", written(r.outputs)},
            {"estimator", data::estimator_text(r.estimator)},
            {"averages", r.averages},
            {"degrees_of_freedom", r.degrees},
            {"frequency_hz", r.frequency},
            {"response", response}};
  if (!r.multiple_coherence.empty()) {
    Json multiple = Json::array();
    for (std::size_t o = 0; o < r.outputs.size(); ++o)
      multiple.push_back(over_lines(
          r.lines(), [&](auto k) { return r.multiple_coherence[k][static_cast<Index>(o)]; }));
    json["multiple_coherence"] = multiple;
    json["condition"] = r.condition;
  }
  if (r.has_errors()) {
    json["noise"] = lines_json(r.noise);
    json["input_factor"] = lines_json(r.input_factor);
    json["line_covariance"] =
        written(Eigen::VectorXcd::Map(r.line_covariance.data(),
                                      static_cast<Index>(r.line_covariance.size()))
                    .eval());
  }
  if (with_axis)
    json["beside_axis"] = {{"shift_per_s", r.shift}, {"response", lines_json(r.H)}};
  else if (r.shift > 0.0)
    json["shift_per_s"] = r.shift;
  if (r.taper.size() > 0) {
    json["sample_rate_hz"] = r.sample_rate;
    json["taper"] = written(r.taper);
  }
  if (!r.leakage.line_covariance.empty())
    json["leakage"] = {{"rate_per_s2", r.leakage.rate},
                       {"line_covariance", r.leakage.line_covariance},
                       {"relation", r.leakage.relation}};
  if (!r.geometry.empty()) json["geometry"] = Json::parse(data::geometry_json(r.geometry));
  if (!r.id_lines.empty()) json["id_lines"] = r.id_lines;
  json["warnings"] = texts(r.warnings);
  json["findings"] = written(r.warnings);
  return json;
}

Json record_origin_json(const data::RecordHeader& header) {
  return {{"title", header.title},
          {"date", header.date},
          {"notes", header.notes},
          {"machine_file", header.experiment.machine},
          {"experiment", experiment_object(header.experiment)}};
}

std::optional<data::RecordHeader> record_origin_from_json(const Json& json,
                                                          const std::string& file) {
  const auto found = json.find("record");
  if (found == json.end() || !found->is_object()) return {};
  const auto text = [&](const char* key) {
    const auto field = found->find(key);
    return field != found->end() && field->is_string() ? field->get<std::string>() : std::string();
  };
  data::RecordHeader header;
  header.title = text("title");
  header.date = text("date");
  header.notes = text("notes");
  const auto experiment = found->find("experiment");
  try {
    header.experiment =
        data::read_experiment(experiment == found->end() ? "" : experiment->dump(), header.notes);
  } catch (const std::invalid_argument& error) {
    throw base::InputError({{.file = file, .key = "record.experiment", .message = error.what()}});
  }
  header.experiment.machine = text("machine_file");
  return header;
}

namespace {

/// What Universal Files said of points and responses.
void take_origin(const Json& json, const Reader& fields, FrequencyResponses& r) {
  fields.maybe("id_lines", r.id_lines);
  if (!r.id_lines.empty() && r.id_lines.size() != r.outputs.size() * r.inputs.size())
    fields.bad("id_lines", "must have a list per response");
  if (!fields.has("geometry")) return;
  try {
    r.geometry = data::read_geometry(json["geometry"].dump());
  } catch (const std::invalid_argument& error) {
    fields.bad("geometry", error.what());
  }
}

}  // namespace

FrequencyResponses responses_from_json(const Json& json, const std::string& file) {
  const Reader fields(json, file);
  for (const char* key : {"inputs", "outputs", "frequency_hz", "response"})
    if (!fields.has(key))
      fields.bad(key, "is missing; `hydrapod frf RECORD --format json` writes such a file");
  FrequencyResponses r;
  fields("inputs", r.inputs);
  fields("outputs", r.outputs);
  fields("frequency_hz", r.frequency);
  if (r.inputs.empty() || r.outputs.empty()) fields.bad("inputs", "and outputs: none is there");
  for (std::size_t k = 1; k < r.frequency.size(); ++k)
    if (!(r.frequency[k] > r.frequency[k - 1])) fields.bad("frequency_hz", "must ascend");
  const std::size_t outputs = r.outputs.size(), inputs = r.inputs.size();
  r.H = read_lines(fields, "response", outputs, inputs, r.lines());
  if (fields.has("noise")) {
    Eigen::VectorXcd covariance;
    r.noise = read_lines(fields, "noise", outputs, outputs, r.lines());
    r.input_factor = read_lines(fields, "input_factor", inputs, inputs, r.lines());
    fields("line_covariance", covariance);
    if (covariance.size() == 0) fields.bad("line_covariance", "is empty");
    r.line_covariance.assign(covariance.begin(), covariance.end());
    fields.unless(0.0, "degrees_of_freedom", r.degrees);
    fields.unless(0.0, "averages", r.averages);
  }
  if (fields.has("taper")) {
    fields("taper", r.taper);
    fields("sample_rate_hz", r.sample_rate);
    if (!(r.sample_rate > 0.0)) fields.bad("sample_rate_hz", "must be positive");
  }
  if (fields.has("leakage"))
    fields.object("leakage", [&](const Reader& f) {
      f("rate_per_s2", r.leakage.rate);
      f("line_covariance", r.leakage.line_covariance);
      f("relation", r.leakage.relation);
      if (r.leakage.relation.size() != r.leakage.line_covariance.size())
        f.bad("relation", "has another length than line_covariance");
      if (!(r.leakage.rate >= 0.0)) f.bad("rate_per_s2", "must not be negative");
    });
  fields.unless(0.0, "shift_per_s", r.shift);
  if (!(r.shift >= 0.0)) fields.bad("shift_per_s", "must not be negative");
  if (fields.has("beside_axis"))
    fields.object("beside_axis", [&](const Reader& f) {
      f("shift_per_s", r.shift);
      if (!(r.shift > 0.0)) f.bad("shift_per_s", "must be positive");
      r.on_axis = std::exchange(r.H, read_lines(f, "response", outputs, inputs, r.lines()));
    });
  fields.maybe("findings", r.warnings);
  take_origin(json, fields, r);
  std::string estimator;
  fields.unless(std::string("h1"), "estimator", estimator);
  r.estimator = data::estimator_from_text(estimator).value_or(identification::Estimator::h1);
  return r;
}

}  // namespace hydrapod::report
