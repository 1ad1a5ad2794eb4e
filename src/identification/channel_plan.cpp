#include "channel_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::identification {

namespace {

using data::Role;

std::vector<int> with_role(const data::RecordHeader& header, Role role) {
  std::vector<int> list;
  for (std::size_t c = 0; c < header.channels.size(); ++c)
    if (header.channels[c].role == role) list.push_back(static_cast<int>(c));
  return list;
}

/// All responses; but where the platform's motion or the six leg lengths are among sensors of
/// other kinds, these.
std::vector<int> default_outputs(const data::RecordHeader& header) {
  const auto six = [&](data::Direction first, const std::vector<std::string_view>& units) {
    return six_channels(header.channels, Role::response, first, units);
  };
  if (const auto platform = six(data::Direction::x, {"m", "rad"})) return *platform;
  return six(data::Direction::leg1, {"m"}).value_or(with_role(header, Role::response));
}

std::string names_of(const data::RecordHeader& header) {
  std::string text;
  for (const auto& c : header.channels) text += (text.empty() ? "" : ", ") + c.name;
  return text;
}

std::vector<int> with_names(const std::string& file, const data::RecordHeader& header,
                            const std::vector<std::string>& names) {
  std::vector<int> list;
  for (const auto& name : names) {
    const auto at = data::find_channel(header, name);
    if (!at) {
      std::vector<std::string_view> known;
      for (const auto& c : header.channels) known.push_back(c.name);
      const auto near = base::nearest(name, known);
      base::refuse(file, fmt::format("there is no channel '{}'; {}", name,
                                     near ? fmt::format("did you mean '{}'?", *near)
                                          : "the record has " + names_of(header)));
    }
    list.push_back(static_cast<int>(*at));
  }
  return list;
}

/// Do the drives stand between the excitations and the machine? They do where a controller makes
/// them from commanded motions or adds commands to them, and do not where the excitation is force.
bool inside_a_loop(const data::RecordHeader& header, const std::vector<int>& excitations,
                   const std::vector<int>& drives) {
  if (excitations.empty() || drives.size() != excitations.size()) return excitations.empty();
  return std::ranges::none_of(excitations, [&](int c) {
    return header.channels[static_cast<std::size_t>(c)].unit.starts_with("N");
  });
}

}  // namespace

Plan plan_channels(const std::string& file, const data::RecordHeader& header,
                   const MeasureOptions& options) {
  Plan plan;
  auto& c = plan.choice;
  const auto excitations = with_role(header, Role::excitation);
  const auto drives = with_role(header, Role::drive);
  const bool from_drive = options.input_role ? *options.input_role == Role::drive
                                             : inside_a_loop(header, excitations, drives);
  const bool named = !options.instruments.empty();  // inputs are other channels then
  c.inputs = !options.inputs.empty()                    ? with_names(file, header, options.inputs)
             : from_drive || (named && !drives.empty()) ? drives
                                                        : excitations;
  c.outputs =
      options.outputs.empty() ? default_outputs(header) : with_names(file, header, options.outputs);
  c.instruments = named ? with_names(file, header, options.instruments) : excitations;
  // of a channel that is named as input or instrument its role says nothing
  const auto leave_out = [&](const std::vector<int>& others) {
    std::erase_if(c.outputs, [&](int o) { return std::ranges::find(others, o) != others.end(); });
  };
  if (options.outputs.empty() && !options.inputs.empty()) leave_out(c.inputs);
  if (options.outputs.empty() && named) leave_out(c.instruments);
  const std::string advice =
      ": name channels with --inputs and --outputs; the record has " + names_of(header);
  if (c.inputs.empty())
    base::refuse(file, (!options.input_role ? "no channel has the role excitation or drive"
                        : from_drive        ? "no channel has the role drive"
                                            : "no channel has the role excitation") +
                           advice);
  if (c.outputs.empty()) base::refuse(file, "no channel has the role response" + advice);
  for (const int i : c.inputs)
    if (std::ranges::find(c.outputs, i) != c.outputs.end())
      base::refuse(file, fmt::format("channel '{}' is named as input and as output",
                                     header.channels[static_cast<std::size_t>(i)].name));
  const bool from_instrument = c.instruments.size() == c.inputs.size() && c.instruments != c.inputs;
  const bool instrumental = named || (from_instrument && c.inputs != excitations);
  plan.estimator =
      options.estimator.value_or(instrumental ? Estimator::instrumental : Estimator::h1);
  if (plan.estimator == Estimator::instrumental && c.instruments == c.inputs)
    base::refuse(
        file,
        "the instrumental estimate needs inputs other than the excitations: take the drives "
        "(--from-drive), or name them with --inputs");
  if (!from_instrument && plan.estimator != Estimator::instrumental) c.instruments.clear();
  return plan;
}

Plan plan_outputs(const std::string& file, const data::RecordHeader& header,
                  const MeasureOptions& options) {
  Plan plan{.choice = {}, .estimator = Estimator::half_spectra};
  plan.choice.outputs =
      options.outputs.empty() ? default_outputs(header) : with_names(file, header, options.outputs);
  if (plan.choice.outputs.empty())
    base::refuse(file,
                 "no channel has the role response: name channels with --outputs; the record has " +
                     names_of(header));
  return plan;
}

std::vector<std::size_t> used_channels(ChannelChoice& choice) {
  std::vector<int> used;
  for (const auto* list : {&choice.inputs, &choice.outputs, &choice.instruments})
    used.insert(used.end(), list->begin(), list->end());
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (auto* list : {&choice.inputs, &choice.outputs, &choice.instruments})
    for (int& c : *list) c = static_cast<int>(std::ranges::find(used, c) - used.begin());
  return {used.begin(), used.end()};
}

}  // namespace hydrapod::identification
