#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>

#include "hydrapod/base/error.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

constexpr double least_regularity = 1e-6;  // smallest by largest singular value

MatrixXd inverted(const MatrixXd& J, const char* what) {
  // rotations as motions of points one sensor radius away, so that the test has no units
  const Eigen::JacobiSVD<MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& s = svd.singularValues();
  if (s.size() < 6 || !(s[5] > least_regularity * s[0]))
    throw base::ComputationError(
        fmt::format("the {} do not determine all six directions of the platform", what));
  return svd.solve(MatrixXd::Identity(J.rows(), J.rows()));
}

/// "m/s^2" gives "rad/s^2", "1" gives "1/m".
std::string angular(const std::string& unit) {
  return unit.starts_with('m') ? "rad" + unit.substr(1) : unit + "/m";
}

/// M S Mᵀ for all lines, packed; `spectrum`: S at a line.
template <class Spectrum>
void mix(const MatrixXd& M, const Spectrum& spectrum, MatrixXd& re, MatrixXd& im) {
  const Index lines = re.rows(), to = M.rows();
  re.resize(lines, to * (to + 1) / 2);
  im.resize(lines, re.cols());
  for (Index line = 0; line < lines; ++line) {
    const MatrixXcd T = M * spectrum(line) * M.transpose();
    for (Index i = 0, pair = 0; i < to; ++i)
      for (Index j = 0; j <= i; ++j, ++pair) {
        re(line, pair) = T(i, j).real();
        im(line, pair) = i == j ? 0.0 : T(i, j).imag();
      }
  }
}

}  // namespace

MatrixXd platform_from_legs(const model::Machine& machine, const spatial::Pose& X_BP,
                            const spatial::Vector3& p_BQ) {
  return inverted(kinematics::leg_jacobian(kinematics::inverse_kinematics(machine, X_BP), p_BQ),
                  "legs at this pose");
}

MatrixXd platform_from_accelerometers(const std::vector<LinearSensor>& sensors,
                                      const spatial::Vector3& p_BQ) {
  MatrixXd J(static_cast<Index>(sensors.size()), 6);
  for (Index k = 0; k < J.rows(); ++k) {
    const auto& sensor = sensors[static_cast<size_t>(k)];
    J.row(k) << sensor.axis.transpose(), (sensor.position - p_BQ).cross(sensor.axis).transpose();
  }
  return inverted(J, "accelerometers");
}

CrossSpectra to_platform(const CrossSpectra& spectra, const std::vector<int>& channels,
                         const MatrixXd& map, const std::string& prefix) {
  const auto count = static_cast<Index>(spectra.channels.size());
  CrossSpectra result = spectra;
  result.channels.clear();
  result.health.clear();
  std::vector<int> kept;
  for (int c = 0; c < count; ++c)
    if (std::ranges::find(channels, c) == channels.end()) kept.push_back(c);
  MatrixXd M = MatrixXd::Zero(static_cast<Index>(kept.size()) + 6, count);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    M(static_cast<Index>(k), kept[k]) = 1.0;
    result.channels.push_back(spectra.channels[static_cast<size_t>(kept[k])]);
    result.health.push_back(spectra.health[static_cast<size_t>(kept[k])]);
  }
  for (std::size_t k = 0; k < channels.size(); ++k)
    M.col(channels[k]).tail(6) = map.col(static_cast<Index>(k));
  const auto& first = spectra.channels[static_cast<size_t>(channels[0])];
  ChannelHealth worst = spectra.health[static_cast<size_t>(channels[0])];
  for (const int c : channels)
    worst.missing = std::max(worst.missing, spectra.health[static_cast<size_t>(c)].missing);
  // of the legs, not of what is made of them
  worst.at_limit = worst.in_flat_tops = 0;
  worst.cut_below = worst.cut_above = std::numeric_limits<double>::quiet_NaN();
  for (int d = 0; d < 6; ++d) {
    result.channels.push_back({.name = prefix + spatial::direction_name(d),
                               .unit = d < 3 ? first.unit : angular(first.unit),
                               .direction = static_cast<data::Direction>(d + 1),
                               .role = first.role});
    result.health.push_back(worst);
  }
  mix(
      M, [&](Index line) { return spectra.at(line); }, result.re, result.im);
  if (result.noise_re.size() > 0)
    mix(
        M, [&](Index line) { return spectra.noise_at(line); }, result.noise_re, result.noise_im);
  return result;
}

std::optional<std::vector<int>> six_channels(const std::vector<data::Channel>& channels,
                                             data::Role role, data::Direction first,
                                             const std::vector<std::string_view>& units) {
  std::vector<int> six(6, -1);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto& channel = channels[c];
    const int at = static_cast<int>(channel.direction) - static_cast<int>(first);
    if (channel.role != role || at < 0 || at > 5) continue;
    if (!units.empty() && std::ranges::find(units, channel.unit) == units.end()) continue;
    if (six[static_cast<size_t>(at)] >= 0) return {};
    six[static_cast<size_t>(at)] = static_cast<int>(c);
  }
  if (std::ranges::find(six, -1) != six.end()) return {};
  return six;
}

}  // namespace hydrapod::identification
