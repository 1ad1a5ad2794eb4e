#include "hydrapod/simulation/command.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "signals.hpp"

namespace hydrapod::simulation {

namespace {

/// The angular velocity in base axes of Rz(rz) Ry(ry) Rx(rx).
Eigen::Vector3d angular_velocity(const Eigen::Vector3d& rpy, const Eigen::Vector3d& rates) {
  const double sy = std::sin(rpy.y()), cy = std::cos(rpy.y());
  const double sz = std::sin(rpy.z()), cz = std::cos(rpy.z());
  return rates.x() * Eigen::Vector3d(cz * cy, sz * cy, -sy) +
         rates.y() * Eigen::Vector3d(-sz, cz, 0.0) + rates.z() * Eigen::Vector3d::UnitZ();
}

class Sum final : public Signal {
 public:
  explicit Sum(std::vector<std::unique_ptr<Signal>> parts) : parts_(std::move(parts)) {}
  void restart() override {
    for (const auto& part : parts_) part->restart();
  }
  Displacement next() override {
    Displacement sum;
    for (const auto& part : parts_) {
      const Displacement one = part->next();
      sum.value += one.value;
      sum.rate += one.rate;
    }
    return sum;
  }

 private:
  std::vector<std::unique_ptr<Signal>> parts_;
};

/// "z 5 mm, rx 1 deg" of what is not zero.
std::string directions_text(const Vector6& values) {
  constexpr std::array names{"x", "y", "z", "rx", "ry", "rz"};
  std::string text;
  for (int i = 0; i < 6; ++i) {
    if (values[i] == 0.0) continue;
    const double shown = i < 3 ? 1e3 * values[i] : values[i] * 180.0 / std::numbers::pi;
    text += fmt::format("{}{} {:.4g} {}", text.empty() ? "" : ", ", names[i], shown,
                        i < 3 ? "mm" : "deg");
  }
  return text.empty() ? "nothing" : text;
}

struct Describe {
  std::string operator()(const Step& s) const {
    return fmt::format("step of {} at {:.4g} s", directions_text(s.size), s.at);
  }
  std::string operator()(const Sine& s) const {
    return fmt::format("sine of {}, {:.4g} Hz", directions_text(s.amplitude), s.frequency);
  }
  std::string operator()(const Sweep& s) const {
    return fmt::format("sweep of {}, {:.4g} to {:.4g} Hz in {:.4g} s", directions_text(s.amplitude),
                       s.from, s.to, s.duration);
  }
  std::string operator()(const Multisine& s) const {
    return fmt::format("multisine of RMS {}, {:.4g} to {:.4g} Hz, period {:.4g} s, seed {}",
                       directions_text(s.rms), s.from, s.to, s.period, s.seed);
  }
  std::string operator()(const Noise& s) const {
    return fmt::format("noise of RMS {}, {:.4g} to {:.4g} Hz, seed {}", directions_text(s.rms),
                       s.from, s.to, s.seed);
  }
  std::string operator()(const Trajectory& s) const {
    return fmt::format("trajectory of {} points{}", s.points.size(),
                       s.source.empty() ? "" : " from " + s.source);
  }
};

}  // namespace

control::Command command_at(const Pose& operating, const Displacement& displacement) {
  const Eigen::Vector3d rpy = displacement.value.tail<3>();
  control::Command command;
  command.X_BP = {spatial::rotation_from_rpy(rpy) * operating.R_BP,
                  operating.p_BP + displacement.value.head<3>()};
  command.velocity << displacement.rate.head<3>(),
      angular_velocity(rpy, displacement.rate.tail<3>());
  return command;
}

void require(bool sound, const char* name, double value, const std::string& expected) {
  if (!sound)
    throw std::invalid_argument(fmt::format("{} is {:.6g}, expected {}", name, value, expected));
}

void require_band(const char* signal, double from, double to, double sample_time, bool from_zero) {
  const double half = 0.5 / sample_time;
  const std::string name = fmt::format("{}: from", signal);
  require(std::isfinite(from) && (from_zero ? from >= 0.0 : from > 0.0), name.c_str(), from,
          from_zero ? "0 Hz or more" : "more than 0 Hz");
  require(
      std::isfinite(to) && to > 0.0 && to < half, fmt::format("{}: to", signal).c_str(), to,
      fmt::format("more than 0 and less than {:.6g} Hz, half the controller's sample rate", half));
}

Fade fade_at(double time, double duration) {
  if (duration <= 0.0 || time >= duration) return {time >= 0.0 ? 1.0 : 0.0, 0.0};
  if (time <= 0.0) return {0.0, 0.0};
  const double r = time / duration;
  return {r * r * r * (10.0 + r * (-15.0 + 6.0 * r)),
          30.0 * r * r * (1.0 - r) * (1.0 - r) / duration};
}

Displacement faded(const Displacement& signal, const Fade& fade) {
  return {fade.value * signal.value, fade.value * signal.rate + fade.rate * signal.value};
}

std::unique_ptr<Signal> make_signal(const std::vector<CommandSpec>& specs, double sample_time) {
  require(std::isfinite(sample_time) && sample_time > 0.0, "sample_time", sample_time,
          "more than 0");
  std::vector<std::unique_ptr<Signal>> parts;
  for (const auto& spec : specs)
    parts.push_back(
        std::visit([&](const auto& one) { return make_signal(one, sample_time); }, spec));
  return std::make_unique<Sum>(std::move(parts));
}

std::string description(const CommandSpec& spec) { return std::visit(Describe{}, spec); }

}  // namespace hydrapod::simulation
