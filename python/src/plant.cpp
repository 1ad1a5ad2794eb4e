/// The plant step by step, for controllers written in Python.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <span>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support.hpp"

namespace hydrapod::python {

namespace {

using simulation::PlantInput;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A plant with its integrator. Who changes it holds its turn, and its mutex while it does so; who
/// looks at it holds the mutex.
class Stepper {
 public:
  Stepper(const Subject& machine, bool hydraulics, const simulation::IntegratorOptions& options)
      : machine_(machine),
        plant_(machine.file.machine, machine.kind, {.hydraulics = hydraulics}, machine.pose.X_BP),
        rest_(plant_.equilibrium(machine.pose.X_BP)),
        integrator_(plant_, options) {
    reset();
  }

  void reset() {
    input_ = rest_.input;
    integrator_.start(0.0, rest_.x);
  }
  void set_state(const Eigen::VectorXd& x) { integrator_.start(integrator_.time(), x); }
  void advance(const PlantInput& input, double dt) {
    input_ = input;
    integrator_.advance(integrator_.time() + dt, input_);
  }
  [[nodiscard]] simulation::PlantOutput outputs() const {
    return plant_.outputs(integrator_.state().data(), input_);
  }
  [[nodiscard]] spatial::Vector6 displacement() const {
    return simulation::displacement_between(machine_.pose.X_BP,
                                            plant_.pose(integrator_.state().data()));
  }
  [[nodiscard]] const simulation::Plant& plant() const { return plant_; }
  [[nodiscard]] const simulation::Plant::Rest& rest() const { return rest_; }
  [[nodiscard]] const simulation::Integrator& integrator() const { return integrator_; }
  [[nodiscard]] const PlantInput& input() const { return input_; }
  std::mutex& mutex() { return mutex_; }
  std::mutex& turn() { return turn_; }

 private:
  Subject machine_;
  simulation::Plant plant_;
  simulation::Plant::Rest rest_;
  simulation::Integrator integrator_;
  PlantInput input_{};
  std::mutex mutex_{};
  std::mutex turn_{};
};

using Steppers = std::vector<std::shared_ptr<Stepper>>;

/// Plants in whose run this thread asks for progress: they have their turn until the run ends.
thread_local std::vector<const Stepper*> asking;

/// Asks for progress in a run of these plants, without the lock, so that it may look at them.
bool asks_to_stop(const numerics::Progress& watch, double share,
                  std::span<const Stepper* const> running, std::unique_lock<std::mutex>& lock) {
  const auto before = asking.size();
  asking.insert(asking.end(), running.begin(), running.end());
  lock.unlock();
  const bool stop = watch(share);
  lock.lock();
  asking.resize(before);
  return stop;
}

void refuse_in_a_run(const Stepper& stepper) {
  if (std::ranges::find(asking, &stepper) != asking.end())
    throw base::ComputationError(
        "the plant is in a run: progress may look at its time, state and outputs and change "
        "nothing");
}

/// An array of doubles, without a copy where it is one already.
Doubles doubles(const py::handle& given) {
  if (py::isinstance<Doubles>(given)) return py::reinterpret_borrow<Doubles>(given);
  const auto any = py::array::ensure(given);
  const bool real =
      any && std::string_view("fiu").find(any.dtype().kind()) != std::string_view::npos;
  return real ? Doubles::ensure(any) : py::reinterpret_steal<Doubles>(py::handle());
}

/// A masked element has a number below its mask.
void refuse_masked(const py::handle& given, const char* name) {
  const auto* const plain = py::detail::npy_api::get().PyArray_Type_;
  if (Py_TYPE(given.ptr()) == plain || !py::hasattr(given, "mask")) return;
  if (py::module_::import("numpy.ma").attr("is_masked")(given).cast<bool>())
    throw std::invalid_argument(std::string(name) + ": an element is masked; give numbers for all");
}

spatial::Vector6 six(const py::handle& given, const char* name) {
  refuse_masked(given, name);
  const auto array = doubles(given);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + ": expected six real numbers");
  }
  if (array.ndim() != 1 || array.shape(0) != 6)
    throw std::invalid_argument(std::string(name) + ": expected six numbers, got an array of " +
                                std::to_string(array.size()) + " in " +
                                std::to_string(array.ndim()) + " dimensions");
  const spatial::Vector6 values = Eigen::Map<const spatial::Vector6>(array.data());
  if (!values.allFinite())
    throw std::invalid_argument(std::string(name) + ": a number is not finite");
  return values;
}

