#pragma once
/// A mode in a Universal File: dataset 55 or 2414.
///
/// Layouts: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File
/// Formats for Modal Analysis Testing", datasets 55 and 2414. Nodes behind
///
///                            55                              2414
///     lines of text          1 to 5                          4 to 8
///     kind                   6                               9
///     numbers of the mode    8: by the kind of analysis      12: time, frequency, eigenvalue, modal
///                                                            mass, ζ; 13: λ, modal A, modal B

#include <complex>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "uff_dataset.hpp"

namespace hydrapod::data {

namespace code {
inline constexpr int structural = 1, normal_mode = 2, complex_eigenvalue = 3, second_order = 7;
inline constexpr int real_data = 2, complex_data = 5;
inline constexpr int displacement = 8, speed = 11, acceleration = 12;
inline constexpr int translations = 2, translations_and_rotations = 3;
inline constexpr int at_nodes = 1;
}  // namespace code

using NodeValues = std::map<std::pair<int, int>, std::complex<double>>;  // (node, component)

struct ModeDataset {
  std::complex<double> pole{};
  double modal_mass{};  ///< 0: not known
  bool is_normal{};
  NodeValues values{};
  std::vector<std::string> id_lines{};
};

/// None for analyses that are no modes. Lengths in metres, displacements. Throws base::InputError.
std::optional<ModeDataset> read_mode(const UffLines& dataset, Notes& notes);

}  // namespace hydrapod::data
