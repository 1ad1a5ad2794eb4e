/// Records as files: a look, another format, a part, another sample rate, checksums, recovery.

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/data/processing.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Names = std::vector<std::string>;

struct Overview : Result {
  tasks::ShownRecord shown;
  bool spectra{};
  Overview(tasks::ShownRecord found, bool with_spectra)
      : shown(std::move(found)), spectra(with_spectra) {}
  [[nodiscard]] const data::RecordHeader& header() const { return shown.record.header(); }
  [[nodiscard]] Json document() const override {
    return report::record_json(shown.record, shown.overview, spectra);
  }
};

tasks::RecordOptions record_of(const Options& asked) {
  return {.file = asked.get<std::string>("file"), .sample_rate = asked.positive("rate", "Hz")};
}

tasks::RecordOutput output_of(const Options& asked) {
  const std::vector<std::string_view> words{"hdf5", "mat5",      "mat73", "csv",
                                            "uff",  "uff-ascii", "rpc",   "rpc-short"};
  tasks::RecordOutput output{.path = asked.get<std::string>("output")};
  if (asked.has("format"))
    output.format =
        data::format_from_text(words[choice("format", asked.get<std::string>("format"), words)]);
  else
    output.format = data::format_of_ending(output.path);
  return output;
}

tasks::RecordPart part_of(const Options& asked) {
  tasks::RecordPart part{.from = asked.amount("from", "s"),
                         .to = asked.amount("to", "s"),
                         .channels = asked.get<Names>("channels")};
  if (asked.has("role"))
    part.role = static_cast<data::Role>(choice("role", asked.get<std::string>("role"),
                                               {"excitation", "drive", "response", "other"}));
  if (!asked.has("direction")) return part;
  const auto text = asked.get<std::string>("direction");
  part.direction = data::direction_from_text(text);
  if (!part.direction || text.empty())
    base::refuse("direction=" + text, "accepted are x … rz, -x … -rz, leg 1 … leg 6");
  return part;
}

const char* word_of(data::ChecksumFinding finding) {
  constexpr std::array words{"none", "holds", "differs"};
  return words[static_cast<std::size_t>(finding)];
}

/// Path, samples, warnings. A part is a mistake here: the message says where it is.
py::tuple written_of(const std::string& file, std::int64_t samples, bool complete,
                     const std::vector<base::Diagnostic>& notes) {
  if (!complete)
    throw base::ComputationError("interrupted; " + file + " contains the first " +
                                 std::to_string(samples) + " samples");
  return py::make_tuple(file, samples, texts(notes));
}

/// One of convert_record(), cut_record() and resample_record() with these options.
py::tuple rewrite(const std::string& how, const Options& asked, const py::object& progress) {
  const auto record = record_of(asked);
  const auto output = output_of(asked);
  const auto part = part_of(asked);
  const auto rate = asked.positive("new_rate", "Hz");
  const auto written = at_work(progress, [&](const numerics::Progress& watch) {
    if (how == "cut") return tasks::cut_record(record, output, part, watch);
    if (how == "resample") return tasks::resample_record(record, output, rate.value(), watch);
    return tasks::convert_record(record, output, watch);
  });
  return written_of(written.file, written.samples, written.complete, written.notes);
}

py::tuple recover(const Options& asked, const py::object& progress) {
  const auto record = record_of(asked);
  const auto output = output_of(asked);
  const auto found = at_work(progress, [&](const numerics::Progress& watch) {
    return data::recover_record(record.file, output.path,
                                {.format = *output.format,
                                 .read = {.sample_rate = record.sample_rate},
                                 .progress = [&](double share) { return !watch(share); }});
  });
  return written_of(found.file, found.samples, found.complete, found.notes) +
         py::make_tuple(found.declared, found.unfinished, found.has_checksum,
                        word_of(found.checksum), found.uneven);
}

py::tuple verify(const std::string& file, const py::object& progress) {
  const auto found = at_work(
      progress, [&](const numerics::Progress& watch) { return tasks::verify_record(file, watch); });
  return py::make_tuple(found.samples, found.channels, word_of(found.checksum), texts(found.notes));
}