/// [s], counted so that a call ends.
double step_of(const py::handle& given) {
  constexpr double longest = 10.0;
  const double dt = quantity(given, "s", "dt");
  if (!(dt > 0.0 && dt <= longest))
    throw std::invalid_argument(
        fmt::format("dt: expected more than 0 s and at most 10 s, got {} s", dt));
  return dt;
}

py::array copy_of(const Eigen::VectorXd& x) { return py::array_t<double>(x.size(), x.data()); }

/// work() that looks at the plant.
template <class Work>
auto locked(Stepper& stepper, const Work& work) {
  return without_gil([&] {
    const std::lock_guard lock(stepper.mutex());
    return work();
  });
}

/// work() that changes the plant.
template <class Work>
auto changing(Stepper& stepper, const Work& work) {
  refuse_in_a_run(stepper);
  return without_gil([&] {
    const std::lock_guard turn(stepper.turn());
    const std::lock_guard lock(stepper.mutex());
    return work();
  });
}

PlantInput input_of(const py::object& commands, const py::object& wrench, const Stepper& stepper) {
  PlantInput input{.command = stepper.rest().input.command};
  if (!commands.is_none()) input.command = six(commands, "commands");
  if (!wrench.is_none()) input.wrench = six(wrench, "wrench");
  return input;
}

py::array step(Stepper& stepper, const py::object& commands, const py::object& dt,
               const py::object& wrench) {
  const auto input = input_of(commands, wrench, stepper);
  const double time = step_of(dt);
  const auto displacement = changing(stepper, [&] {
    stepper.advance(input, time);
    return stepper.displacement();
  });
  return py::array_t<double>(6, displacement.data());
}

/// count × 6 commands, one step of `dt` each: count × 6 displacements.
py::array run(Stepper& stepper, const Doubles& commands, const py::object& dt,
              const py::object& progress) {
  if (commands.ndim() != 2 || commands.shape(1) != 6)
    throw std::invalid_argument("commands: expected an array of steps × 6");
  const double time = step_of(dt);
  const auto count = commands.shape(0);
  const double* given = commands.data();
  for (py::ssize_t k = 0; k < 6 * count; ++k)
    if (!std::isfinite(given[k]))
      throw std::invalid_argument("commands: a number is not finite, in step " +
                                  std::to_string(k / 6));
  py::array_t<double> result({count, py::ssize_t{6}});
  double* out = result.mutable_data();
  constexpr py::ssize_t between = 256;  // steps between two looks at signals
  refuse_in_a_run(stepper);
  at_work(progress, [&](const numerics::Progress& watch) {
    const std::lock_guard turn(stepper.turn());
    std::unique_lock lock(stepper.mutex());
    const std::array<const Stepper*, 1> running{&stepper};
    for (py::ssize_t k = 0; k < count; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(count);
      if (k % between == 0 && asks_to_stop(watch, share, running, lock))
        throw base::ComputationError("interrupted after " + std::to_string(k) + " steps");
      stepper.advance({.command = Eigen::Map<const spatial::Vector6>(given + 6 * k)}, time);
      Eigen::Map<spatial::Vector6>(out + 6 * k) = stepper.displacement();
    }
    return 0;
  });
  return result;
}

