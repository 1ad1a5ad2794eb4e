#pragma once
/// `PATH=VALUE`, laid over the tree of a machine file. Private to the reader.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

/// Lays the overrides over `root` in their order; what is wrong with one of them goes to `faults`.
/// Whether the path means anything is for the schema to say, as for the file.
void lay_over(Node& root, const std::vector<std::string>& overrides, Faults& faults);

/// The array, or the table of a tensor, that holds the number at `path`, where the file says these
/// numbers in another way (a circle of joints, one value for all legs, the magnitude of gravity) or
/// leaves them out. Its values are those of the machine as the tree describes it.
struct SpeltOut {
  KeyPath path{};
  Node value{};
};
std::optional<SpeltOut> spelt_out(const Node& root, const KeyPath& path, const Place& place,
                                  Faults faults);

/// What messages call an override: `--set platform.mass=-3`.
std::string source_name(const std::string& override_text);

}  // namespace hydrapod::model
