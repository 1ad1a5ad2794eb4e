/// Side by side: poses of one machine; machines, records and modes.

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "measurement.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Names = std::vector<std::string>;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct ModesAtPoses : Result {
  Machine machine{};
  report::ModesAtPoses found{};
  [[nodiscard]] Json document() const override {
    auto head = head_of_model("modes_at_poses", *machine);
    head.erase("pose");
    return joined(head, report::modes_at_poses_json(found));
  }
  /// Followed modes × poses.
  template <class Get>
  [[nodiscard]] py::array table(Get get) const {
    using T = decltype(get(found.followed.front(), std::size_t{}));
    std::vector<T> values;
    for (const auto& mode : found.followed)
      for (std::size_t k = 0; k < found.poses.size(); ++k) values.push_back(get(mode, k));
    return array_of(values, {static_cast<py::ssize_t>(found.followed.size()),
                             static_cast<py::ssize_t>(found.poses.size())});
  }
  [[nodiscard]] const modal::TabledMode* at(const report::ModesAtPoses::Followed& mode,
                                            std::size_t pose) const {
    const int number = mode.mode[pose];
    return number < 0 ? nullptr : &found.tables[pose].real.modes[static_cast<std::size_t>(number)];
  }
};

struct ModesAtAmplitudes : Result {
  Machine machine{};
  report::ModesAtAmplitudes found{};
  [[nodiscard]] Json document() const override {
    return joined(head_of_model("modes_at_amplitudes", *machine),
                  report::modes_at_amplitudes_json(found));
  }
  /// Modes × amplitudes; not a number where a mode could not be followed.
  template <class Get>
  [[nodiscard]] py::array table(Get get) const {
    std::vector<double> values;
    for (const auto& curve : found.curves)
      for (std::size_t k = 0; k < found.amplitudes.size(); ++k)
        values.push_back(k < curve.points.size() && curve.points[k].converged ? get(curve.points[k])
                                                                              : unknown);
    return array_of(values, {static_cast<py::ssize_t>(found.curves.size()),
                             static_cast<py::ssize_t>(found.amplitudes.size())});
  }
};

struct Compared : Result {
  tasks::Compared found{};
  [[nodiscard]] Json document() const override {
    return joined({{"kind", "comparison"}}, report::side_by_side_json(found.result));
  }
};