/// Throws where the plants or the commands of run_all() cannot be.
void check_run(const Steppers& plants, const Doubles& commands) {
  const auto many = static_cast<py::ssize_t>(plants.size());
  if (commands.ndim() != 3 || commands.shape(0) != many || commands.shape(2) != 6)
    throw std::invalid_argument("commands: expected an array of plants × steps × 6, with " +
                                std::to_string(many) + " plants");
  for (std::size_t p = 0; p < plants.size(); ++p) {
    refuse_in_a_run(*plants[p]);
    for (std::size_t other = 0; other < p; ++other)
      if (plants[p] == plants[other])
        throw std::invalid_argument("plants: plants " + std::to_string(other) + " and " +
                                    std::to_string(p) + " are the same");
  }
  const auto steps = commands.shape(1);
  const double* given = commands.data();
  for (py::ssize_t k = 0; k < commands.size(); ++k)
    if (!std::isfinite(given[k]))
      throw std::invalid_argument("commands: a number is not finite, of plant " +
                                  std::to_string(k / std::max<py::ssize_t>(1, 6 * steps)));
}

/// plants × steps × 6 commands, each plant by one thread: plants × steps × 6 displacements. Where a
/// plant's model ends, the rest of its rows is NaN and the message says why.
py::tuple run_all(const Steppers& plants, const Doubles& commands, const py::object& dt,
                  int threads, const py::object& progress) {
  check_run(plants, commands);
  const double time = step_of(dt);
  const auto many = static_cast<py::ssize_t>(plants.size());
  const auto steps = commands.shape(1);
  const double* given = commands.data();
  py::array_t<double> result(std::vector<py::ssize_t>{many, steps, 6});
  double* out = result.mutable_data();
  std::vector<std::string> messages(plants.size());
  std::vector<const Stepper*> running;
  for (const auto& plant : plants) running.push_back(plant.get());
  constexpr py::ssize_t between = 256;  // steps between two looks at signals
  std::atomic<py::ssize_t> stepped{0};
  const auto one = [&](std::size_t p, const numerics::Progress& watch) {
    const std::lock_guard turn(plants[p]->turn());
    std::unique_lock lock(plants[p]->mutex());
    const auto first = static_cast<py::ssize_t>(p) * steps;
    bool stop = false;
    for (py::ssize_t k = first; k < first + steps; ++k) {
      Eigen::Map<spatial::Vector6> into(out + 6 * k);
      into.setConstant(std::numeric_limits<double>::quiet_NaN());
      const double share = static_cast<double>(stepped) / static_cast<double>(many * steps);
      if (k % between == 0) stop = stop || asks_to_stop(watch, share, running, lock);
      ++stepped;
      if (stop || !messages[p].empty()) continue;
      try {
        plants[p]->advance({.command = Eigen::Map<const spatial::Vector6>(given + 6 * k)}, time);
        into = plants[p]->displacement();
      } catch (const base::ComputationError& error) {
        messages[p] = error.what();
      }
    }
    if (stop) messages[p] = "interrupted";
  };
  at_work(progress, [&](const numerics::Progress& watch) {
    return numerics::parallel_for(plants.size(), threads, [&](std::size_t p) { one(p, watch); });
  });
  return py::make_tuple(result, messages);
}

py::dict outputs(Stepper& stepper) {
  const auto [out, displacement] =
      locked(stepper, [&] { return std::pair(stepper.outputs(), stepper.displacement()); });
  const auto of = [](const auto& values) { return py::array_t<double>(6, values.data()); };
  const auto legs = [&](auto get) {
    std::vector<double> values;
    for (const auto& leg : out.legs) values.push_back(get(leg));
    return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
  };
  py::dict result;
  result["displacement"] = of(displacement);
  result["twist"] = of(out.twist);
  result["acceleration"] = of(out.acceleration);
  result["length"] = legs([](const auto& leg) { return leg.length; });
  result["length_rate"] = legs([](const auto& leg) { return leg.length_rate; });
  result["cap_pressure"] = legs([](const auto& leg) { return leg.cap_pressure; });
  result["rod_pressure"] = legs([](const auto& leg) { return leg.rod_pressure; });
  result["spool"] = legs([](const auto& leg) { return leg.spool; });
  result["nut"] = legs([](const auto& leg) { return leg.nut; });
  result["motor_speed"] = legs([](const auto& leg) { return leg.motor_speed; });
  result["torque"] = legs([](const auto& leg) { return leg.torque; });
  result["oil_force"] = legs([](const auto& leg) { return leg.oil_force; });
  result["supply_pressure"] = out.supply_pressure;
  return result;
}

