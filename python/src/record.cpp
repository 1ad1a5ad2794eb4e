/// Records in memory: read from a file, made of arrays.

#include "data/channel_roles.hpp"
#include "data/channel_units.hpp"
#include "data/time_column.hpp"
#include "data/time_grid.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/data/record_io.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Names = std::vector<std::string>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Times = py::array_t<double, py::array::c_style>;

/// Names, roles and directions of channels; without roles, names and units tell them.
std::vector<data::Channel> channels_of(const Names& names, const Names& units,
                                       const std::optional<Names>& roles, const Names& directions) {
  std::vector<data::Channel> channels;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto role = roles ? data::role_from_text((*roles)[k]) : data::Role::response;
    if (!role)
      base::refuse("role " + (*roles)[k], "accepted are excitation, drive, response and other");
    const auto direction =
        directions[k].empty() ? data::Direction::none : data::direction_from_text(directions[k]);
    if (!direction)
      base::refuse("direction " + directions[k], "accepted are x … rz, -x … -rz, leg 1 … leg 6");
    channels.push_back(
        {.name = names[k], .unit = units[k], .direction = *direction, .role = *role});
  }
  return channels;
}

/// What the readers of files say of the rate, with its name here.
std::string with_name_of_rate(std::string text) {
  for (std::size_t at = 0; (at = text.find("--rate", at)) != std::string::npos;)
    text.replace(at, std::string("--rate").size(), "sample_rate");
  return text;
}

[[noreturn]] void throw_with_name_of_rate(const base::InputError& error) {
  auto diagnostics = error.diagnostics();
  for (auto& one : diagnostics) one.message = with_name_of_rate(one.message);
  throw base::InputError(diagnostics);
}

/// What Python knows of a record besides its samples and the times of a table.
struct Made {
  std::optional<double> rate{};
  double start{};
  bool has_unit_of_time{};
};

/// Rate, start and samples of `record`, at its times where they are given.
void take_samples(const Doubles& samples, const std::optional<Times>& times, const Made& made,
                  data::Notes& said, data::Record& record) {
  const Eigen::Map<const data::Samples> given(samples.data(), samples.shape(0), samples.shape(1));
  auto& header = record.header;
  if (!times) {
    header.sample_rate = made.rate.value();
    header.start = made.start;
    record.samples = given;
    return;
  }
  if (times->size() != samples.shape(0))
    throw std::invalid_argument("times: expected one for each row");
  const std::span all(times->data(), static_cast<std::size_t>(times->size()));
  std::optional<data::StatedRate> stated;
  if (made.rate) stated = {*made.rate, fmt::format("sample_rate={}", *made.rate)};
  try {
    auto even = data::on_time_grid(given, all, stated, said);
    header.sample_rate = even.rate;
    header.start = even.start;
    record.samples = std::move(even.samples);
  } catch (const base::InputError& error) {
    throw_with_name_of_rate(error);
  }
  if (!made.has_unit_of_time)
    data::note_assumed_unit(data::times_taken_for_seconds, header.sample_rate, all.size(),
                            "a name such as \"time [ms]\" states another", said);
}

/// The record, its units made SI as those of files are, and what is to be said about them.
py::tuple record_of(const Doubles& samples, const std::optional<Times>& times,
                    const Options& asked) {
  if (samples.ndim() != 2)
    throw std::invalid_argument("samples: expected an array of samples × channels, got " +
                                std::to_string(samples.ndim()) + " dimensions");
  const auto names = asked.get<Names>("channels"), units = asked.get<Names>("units"),
             directions = asked.get<Names>("directions");
  std::optional<Names> roles;
  if (asked.has("roles")) roles = asked.get<Names>("roles");
  const auto columns = static_cast<std::size_t>(samples.shape(1));
  for (const auto* list : {&names, &units, &directions, roles ? &*roles : &names})
    if (list->size() != columns)
      throw std::invalid_argument("expected " + std::to_string(columns) +
                                  " names, units, roles and directions: one for each channel");
  auto record = std::make_shared<data::Record>();
  auto& header = record->header;
  header.channels = channels_of(names, units, roles, directions);
  header.title = asked.get<std::string>("title");
  header.notes = asked.get<std::string>("notes");
  header.date = asked.get<std::string>("date");
  data::Notes said("record");
  take_samples(samples, times,
               {asked.amount("sample_rate", "Hz"), asked.amount("start", "s").value_or(0.0),
                asked.get("has_unit_of_time", false)},
               said, *record);
  if (asked.get("of_table", false)) data::make_names_unique(header.channels);
  const auto factors = data::to_si(header.channels, said, false);
  if (!roles) data::guess_roles(header.channels, said);
  data::validate(header);
  for (std::size_t k = 0; k < columns; ++k)
    if (factors[k] != 1.0) record->samples.col(static_cast<Eigen::Index>(k)) *= factors[k];
  auto words = texts(said.all());
  for (auto& text : words) text = with_name_of_rate(std::move(text));
  return py::make_tuple(record, words);
}

