#pragma once
/// Mutation of JSON that keeps it JSON: a node is replaced, taken out, repeated or swapped with
/// another. Included by the one source file of a target that reads JSON.

#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "fuzz.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace hydrapod::fuzz {

using AnyJson = nlohmann::ordered_json;

inline void collect(AnyJson& json, std::vector<AnyJson*>& nodes) {
  if (nodes.size() > 3000) return;
  nodes.push_back(&json);
  if (json.is_structured())
    for (AnyJson& item : json) collect(item, nodes);
}

inline AnyJson odd_value(std::mt19937& random) {
  switch (random() % 16) {
    case 0:
      return nullptr;
    case 1:
      return true;
    case 2:
      return 0;
    case 3:
      return -1;
    case 4:
      return 1;
    case 5:
      return std::int64_t{1} << (random() % 63);
    case 6:
      return ~std::uint64_t{0};
    case 7:
      return 1e308;
    case 8:
      return -1e-308;
    case 9:
      return 1e19;
    case 10:
      return "";
    case 11:
      return "x";
    case 12:
      return AnyJson::array();
    case 13:
      return AnyJson::object();
    case 14:
      return AnyJson::array({1, 2});
    default:
      return static_cast<double>(random() % 1000) / 7.0 - 70.0;
  }
}

inline void mutate(AnyJson& json, std::mt19937& random) {
  std::vector<AnyJson*> nodes;
  collect(json, nodes);
  AnyJson& node = *nodes[random() % nodes.size()];
  switch (random() % 6) {
    case 0:
      node = odd_value(random);
      break;
    case 1: {
      const AnyJson other = *nodes[random() % nodes.size()];
      node = other;
      break;
    }
    case 2:
      if (node.is_structured() && !node.empty())
        node.erase(std::next(node.begin(), static_cast<std::ptrdiff_t>(random() % node.size())));
      break;
    case 3:
      if (node.is_array()) node.push_back(node.empty() ? AnyJson(1) : AnyJson(node.back()));
      break;
    case 4:
      if (node.is_number_float()) node = node.get<double>() * (random() % 2 == 0 ? -1.0 : 1e3);
      break;
    default:
      if (node.is_number()) node = odd_value(random);
  }
}

}  // namespace hydrapod::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  using namespace hydrapod::fuzz;
  std::mt19937 random(seed);
  if (random() % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  AnyJson json = AnyJson::parse(text_of(data, size), nullptr, false);
  if (json.is_discarded()) return LLVMFuzzerMutate(data, size, most);
  for (unsigned k = random() % 3 + 1; k > 0; --k) mutate(json, random);
  const std::string text = json.dump(-1, ' ', false, AnyJson::error_handler_t::replace);
  if (text.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::copy(text.begin(), text.end(), data);
  return text.size();
}
