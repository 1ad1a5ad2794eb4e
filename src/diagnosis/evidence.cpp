#include "evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "hydrapod/base/error.hpp"
#include "hydrapod/diagnosis/resonances.hpp"

namespace hydrapod::diagnosis {

namespace {

using calibration::ModeTarget;
using calibration::Targets;

/// What the platform mostly does in a shape, by kinetic energy.
int main_direction(const model::Machine& machine, const ModeTarget& mode) {
  const auto pose = std::find_if(machine.poses.begin(), machine.poses.end(),
                                 [&](const auto& p) { return p.name == mode.pose; });
  if (pose == machine.poses.end()) return 0;  // said by the fit
  const auto& R = pose->X_BP.R_BP;
  spatial::Matrix6 M = spatial::Matrix6::Zero();
  M.topLeftCorner<3, 3>().diagonal().setConstant(machine.platform.mass);
  M.bottomRightCorner<3, 3>() = R * machine.platform.inertia * R.transpose();
  spatial::Vector6 motion = *mode.shape;
  if (mode.shape_point)
    motion.head<3>() +=
        motion.tail<3>().cross(R * (machine.platform.mass_center - *mode.shape_point));
  Eigen::Index main = 0;
  motion.cwiseProduct(M * motion).maxCoeff(&main);
  return static_cast<int>(main);
}

}  // namespace

Targets weighted_targets(const model::MachineFile& file, const Targets& measured,
                         const DiagnoseOptions& options) {
  Targets targets = measured;
  targets.plan = {};
  targets.deviations_given = true;
  for (auto& mode : targets.modes) {
    const double own = measured.deviations_given ? mode.deviation : 0.0;
    mode.deviation = std::hypot(own, options.frequency_error * mode.omega);
    if (mode.shape) {
      mode.shape_deviation = std::hypot(mode.shape_deviation, options.shape_error);
      if (!mode.direction) mode.direction = main_direction(file.machine, mode);
    }
    if (mode.damping && options.damping)
      mode.damping_deviation =
          std::hypot(mode.damping_deviation, options.damping_error * *mode.damping);
    if (!options.damping) mode.damping.reset();
  }
  return targets;
}

int values_in(const Targets& targets) {
  int count = 0;
  for (const auto& mode : targets.modes) count += 1 + (mode.damping ? 1 : 0) + (mode.shape ? 5 : 0);
  return count;
}

dynamics::ModelKind Evidence::kind_with(const std::vector<std::size_t>& blamed) const {
  const bool rings = std::any_of(blamed.begin(), blamed.end(),
                                 [&](std::size_t k) { return suspects_[k].needs_rings; });
  return rings ? dynamics::ModelKind::full : kind_;
}

Explanation Evidence::as_stated() const {
  Explanation e{.name = "the machine as stated", .kind = kind_};
  e.fit = calibration::compare(file_, targets_, kind_);
  if (!e.fit.fitted) throw base::ComputationError("the machine as stated has no modes");
  e.misfit = e.fit.misfit;
  return e;
}

Explanation Evidence::rigid() const {
  constexpr double like_rigid = 1e15;  // [N/m], [N m/rad]
  Explanation e{.rigid = true, .name = "the rigid calculation", .kind = kind_};
  const auto set = [&](const std::string& path, double value) {
    e.overrides.push_back(fmt::format("{}={:.17g}", path, value));
  };
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = file_.machine.legs[static_cast<std::size_t>(i)];
    const auto path = [&](const char* rest) { return fmt::format("leg.{}.{}", i + 1, rest); };
    constexpr double stiffer = 1e6;
    set(path("guide_sleeve.stiffness"), stiffer * leg.guide_sleeve.stiffness);
    if (leg.piston_ring) set(path("piston_ring.stiffness"), stiffer * leg.piston_ring->stiffness);
    if (leg.gimbal_stiffness) set(path("gimbal_stiffness"), like_rigid);
  }
  if (file_.machine.base_mount)
    for (int k = 0; k < 6; ++k)
      if (file_.machine.base_mount->stiffness[static_cast<std::size_t>(k)])
        set(fmt::format("base.mount.stiffness.{}", direction_name(k)), like_rigid);
  model::MachineFile file = file_;
  file.overrides.insert(file.overrides.end(), e.overrides.begin(), e.overrides.end());
  e.fit = calibration::compare(file, targets_, kind_);
  if (!e.fit.fitted) throw base::ComputationError("the rigid machine has no modes");
  e.misfit = e.fit.misfit;
  return e;
}

