/// Kinematics at many poses; statics and buckling of one; signals as samples.

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/signals/signals.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using Machine = std::shared_ptr<Subject>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Shape = std::vector<py::ssize_t>;

/// Rows of six finite numbers.
struct Rows {
  const double* first{};
  py::ssize_t count{};
  [[nodiscard]] spatial::Vector6 operator[](py::ssize_t k) const {
    return Eigen::Map<const spatial::Vector6>(first + 6 * k);
  }
};

Rows rows_of(const Doubles& given, const char* name) {
  if (given.ndim() != 2 || given.shape(1) != 6)
    throw std::invalid_argument(std::string(name) + ": expected an array of poses × 6");
  const Rows rows{given.data(), given.shape(0)};
  for (py::ssize_t k = 0; k < 6 * rows.count; ++k)
    if (!std::isfinite(rows.first[k]))
      throw std::invalid_argument(std::string(name) + ": a number is not finite, in row " +
                                  std::to_string(k / 6));
  return rows;
}

/// As the text of a pose has it: roll, pitch and yaw about axes of the base.
spatial::Pose moved(const spatial::Pose& from, const spatial::Vector6& d) {
  return {spatial::rotation_from_rpy(d.tail<3>()) * from.R_BP, from.p_BP + d.head<3>()};
}

py::array leg_lengths(const Machine& machine, const Doubles& displacements) {
  const auto rows = rows_of(displacements, "displacements");
  py::array_t<double> result(Shape{rows.count, 6});
  double* out = result.mutable_data();
  without_gil([&] {
    for (py::ssize_t k = 0; k < rows.count; ++k)
      Eigen::Map<spatial::Vector6>(out + 6 * k) =
          kinematics::leg_lengths(machine->file.machine, moved(machine->pose.X_BP, rows[k]));
    return 0;
  });
  return result;
}

py::array leg_jacobian(const Machine& machine, const Doubles& displacements) {
  const auto rows = rows_of(displacements, "displacements");
  py::array_t<double> result(Shape{rows.count, 6, 6});
  double* out = result.mutable_data();
  without_gil([&] {
    for (py::ssize_t k = 0; k < rows.count; ++k) {
      const auto pose = moved(machine->pose.X_BP, rows[k]);
      const auto legs = kinematics::inverse_kinematics(machine->file.machine, pose);
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(out + 36 * k) =
          kinematics::leg_jacobian(legs, pose.p_BP);
    }
    return 0;
  });
  return result;
}

/// Poses (NaN where no pose was found) and the largest residual of each [m].
py::tuple forward_kinematics(const Machine& machine, const Doubles& lengths,
                             const Doubles& starts) {
  const auto rows = rows_of(lengths, "lengths"), from = rows_of(starts, "start");
  if (from.count != 1 && from.count != rows.count)
    throw std::invalid_argument("start: expected one displacement, or one per row of lengths");
  py::array_t<double> poses(Shape{rows.count, 6}), residuals(Shape{rows.count});
  double* pose = poses.mutable_data();
  double* residual = residuals.mutable_data();
  without_gil([&] {
    for (py::ssize_t k = 0; k < rows.count; ++k) {
      const auto start = moved(machine->pose.X_BP, from[from.count == 1 ? 0 : k]);
      const auto found = kinematics::forward_kinematics(machine->file.machine, rows[k], start);
      Eigen::Map<spatial::Vector6> into(pose + 6 * k);
      into.setConstant(std::numeric_limits<double>::quiet_NaN());
      if (found.status == kinematics::ForwardStatus::converged)
        into = simulation::displacement_between(machine->pose.X_BP, found.X_BP);
      residual[k] = found.residual;
    }
    return 0;
  });
  return py::make_tuple(poses, residuals);
}

template <class Vector>
py::array copied(const Vector& values) {
  return array_of(std::vector<double>(values.data(), values.data() + values.size()));
}

py::dict pose_quality(const Machine& machine) {
  const auto quality = kinematics::pose_quality(machine->file.machine, machine->pose.X_BP);
  py::dict result;
  result["characteristic_length"] = quality.characteristic_length;
  result["singular_values"] = copied(quality.singular_values);
  result["condition"] = quality.condition;
  result["weakest_direction"] = copied(quality.weakest_direction);
  return result;
}

