#include "compared_responses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::tasks {

namespace {

using Response = report::ComparedThing::Response;

bool same(const Response& a, const Response& b) { return a.name == b.name && a.unit == b.unit; }

/// Those of `all` at `H`, lines that are not finite left out. Of several measurements the first
/// counts that has a response.
void add_responses(const data::FrequencyResponses& all,
                   const data::PerLine<Eigen::MatrixXcd>& values, Side& side) {
  constexpr std::size_t most = 12;
  const bool direct = all.inputs.size() == all.outputs.size();
  std::size_t added = 0;
  for (std::size_t o = 0; o < all.outputs.size(); ++o)
    for (std::size_t i = 0; i < all.inputs.size(); ++i) {
      if ((direct && i != o) || added >= most) continue;
      ++added;
      Response response{.name = fmt::format("{} from {}", all.outputs[o].name, all.inputs[i].name),
                        .unit = report::response_unit(all.outputs[o].unit, all.inputs[i].unit)};
      for (std::size_t k = 0; k < values.size(); ++k) {
        const std::complex<double> H =
            values[k](static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i));
        if (!std::isfinite(H.real()) || !std::isfinite(H.imag())) continue;
        response.frequency.push_back(all.frequency[k]);
        response.H.push_back(H);
      }
      const bool known = std::ranges::any_of(
          side.thing.responses, [&](const auto& other) { return same(other, response); });
      if (!known && !response.H.empty()) side.thing.responses.push_back(std::move(response));
    }
}

/// As the estimate shows them: averages at a + iω, brought to the axis by what a model says of the
/// difference, without the window of the averages.
observation::ShownResponses shown_on_axis(const data::FrequencyResponses& measured,
                                          const observation::ComparisonFrame& frame,
                                          const observation::Observation& seen,
                                          const spatial::Vector3& p_BF) {
  auto shown = observation::shown_responses(measured, frame, seen, p_BF);
  if (!(measured.shift > 0.0) || !shown.why_not.empty()) return shown;
  auto plain = measured;
  plain.taper.resize(0);
  const auto beside = observation::shown_responses(plain, frame, seen, p_BF);
  plain.shift = 0.0;
  const auto on_axis = observation::shown_responses(plain, frame, seen, p_BF);
  for (std::size_t k = 0; k < shown.H.size(); ++k) shown.H[k] += on_axis.H[k] - beside.H[k];
  return shown;
}

}  // namespace

void add_measured_responses(MeasuredResponses measured, Side& side) {
  const auto on_axis = data::brought_to_axis(measured.responses);
  if (on_axis.shift > 0.0) return;  // no model brings them to the axis
  add_responses(on_axis, on_axis.H, side);
  side.responses = std::move(measured);
}

void add_calculated_responses(const Machine& machine, int points, Side& side) {
  report::Bode bode;
  try {
    bode = tasks::bode(machine, {.points = points});
  } catch (const base::ComputationError&) {
    return;  // no stable mode, and no band to draw
  }
  for (int d = 0; d < 6; ++d) {
    Response response{.name = fmt::format("{} from {} {}", spatial::direction_names[d],
                                          d < 3 ? "force" : "moment", spatial::direction_names[d]),
                      .unit = report::response_unit(bode.options.output, d, d)};
    for (std::size_t k = 0; k < bode.omega.size(); ++k) {
      response.frequency.push_back(bode.omega[k] / base::two_pi);
      response.H.push_back(bode.real[k](d, d));
    }
    side.thing.responses.push_back(std::move(response));
  }
}

void add_shown_responses(const observation::Observation& seen, const Side& measured,
                         Side& machine) {
  if (!measured.responses) return;
  auto frame = *machine.frame;
  // the measured point is on the platform, and forces of the test rig act there
  if (measured.responses->p_PQ) frame.p_BQ = frame.X_BP * *measured.responses->p_PQ;
  const auto shown = shown_on_axis(measured.responses->responses, frame, seen, frame.p_BQ);
  if (shown.why_not.empty())
    add_responses(measured.responses->responses, shown.H, machine);
  else
    machine.thing.description +=
        fmt::format("; no responses beside those of {}: {}", measured.thing.name, shown.why_not);
}

void keep_shared_responses(std::vector<report::ComparedThing>& things) {
  const auto copies = things;
  for (auto& thing : things)
    std::erase_if(thing.responses, [&](const Response& response) {
      return std::ranges::count_if(copies, [&](const auto& other) {
               return std::ranges::any_of(other.responses,
                                          [&](const Response& r) { return same(r, response); });
             }) < 2;
    });
}

}  // namespace hydrapod::tasks