/// Numbers of all legs may have to be found over decades, and the pairing of modes changes on the
/// way; what is known of one suspect is a good start for most others.
int Evidence::starts_for(const std::vector<std::size_t>& blamed, bool known) const {
  constexpr int very_wide = 128, wide = 16, ordinary = 6, few = 3;
  const bool single_numbers = std::ranges::all_of(
      blamed, [&](std::size_t k) { return suspects_[k].free.size() == 1 && !suspects_[k].leg; });
  const auto seals = std::ranges::count_if(blamed, [&](std::size_t k) {
    return suspects_[k].family == "guide sleeves" || suspects_[k].family == "piston rings";
  });
  if (single_numbers && seals == 2) return very_wide;
  if (single_numbers && (blamed.size() == 1 || seals == 1)) return wide;
  return known ? few : ordinary;
}

Explanation Evidence::fitted(const std::vector<std::size_t>& blamed, const Targets& targets,
                             const Explanation* known, const calibration::Progress& stop) const {
  Explanation e{.suspects = blamed, .kind = kind_with(blamed)};
  calibration::Plan plan;
  plan.options.starts = starts_for(blamed, known != nullptr);
  plan.options.threads = 1;
  plan.options.loss = calibration::Loss::squares;
  for (const auto k : blamed) {
    const auto& suspect = suspects_[k];
    e.name = plan.free.empty() ? suspect.name : e.name + " and " + suspect.name;
    e.overrides.insert(e.overrides.end(), suspect.overrides.begin(), suspect.overrides.end());
    for (auto free : suspect.free) {
      if (known != nullptr)
        for (const auto& p : known->fit.parameters)
          if (p.paths == free.paths)
            free.start = fmt::format("{:.17g}", std::clamp(p.value, p.lower, p.upper));
      plan.free.push_back(free);
    }
  }
  model::MachineFile file = file_;
  file.overrides.insert(file.overrides.end(), e.overrides.begin(), e.overrides.end());
  e.fit = calibration::calibrate(file, targets, plan, e.kind, stop).best();
  e.misfit = e.fit.misfit;
  e.parameters = static_cast<int>(plan.free.size());
  return e;
}

Explanation Evidence::explain(const std::vector<std::size_t>& blamed, const Explanation* known,
                              const calibration::Progress& stop) const {
  auto e = fitted(blamed, targets_, known, stop);
  static_cast<void>(file_of(file_, e));  // numbers that no machine has explain nothing
  return e;
}

void Evidence::widen(Explanation& e, double frequency_error) const {
  Targets shifted = targets_;
  for (auto& mode : shifted.modes) mode.omega *= 1.0 + frequency_error;
  const auto other = fitted(e.suspects, shifted, &e, {});
  for (std::size_t k = 0; k < e.fit.parameters.size(); ++k) {
    auto& p = e.fit.parameters[k];
    p.deviation = std::hypot(p.deviation, other.fit.parameters[k].value - p.value);
  }
}

Explanation Evidence::explain_some(std::size_t blamed, const Targets& some,
                                   const calibration::Progress& stop) const {
  return fitted({blamed}, some, nullptr, stop);
}

model::MachineFile file_of(const model::MachineFile& file, const Explanation& explanation) {
  std::vector<std::string> overrides = file.overrides;
  overrides.insert(overrides.end(), explanation.overrides.begin(), explanation.overrides.end());
  for (const auto& p : explanation.fit.parameters)
    for (const auto& path : p.paths) overrides.push_back(fmt::format("{}={:.17g}", path, p.value));
  const auto anything = [](const model::Machine&) { return std::vector<model::Finding>{}; };
  return model::parse_machine(file.text, "machine", overrides, anything);
}

model::Machine machine_of(const model::MachineFile& file, const Explanation& explanation) {
  return file_of(file, explanation).machine;
}

void for_all(std::size_t count, int threads, const std::function<void(std::size_t)>& task,
             const std::function<bool(double)>& stop) {
  const auto wanted = threads > 0 ? static_cast<unsigned>(threads)
                                  : std::max(1U, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < count && !stopped; i = next++) {
      try {
        task(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        stopped = true;
      }
      const std::lock_guard lock(mutex);
      if (stop && stop(static_cast<double>(++done) / static_cast<double>(count))) stopped = true;
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned k = 1; k < std::min<std::size_t>(wanted, count); ++k) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace hydrapod::diagnosis