/// Of titles such as "force [N]": names, units, and which one is the times: its number, its factor
/// to seconds, whether it states its unit.
py::tuple columns_of_table(const Names& titles) {
  Names names, units;
  std::vector<base::TableTitle> found;
  for (const auto& title : titles) {
    found.push_back(base::table_title({std::string(base::trimmed(title)), 0}));
    names.push_back(found.back().name);
    units.push_back(found.back().unit);
  }
  const auto times = data::find_time_column(found);
  return py::make_tuple(
      names, units,
      times ? py::object(py::make_tuple(times->column, times->factor, times->has_unit))
            : py::none());
}

void stop_if_asked(const numerics::Progress& watch) {
  if (watch(0.0)) throw base::ComputationError("interrupted");
}

/// As data::read_record(), and signals are answered between two blocks.
data::ReadRecordResult data_of(const std::string& path, const data::ReadOptions& options,
                               const numerics::Progress& watch) {
  stop_if_asked(watch);
  data::RecordSet set({path}, options);
  std::vector<data::Samples> blocks;
  Eigen::Index rows = 0;
  set.stream([&](std::size_t /*file*/, const Eigen::Ref<const data::Samples>& block) {
    stop_if_asked(watch);
    blocks.emplace_back(block);
    rows += block.rows();
    return true;
  });
  data::ReadRecordResult result{.record = {.header = set.header()}, .notes = set.notes()};
  auto& samples = result.record.samples;
  samples.resize(rows, std::ssize(set.header().channels));
  rows = 0;
  for (auto& block : blocks) {
    samples.middleRows(rows, block.rows()) = block;
    rows += block.rows();
    block = {};
  }
  return result;
}

/// As data::write_record(), and signals are answered between two blocks: then there is no file.
void write(const data::Record& record, const std::string& path, const numerics::Progress& watch) {
  const auto& samples = record.samples;
  const auto writer = data::open_record_writer(path, record.header, data::format_of_ending(path));
  const Eigen::Index at_once = data::make_block(record.header).rows();
  for (Eigen::Index at = 0; at < samples.rows(); at += at_once) {
    stop_if_asked(watch);
    writer->append(samples.middleRows(at, std::min(at_once, samples.rows() - at)));
  }
  writer->close();
}

template <class Get>
std::vector<std::string> of_channels(const data::Record& record, Get get) {
  std::vector<std::string> list;
  for (const auto& channel : record.header.channels) list.emplace_back(get(channel));
  return list;
}

}  // namespace

void add_record(py::module_& module) {
  using Record = data::Record;
  py::class_<Record, std::shared_ptr<Record>>(module, "Record")
      .def_property_readonly(
          "samples",
          [](const py::object& self) { return view_of(self.cast<const Record&>().samples, self); })
      .def_property_readonly(
          "channels",
          [](const Record& r) { return of_channels(r, [](auto& c) { return c.name; }); })
      .def_property_readonly(
          "units", [](const Record& r) { return of_channels(r, [](auto& c) { return c.unit; }); })
      .def_property_readonly("roles",
                             [](const Record& r) {
                               return of_channels(r,
                                                  [](auto& c) { return data::role_text(c.role); });
                             })
      .def_property_readonly("directions",
                             [](const Record& r) {
                               return of_channels(
                                   r, [](auto& c) { return data::direction_text(c.direction); });
                             })
      .def_property_readonly("sample_rate", [](const Record& r) { return r.header.sample_rate; })
      .def_property_readonly("start", [](const Record& r) { return r.header.start; })
      .def_property_readonly("title", [](const Record& r) { return r.header.title; })
      .def_property_readonly("notes", [](const Record& r) { return r.header.notes; })
      .def_property_readonly("date", [](const Record& r) { return r.header.date; })
      .def_property_readonly("machine", [](const Record& r) { return r.header.experiment.machine; })
      .def("write", [](const Record& record, const py::object& file) {
        const auto path = path_of(file, "path");
        at_work(py::none(), [&](const numerics::Progress& watch) {
          write(record, path, watch);
          return 0;
        });
      });
  module.def("read_record", [](const std::string& path, const std::optional<double>& rate) {
    auto read = at_work(py::none(), [&](const numerics::Progress& watch) {
      return data_of(path, {.sample_rate = rate}, watch);
    });
    return py::make_tuple(std::make_shared<Record>(std::move(read.record)), texts(read.notes));
  });
  module.def("record",
             [](const Doubles& samples, const std::optional<Times>& times,
                const py::dict& options) { return record_of(samples, times, Options(options)); });
  module.def("columns_of_table", &columns_of_table);
}

}  // namespace hydrapod::python
