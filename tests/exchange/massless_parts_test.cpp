/// A leg may have its mass in one of its parts; programs of multibody dynamics take no part
/// without.

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>

#include "hydrapod/base/error.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::exchange {
namespace {

class MasslessParts : public testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] MultibodyFile written(MultibodyFormat format) const {
    auto machine = test::symmetric_machine();
    for (auto& leg : machine.legs) {
      auto& mass = GetParam() ? leg.cylinder_case.mass : leg.rod.mass;
      auto& inertia =
          GetParam() ? leg.cylinder_case.transverse_inertia : leg.rod.transverse_inertia;
      mass = inertia = 0.0;
    }
    return multibody_file(machine, machine.neutral(), dynamics::ModelKind::guide, format);
  }
  static bool is_told(const MultibodyFile& file) {
    return std::ranges::any_of(file.parity, [](const ParityLine& line) {
      return line.held == Held::approximate && line.what == "parts of legs without mass or inertia";
    });
  }
};

INSTANTIATE_TEST_SUITE_P(OfCaseOrRod, MasslessParts, testing::Bool());

TEST_P(MasslessParts, HaveTheLeastThatMuJoCoTakes) {
  if (!GetParam()) {  // loops that close softly at a rod without mass do not hold still
    EXPECT_THROW(written(MultibodyFormat::mjcf), base::InputError);
    return;
  }
  const auto text = written(MultibodyFormat::mjcf).text;
  EXPECT_FALSE(std::regex_search(text, std::regex(" mass='0'|diaginertia='0 ")));
}

TEST_P(MasslessParts, HaveALittleInSdfAndUrdf) {
  const auto sdf = written(MultibodyFormat::sdf), urdf = written(MultibodyFormat::urdf);
  EXPECT_FALSE(std::regex_search(sdf.text, std::regex("<mass>0</mass>|<ixx>0</ixx>")));
  EXPECT_FALSE(std::regex_search(urdf.text, std::regex("<mass value=\"0\"|ixx=\"0\"")));
  EXPECT_TRUE(is_told(sdf) && is_told(urdf));
  const auto whole = test::symmetric_machine();
  EXPECT_FALSE(is_told(
      multibody_file(whole, whole.neutral(), dynamics::ModelKind::guide, MultibodyFormat::sdf)));
}

}  // namespace
}  // namespace hydrapod::exchange