py::tuple plot(const Options& asked, const py::object& progress) {
  const auto record = record_of(asked);
  const auto path = asked.get<std::string>("output");
  const auto channels = asked.get<Names>("channels");
  const auto found = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::plot_record(record, path, channels, watch);
  });
  return py::make_tuple(found.shown, found.channels, texts(found.notes));
}

template <class Get>
py::array per_channel(const Overview& overview, Get get) {
  return array_of_each(overview.shown.overview.channels, get);
}

template <class Get>
Names channel_texts(const Overview& overview, Get get) {
  Names list;
  for (const auto& channel : overview.header().channels) list.emplace_back(get(channel));
  return list;
}

void add_overview(py::module_& module) {
  auto type = py::class_<Overview, Result, std::shared_ptr<Overview>>(module, "RecordOverview");
  using Channel = data::ChannelOverview;
  const auto numbers = [&](const char* name, auto member) {
    type.def_property_readonly(name, [member](const Overview& o) {
      return per_channel(o, [member](const Channel& c) { return c.*member; });
    });
  };
  numbers("missing", &Channel::missing);
  numbers("infinite", &Channel::infinite);
  numbers("mean", &Channel::mean);
  numbers("rms", &Channel::rms);
  numbers("lowest", &Channel::lowest);
  numbers("highest", &Channel::highest);
  numbers("peak", &Channel::peak);
  numbers("at_limit", &Channel::at_limit);
  numbers("longest_hold", &Channel::longest_hold);
  numbers("strongest_frequency_hz", &Channel::strongest_frequency);
  const auto words = [&](const char* name, auto get) {
    type.def_property_readonly(name, [get](const Overview& o) { return channel_texts(o, get); });
  };
  words("channels", [](const data::Channel& c) { return c.name; });
  words("units", [](const data::Channel& c) { return c.unit; });
  words("roles", [](const data::Channel& c) { return data::role_text(c.role); });
  words("directions", [](const data::Channel& c) { return data::direction_text(c.direction); });
  type.def_property_readonly(
          "spectrum_frequency_hz",
          [](const py::object& self) {
            return view_of(self.cast<const Overview&>().shown.overview.spectrum.frequency, self);
          })
      .def_property_readonly(
          "spectra",
          [](const py::object& self) {
            return view_of(self.cast<const Overview&>().shown.overview.spectrum.density, self);
          })
      .def_property_readonly(
          "format", [](const Overview& o) { return data::format_text(*o.shown.record.format()); })
      .def_property_readonly("title", [](const Overview& o) { return o.header().title; })
      .def_property_readonly("sample_rate",
                             [](const Overview& o) { return o.header().sample_rate; })
      .def_property_readonly("start", [](const Overview& o) { return o.header().start; })
      .def_property_readonly("samples", [](const Overview& o) { return o.shown.overview.samples; })
      .def_property_readonly("duration",
                             [](const Overview& o) { return o.shown.overview.duration; })
      .def_property_readonly("warnings",
                             [](const Overview& o) { return texts(o.shown.record.notes()); });
}

}  // namespace

void add_records(py::module_& module) {
  add_overview(module);
  module.def("show_record", [](const py::dict& options, const py::object& progress) {
    const Options asked(options);
    const auto record = record_of(asked);
    const bool spectra = asked.get("spectra", false);
    return at_work(progress, [&](const numerics::Progress& watch) {
      return std::make_shared<Overview>(tasks::show_record(record, watch), spectra);
    });
  });
  module.def("rewrite_record",
             [](const std::string& how, const py::dict& options, const py::object& progress) {
               return rewrite(how, Options(options), progress);
             });
  module.def("recover_record", [](const py::dict& options, const py::object& progress) {
    return recover(Options(options), progress);
  });
  module.def("verify_record", &verify);
  module.def("plot_record", [](const py::dict& options, const py::object& progress) {
    return plot(Options(options), progress);
  });
}

}  // namespace hydrapod::python
