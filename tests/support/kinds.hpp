#pragma once
/// Names of the parameters that many tests of the dynamics run over.

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::test {

using AxesAndKind = std::tuple<model::FlexibleAxes, dynamics::ModelKind>;

inline const char* name(model::FlexibleAxes axes) {
  return axes == model::FlexibleAxes::gimbal ? "gimbal" : "transverse";
}

inline std::string name(const testing::TestParamInfo<AxesAndKind>& test) {
  return std::string(name(std::get<0>(test.param))) + "_" + dynamics::name(std::get<1>(test.param));
}

inline auto both_axes() {
  return testing::Values(model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal);
}

}  // namespace hydrapod::test