/// Goes on with `more`, whose first pose is the last one of `found`.
void append(report::ModesAtPoses& found, const report::ModesAtPoses& more, std::size_t poses) {
  const auto last = found.tables.size() - 1;
  found.tables.insert(found.tables.end(), more.tables.begin() + 1, more.tables.end());
  for (const auto& mode : more.followed) {
    const auto same = std::ranges::find_if(found.followed, [&](const auto& one) {
      return mode.mode.front() >= 0 && one.mode[last] == mode.mode.front();
    });
    auto& into = same != found.followed.end()
                     ? *same
                     : found.followed.emplace_back(report::ModesAtPoses::Followed{
                           std::vector<int>(poses, -1), std::vector<std::optional<double>>(poses)});
    std::copy(mode.mode.begin() + 1, mode.mode.end(),
              into.mode.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    std::copy(mode.mac.begin() + 1, mode.mac.end(),
              into.mac.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  }
}

/// tasks::modes_at_poses() of some poses after the others, between which `watch` is asked.
report::ModesAtPoses modes_at_poses(const Machine& machine, const Names& texts,
                                    const numerics::Progress& watch) {
  constexpr std::size_t block = 32;  // poses between two looks at signals
  std::vector<model::NamedPose> poses;
  for (std::size_t k = 0; k < texts.size(); ++k) {
    if (k % block == 0 && watch(0.0)) throw base::ComputationError("interrupted");
    poses.push_back(tasks::pose_of(machine->file.machine, texts[k]));
  }
  const auto count = poses.size();
  const auto part = [&](std::size_t from, std::size_t to) {
    return tasks::modes_at_poses(*machine, {poses.begin() + static_cast<std::ptrdiff_t>(from),
                                            poses.begin() + static_cast<std::ptrdiff_t>(to)});
  };
  auto found = part(0, std::min(count, block));
  for (auto& mode : found.followed) {
    mode.mode.resize(count, -1);
    mode.mac.resize(count);
  }
  for (std::size_t k = found.tables.size(); k < count; k = found.tables.size()) {
    if (watch(static_cast<double>(k) / static_cast<double>(count)))
      throw base::ComputationError("interrupted after " + std::to_string(k) + " poses");
    append(found, part(k - 1, std::min(count, k + block)), count);
  }
  found.poses = std::move(poses);
  return found;
}

std::shared_ptr<ModesAtPoses> modes_at_poses(const Machine& machine, const Names& poses,
                                             const py::object& progress) {
  auto result = std::make_shared<ModesAtPoses>();
  result->machine = machine;
  result->found = at_work(progress, [&](const numerics::Progress& watch) {
    return modes_at_poses(machine, poses, watch);
  });
  return result;
}

std::shared_ptr<ModesAtAmplitudes> modes_at_amplitudes(const Machine& machine,
                                                       const std::vector<double>& amplitudes,
                                                       const py::object& progress) {
  auto result = std::make_shared<ModesAtAmplitudes>();
  result->machine = machine;
  result->found = at_work(progress, [&](const numerics::Progress& watch) {
    return tasks::modes_at_amplitudes(*machine, amplitudes, watch);
  });
  return result;
}

std::shared_ptr<Compared> compare(const Options& asked, const py::object& progress) {
  tasks::CompareOptions options{
      .files = asked.get<Names>("files"),
      .overrides = asked.get<Names>("overrides"),
      .poses = asked.get<Names>("poses"),
      .observed = observed_system(asked.get<std::string>("against", "auto")),
      .level = asked.amount("level", "1").value_or(0.05)};
  if (asked.has("model"))
    options.model = static_cast<dynamics::ModelKind>(
        choice("model", asked.get<std::string>("model"), {"rigid", "guide", "full"}));
  if (!(options.level >= 0.0001 && options.level <= 0.5))
    throw std::invalid_argument("level: expected 0.0001 to 0.5 (or a text such as \"5 %\")");
  auto result = std::make_shared<Compared>();
  result->found = at_work(
      progress, [&](const numerics::Progress& watch) { return tasks::compare(options, watch); });
  return result;
}

/// Every pair of modes, as columns.
py::dict pairs(const Compared& compared) {
  const auto& all = compared.found.result;
  std::vector<std::int64_t> things, first, second;
  std::vector<double> macs, reference, difference, p, damping, damping_p;
  Names verdicts, damping_verdicts, labels;
  for (const auto& c : all.comparisons)
    for (const auto& pair : c.pairs) {
      const auto& a = all.things.front().modes[static_cast<std::size_t>(pair.first)];
      things.push_back(c.thing);
      first.push_back(pair.first);
      second.push_back(pair.second);
      macs.push_back(pair.mac.value_or(unknown));
      reference.push_back(a.omega / base::two_pi);
      difference.push_back(pair.frequency.value / base::two_pi);
      p.push_back(pair.frequency.p.value_or(unknown));
      damping.push_back(pair.damping.value);
      damping_p.push_back(pair.damping.p.value_or(unknown));
      verdicts.emplace_back(report::name(pair.frequency.verdict));
      damping_verdicts.emplace_back(report::name(pair.damping.verdict));
      labels.push_back(a.label);
    }
  py::dict result;
  result["thing"] = array_of(things);
  result["first"] = array_of(first);
  result["second"] = array_of(second);
  result["mac"] = array_of(macs);
  result["frequency_hz"] = array_of(reference);
  result["frequency_difference_hz"] = array_of(difference);
  result["frequency_p"] = array_of(p);
  result["frequency_verdict"] = verdicts;
  result["damping_difference"] = array_of(damping);
  result["damping_p"] = array_of(damping_p);
  result["damping_verdict"] = damping_verdicts;
  result["label"] = labels;
  return result;
}

Names of_things(const Compared& compared, std::string report::ComparedThing::*member) {
  Names list;
  for (const auto& thing : compared.found.result.things) list.push_back(thing.*member);
  return list;
}

}  // namespace

void add_compare(py::module_& module) {
  py::class_<ModesAtPoses, Result, std::shared_ptr<ModesAtPoses>>(module, "ModesAtPoses")
      .def_property_readonly("poses",
                             [](const ModesAtPoses& m) {
                               Names names;
                               for (const auto& pose : m.found.poses) names.push_back(pose.name);
                               return names;
                             })
      .def_property_readonly("frequency_hz",
                             [](const ModesAtPoses& m) {
                               return m.table([&](const auto& mode, std::size_t k) {
                                 const auto* found = m.at(mode, k);
                                 return found == nullptr ? unknown
                                                         : found->mode.omega / base::two_pi;
                               });
                             })
      .def_property_readonly("mac",
                             [](const ModesAtPoses& m) {
                               return m.table([](const auto& mode, std::size_t k) {
                                 return mode.mac[k].value_or(unknown);
                               });
                             })
      .def_property_readonly("numbers",
                             [](const ModesAtPoses& m) {
                               return m.table([](const auto& mode, std::size_t k) {
                                 return static_cast<std::int64_t>(mode.mode[k]);
                               });
                             })
      .def_property_readonly("labels", [](const ModesAtPoses& m) {
        Names labels;
        for (const auto& mode : m.found.followed) {
          labels.emplace_back();
          for (std::size_t k = 0; k < m.found.poses.size() && labels.back().empty(); ++k)
            if (const auto* found = m.at(mode, k)) labels.back() = found->label;
        }
        return labels;
      });
  module.def("modes_at_poses",
             [](const Machine& machine, const Names& poses, const py::object& progress) {
               return modes_at_poses(machine, poses, progress);
             });
  py::class_<ModesAtAmplitudes, Result, std::shared_ptr<ModesAtAmplitudes>>(module,
                                                                            "ModesAtAmplitudes")
      .def_property_readonly("amplitudes",
                             [](const ModesAtAmplitudes& m) {
                               return array_of(
                                   m.found.amplitudes,
                                   {static_cast<py::ssize_t>(m.found.amplitudes.size())});
                             })
      .def_property_readonly("numbers",
                             [](const ModesAtAmplitudes& m) {
                               std::vector<std::int64_t> numbers;
                               for (const auto& curve : m.found.curves)
                                 numbers.push_back(curve.mode);
                               return array_of(numbers, {static_cast<py::ssize_t>(numbers.size())});
                             })
      .def_property_readonly("directions",
                             [](const ModesAtAmplitudes& m) {
                               Names names;
                               for (const auto& curve : m.found.curves)
                                 names.emplace_back(spatial::direction_name(curve.direction));
                               return names;
                             })
      .def_property_readonly("from_long_swings",
                             [](const ModesAtAmplitudes& m) {
                               std::vector<bool> second;
                               for (const auto& curve : m.found.curves)
                                 second.push_back(curve.from_long_swings);
                               return second;
                             })
      .def_property_readonly(
          "frequency_hz",
          [](const ModesAtAmplitudes& m) {
            return m.table([](const auto& point) { return point.omega / base::two_pi; });
          })
      .def_property_readonly(
          "damping_ratio",
          [](const ModesAtAmplitudes& m) {
            return m.table([](const auto& point) { return point.damping_ratio; });
          })
      .def_property_readonly("sleeve_amplitude", [](const ModesAtAmplitudes& m) {
        return m.table([](const auto& point) { return point.sleeve; });
      });
  module.def("modes_at_amplitudes", &modes_at_amplitudes);
  py::class_<Compared, Result, std::shared_ptr<Compared>>(module, "Compared")
      .def_property_readonly(
          "things", [](const Compared& c) { return of_things(c, &report::ComparedThing::name); })
      .def_property_readonly(
          "descriptions",
          [](const Compared& c) { return of_things(c, &report::ComparedThing::description); })
      .def_property_readonly("columns", &pairs)
      .def_property_readonly("level", [](const Compared& c) { return c.found.result.level; })
      .def_property_readonly("test",
                             [](const Compared& c) { return report::test_text(c.found.result); })
      .def_property_readonly("warnings", [](const Compared& c) { return texts(c.found.warnings); });
  module.def("compare", [](const py::dict& options, const py::object& progress) {
    return compare(Options(options), progress);
  });
}

}  // namespace hydrapod::python
