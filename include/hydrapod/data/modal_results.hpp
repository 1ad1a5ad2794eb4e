#pragma once
/// Modes as a measurement found them, and their Universal Files (dataset 55).
///
/// One dataset 55 per mode, "complex eigenvalue, first order", displacement: eigenvalue λ [1/s],
/// modal A = 1, modal B = −λ, and the shape at nodes. A node has six values x … rz, or three where
/// there is no rotation. An output with a direction stands at the node of its point (1 where it has
/// none) and in its direction, a negative one with the other sign; others (legs, sensors without a
/// direction, a second output in the same place) at nodes of their own behind these, as x. A
/// dataset of hydrapod's own keeps names, units and directions; without it outputs are called
/// "node 3 ry".
///
/// Layout: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File
/// Formats for Modal Analysis Testing", dataset 55. Numbers are E13.5: six digits.

#include <complex>
#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

struct ModalResult {
  std::complex<double> pole{};  ///< λ [1/s]
  Eigen::VectorXcd shape{};     ///< a number per output
};

struct ModalResults {
  std::string title{};
  std::string date{};  ///< ISO 8601
  std::vector<Channel> outputs{};
  std::vector<ModalResult> modes{};
};

/// Written whole or not at all. Throws std::invalid_argument for shapes of another size than
/// outputs, else as base::write_file_whole.
void write_modal_results(const std::string& path, const ModalResults& results);

struct ReadModalResultsResult {
  ModalResults results{};
  std::vector<base::Diagnostic> notes{};
};

/// Datasets 55 of normal modes (analysis type 2, with their viscous damping) and complex
/// eigenvalues (3, 7), real or complex, three or six values per node. Throws base::InputError.
ReadModalResultsResult read_modal_results(const std::string& path);

}  // namespace hydrapod::data
