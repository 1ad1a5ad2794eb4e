#include "hydrapod/report/measured_results.hpp"

#include "fields.hpp"
#include "hydrapod/base/version.hpp"

namespace hydrapod::report {

namespace {

Json channel_json(const data::Channel& channel, const data::ChannelOverview& overview) {
  Json json{{"name", channel.name},
            {"unit", channel.unit},
            {"direction", data::direction_text(channel.direction)},
            {"role", data::role_text(channel.role)},
            {"point", channel.point},
            {"samples", overview.samples},
            {"missing", overview.missing},
            {"infinite", overview.infinite},
            {"mean", overview.mean},
            {"rms", overview.rms},
            {"lowest", overview.lowest},
            {"highest", overview.highest},
            {"peak", overview.peak},
            {"at_limit", overview.at_limit},
            {"longest_hold", overview.longest_hold},
            {"constant", overview.constant},
            {"strongest_frequency_hz",
             overview.strongest_frequency > 0.0 ? Json(overview.strongest_frequency) : Json()}};
  if (!channel.entity.empty()) json["entity"] = channel.entity;
  if (!channel.id_lines.empty()) json["id_lines"] = channel.id_lines;
  return json;
}

}  // namespace

Json experiment_object(const data::Experiment& experiment) {
  const std::string text = data::experiment_json(experiment);
  return text.empty() ? Json::object() : Json::parse(text);
}

Json record_json(const data::RecordSet& record, const data::RecordOverview& overview,
                 bool with_spectra) {
  const data::RecordHeader& header = record.header();
  Json json{{"kind", "record"},
            {"hydrapod", base::version},
            {"file", record.files().front()},
            {"format", record.format() ? Json(data::format_text(*record.format())) : Json()},
            {"title", header.title},
            {"date", header.date},
            {"repeat", header.repeat},
            {"sample_rate_hz", header.sample_rate},
            {"start_s", header.start},
            {"samples", overview.samples},
            {"duration_s", overview.duration},
            {"notes", header.notes},
            {"machine_file", header.experiment.machine},
            {"experiment", experiment_object(header.experiment)},
            {"channels", Json::array()},
            {"warnings", Json::array()}};
  if (!header.geometry.empty())
    json["geometry"] = Json::parse(data::geometry_json(header.geometry));
  for (std::size_t c = 0; c < header.channels.size(); ++c)
    json["channels"].push_back(channel_json(header.channels[c], overview.channels[c]));
  for (const auto& note : record.notes()) json["warnings"].push_back(note.text());
  if (!with_spectra) return json;
  json["spectra"] = {{"frequency_hz", written(overview.spectrum.frequency)},
                     {"segments", overview.spectrum.segments},
                     {"density", written(overview.spectrum.density.transpose().eval())}};
  return json;
}

}  // namespace hydrapod::report
