#pragma once
/// Where outputs stand in dataset 55 of a Universal File. Private to the module.

#include <vector>

#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

struct ModalPlace {
  int node{};
  int component{};   ///< 0 … 5: x … rz
  double sign{1.0};  ///< −1: the sensor is mounted the other way round
};

/// A place of its own for every output, see modal_results.hpp.
std::vector<ModalPlace> modal_places(const std::vector<Channel>& outputs);

}  // namespace hydrapod::data
