/// SDF and URDF hold each joint's spring alone; MJCF holds the coupled springs of bent legs. At
/// rest both push the same.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "hydrapod/exchange/exchange.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::exchange {
namespace {

MultibodyFile file_of_bent_legs(MultibodyFormat format) {
  auto machine = test::symmetric_machine(9.81);
  for (auto& leg : machine.legs) leg.guide_sleeve.damping = 217.0;
  machine.damping.modal_ratio = 0.0;
  return multibody_file(machine, machine.neutral(), dynamics::ModelKind::guide, format);
}

double mjcf_attribute(const std::string& element, const std::string& name) {
  std::smatch found;
  if (!std::regex_search(element, found, std::regex(name + "='([^']*)'"))) return 0.0;
  return std::stod(found[1]);
}

struct FeltAtRest {
  double force{}, damping{};
};

/// What a joint of MJCF feels at rest, of its own spring and of the tendons on it.
FeltAtRest felt_in_mjcf(const std::string& text, const std::string& joint) {
  std::smatch own;
  EXPECT_TRUE(std::regex_search(text, own, std::regex("<joint name='" + joint + "'[^>]*>")));
  FeltAtRest sum{mjcf_attribute(own[0], "stiffness") * mjcf_attribute(own[0], "springref"),
                 mjcf_attribute(own[0], "damping")};
  const std::regex tendon("<fixed [^>]*>(<joint [^>]*>)*");
  for (std::sregex_iterator at(text.begin(), text.end(), tendon), end; at != end; ++at) {
    const std::string whole = (*at)[0];
    std::smatch on;
    if (!std::regex_search(whole, on, std::regex("<joint joint='" + joint + "'[^>]*>"))) continue;
    const double along = mjcf_attribute(on[0], "coef");
    sum.force += along * mjcf_attribute(whole, "stiffness") * mjcf_attribute(whole, "springlength");
    sum.damping += along * along * mjcf_attribute(whole, "damping");
  }
  return sum;
}

TEST(MultibodyFiles, SealsOfBentLegsPushFeltAtRestInEveryFormat) {
  const auto mjcf = file_of_bent_legs(MultibodyFormat::mjcf).text,
             sdf = file_of_bent_legs(MultibodyFormat::sdf).text;
  const auto urdf = file_of_bent_legs(MultibodyFormat::urdf);
  const auto springs = nlohmann::json::parse(urdf.sidecar).at("springs");
  const std::regex dynamics(
      "<damping>([^<]*)</damping><spring_reference>([^<]*)</spring_reference>"
      "<spring_stiffness>([^<]*)<");
  std::sregex_iterator axis(sdf.begin(), sdf.end(), dynamics);
  double largest = 0.0;
  for (int leg = 1; leg <= 6; ++leg) {
    std::advance(axis, 2);  // the hinges at the base
    for (const std::string name : {"s", "tilt1", "tilt2"}) {
      const auto joint = "leg" + std::to_string(leg) + '.' + name;
      const auto expected = felt_in_mjcf(mjcf, joint);
      const double scale = 1e-9 * (name == "s" ? 1e4 : 100.0);
      EXPECT_NEAR(std::stod((*axis)[2]) * std::stod((*axis)[3]), expected.force, scale) << joint;
      EXPECT_NEAR(std::stod((*axis)[1]), expected.damping, scale) << joint;
      const auto found = std::ranges::find_if(springs, [&](const auto& spring) {
        return spring.at("joint") == "leg" + std::to_string(leg) + '_' + name;
      });
      ASSERT_NE(found, springs.end());
      EXPECT_NEAR(found->at("rest_force").get<double>(), expected.force, scale) << joint;
      if (name != "s") {
        largest = std::max(largest, std::abs(expected.force));
        EXPECT_GT(expected.damping, 0.5) << joint;
      }
      ++axis;
    }
  }
  EXPECT_GT(largest, 0.1);  // [N m]: the legs are bent
}

}  // namespace
}  // namespace hydrapod::exchange