py::dict equilibrium(const Machine& machine) {
  const auto found = without_gil([&] {
    return dynamics::static_equilibrium(machine->file.machine, machine->pose.X_BP, machine->kind);
  });
  using Status = dynamics::StaticsStatus;
  if (found.status == Status::folded)
    throw base::ComputationError("no static equilibrium: a leg folds under its load");
  if (found.status != Status::converged)
    throw base::ComputationError("no static equilibrium was found at this pose");
  std::vector<double> forces, flexible;
  for (const auto& leg : found.legs) {
    forces.push_back(leg.oil_force);
    for (int k = 0; k < 4; ++k) flexible.push_back(leg.flexible[k]);
  }
  py::dict result;
  result["oil_force"] = array_of(forces);
  result["flexible"] = array_of(flexible, {model::leg_count, 4});
  result["residual"] = found.residual;
  result["iterations"] = found.iterations;
  return result;
}

py::dict buckling(const Machine& machine) {
  const auto found = without_gil([&] {
    return dynamics::buckling_payload(machine->file.machine, machine->pose.X_BP, machine->kind);
  });
  constexpr std::array words{"found", "not_found", "buckled"};
  const bool none = found.status == dynamics::BucklingStatus::not_found;
  const auto lengths = kinematics::leg_lengths(machine->file.machine, machine->pose.X_BP);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> strength, euler;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto column = dynamics::column_strength(
        machine->file.machine.legs[static_cast<std::size_t>(i)], lengths[i]);
    strength.push_back(column ? column->strength : unknown);
    euler.push_back(column ? column->euler : unknown);
  }
  py::dict result;
  result["status"] = words[static_cast<std::size_t>(found.status)];
  result["payload"] = none ? unknown : found.payload;
  result["limit_point"] = found.limit_point;
  result["column_strength"] = array_of(strength);
  result["euler_force"] = array_of(euler);
  return result;
}

/// Values and rates, samples × 6.
py::tuple sample_signals(const std::vector<std::string>& texts, double rate,
                         const std::optional<double>& duration, const std::string& unit,
                         bool excitation, std::uint64_t seed) {
  const std::array all{signals::displacement_units, signals::drive_units, signals::wrench_units};
  const auto units = all[choice("unit", unit, {"displacement", "drive", "wrench"})];
  const auto read = signals::read_signals(
      texts, {.argument = "signals", .units = units, .rate = rate, .excitation = excitation});
  const double seconds = duration.value_or(signals::natural_duration(read));
  constexpr double most = 1e8;
  if (!(seconds > 0.0 && seconds * rate <= most))
    throw std::invalid_argument("duration: expected more than 0 s and at most 1e8 samples");
  const auto count = static_cast<py::ssize_t>(std::llround(seconds * rate));
  py::array_t<double> values(Shape{count, 6}), rates(Shape{count, 6});
  double* value = values.mutable_data();
  double* change = rates.mutable_data();
  constexpr py::ssize_t between = 10000;  // samples between two looks at signals
  at_work(py::none(), [&](const numerics::Progress& watch) {
    signals::Generator generator(read, rate, seed);
    for (py::ssize_t k = 0; k < count; ++k) {
      if (k % between == 0 && watch(static_cast<double>(k) / static_cast<double>(count)))
        throw base::ComputationError("interrupted");
      const auto sample = generator.next();
      Eigen::Map<spatial::Vector6>(value + 6 * k) = sample.value;
      Eigen::Map<spatial::Vector6>(change + 6 * k) = sample.rate;
    }
    return 0;
  });
  std::vector<std::string> full;
  for (const auto& one : read) full.push_back(signals::signal_text(one, units));
  return py::make_tuple(values, rates, full, signals::period_samples(read, rate));
}

}  // namespace

void add_kinematics(py::module_& module) {
  module.def("leg_lengths", &leg_lengths);
  module.def("leg_jacobian", &leg_jacobian);
  module.def("forward_kinematics", &forward_kinematics);
  module.def("pose_quality", &pose_quality);
  module.def("static_equilibrium", &equilibrium);
  module.def("buckling", &buckling);
  module.def("sample_signals", &sample_signals);
}

}  // namespace hydrapod::python