py::tuple linearise(Stepper& stepper) {
  const auto linear = locked(stepper, [&] {
    return std::make_unique<simulation::LinearPlant>(
        stepper.plant().linearise(stepper.integrator().state(), stepper.input()));
  });
  const auto copied = [](const Eigen::MatrixXd& matrix) {
    py::array_t<double> array({matrix.rows(), matrix.cols()});
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      for (Eigen::Index j = 0; j < matrix.cols(); ++j) array.mutable_at(i, j) = matrix(i, j);
    return array;
  };
  return py::make_tuple(copied(linear->A), copied(linear->B), copied(linear->C), copied(linear->D),
                        stepper.plant().tangent_names(), stepper.plant().linear_output_names());
}

std::shared_ptr<Stepper> make(const Subject& machine, bool hydraulics, const std::string& method,
                              double fixed_step, double tolerance) {
  simulation::IntegratorOptions options{
      .relative_tolerance = tolerance, .absolute_tolerance = tolerance, .fixed_step = fixed_step};
  constexpr std::array methods{simulation::Method::fixed, simulation::Method::adaptive,
                               simulation::Method::exponential};
  options.method = methods[choice("integrator", method, {"fixed", "adaptive", "exponential"})];
  return without_gil([&] { return std::make_shared<Stepper>(machine, hydraulics, options); });
}

void set_state(Stepper& stepper, const Doubles& x) {
  const auto size = stepper.plant().layout().size;
  if (x.ndim() != 1 || x.shape(0) != size)
    throw std::invalid_argument("state: expected " + std::to_string(size) + " numbers");
  const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(x.data(), size);
  Eigen::VectorXd rate(size);
  const bool possible =
      values.allFinite() && changing(stepper, [&] {
        if (!stepper.plant().derivative(0.0, values.data(), stepper.input(), rate.data()))
          return false;
        stepper.set_state(values);
        return true;
      });
  if (!possible)
    throw std::invalid_argument(
        "state: is none of this plant (not finite, or a leg does not close)");
}

}  // namespace

void add_plant(py::module_& module) {
  py::class_<Stepper, std::shared_ptr<Stepper>>(module, "Plant")
      .def(py::init(&make), py::arg("machine"), py::arg("hydraulics"), py::arg("integrator"),
           py::arg("fixed_step"), py::arg("tolerance"))
      .def("step", &step, py::arg("commands"), py::arg("dt"), py::arg("wrench") = py::none())
      .def("run", &run, py::arg("commands"), py::arg("dt"), py::arg("progress") = py::none())
      .def("reset",
           [](Stepper& s) {
             changing(s, [&] {
               s.reset();
               return 0;
             });
           })
      .def("linearise", &linearise)
      .def("outputs", &outputs)
      .def_property(
          "state",
          [](Stepper& s) {
            const auto x = locked(s, [&] { return Eigen::VectorXd(s.integrator().state()); });
            return copy_of(x);
          },
          &set_state)
      .def_property_readonly(
          "time", [](Stepper& s) { return locked(s, [&] { return s.integrator().time(); }); })
      .def_property_readonly(
          "rest_commands",
          [](const Stepper& s) { return py::array_t<double>(6, s.rest().input.command.data()); })
      .def_property_readonly("state_names",
                             [](const Stepper& s) { return s.plant().state_names(); })
      .def_property_readonly("state_units",
                             [](const Stepper& s) { return s.plant().state_units(); });
  module.def("run_plants", &run_all);
}

}  // namespace hydrapod::python
