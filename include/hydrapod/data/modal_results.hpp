#pragma once
/// Modes as a measurement found them, what shapes have in common, and Universal Files of modes
/// (dataset 55: poles and shapes, without what is known of their errors) and of matrices.
///
/// One dataset 55 per mode, "complex eigenvalue, first order", displacement: eigenvalue λ [1/s],
/// modal A = 1, modal B = −λ, and the shape at nodes. A node has six values x … rz, or three where
/// there is no rotation. An output with a direction stands at the node of its point (1 where it has
/// none) and in its direction, a negative one with the other sign; others (legs, sensors without a
/// direction, a second output in the same place) at nodes of their own behind these, as x. A
/// dataset of hydrapod's own keeps names, units and directions; without it outputs are called
/// "node 3 ry".
///
/// Scale. Where participations L are known the numbers ψ of a mode give the displacement of output
/// o by input i as other programs synthesise it,
///
///     H_oi(s) = Σ_r ψ_o ψ_i/(A_r (s − λ_r)) + conj.,   A_r = 1,   ψ_o ψ_i = φ_o L_i.
///
/// Forces (N, N m) that act where outputs measure, and in their directions, are at the places of
/// these: φ is scaled by √(L_i/φ_i). All other inputs, and these too where ψ_o ψ_i differs from
/// φ_o L_i by more than 2 % (no reciprocal system), stand at nodes of their own behind the outputs,
/// where ψ_i = L_i; the last line of text of each mode names the nodes.
///
/// Dataset 2414 is what finite-element programs keep modes in: shapes beside nodes (2411) and rods
/// (2412) along the trace lines. Where all shapes are real and forces act where outputs measure
/// they are normal modes with modal mass and damping ratio, else complex ones as in dataset 55.
/// Inputs that have no place at an output are left out.
///
/// Layout: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File
/// Formats for Modal Analysis Testing", datasets 55, 2411, 2412 and 2414. Numbers are E13.5: six
/// digits.
///
/// Named columns of numbers in one HDF5 file: the results of a study.
///
///     /            attributes: texts and numbers that say what the columns are
///     /samples/    a dataset per column, doubles, chunked and compressed (shuffle, deflate), with
///                  the attributes `unit` and `description`; NaN: no value
///
/// With h5py: `pandas.DataFrame({n: d[:] for n, d in h5py.File(path)["samples"].items()})`. Links
/// keep the order in which they were made. There are no time stamps: equal results are equal files.

#include <complex>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

struct ModalResult {
  std::complex<double> pole{};  ///< λ [1/s], Im > 0
  Eigen::VectorXcd shape{};     ///< displacement, a number per output
  /// L, a number per input: residues are φ Lᵀ. Empty: not known, or not those of this shape.
  Eigen::VectorXcd participation{};
  /// Standard deviations of ω [rad/s] and ζ; 0: not known.
  double omega_deviation{}, damping_deviation{};
  Eigen::VectorXd shape_deviation{};  ///< of each number of the shape; empty: not known
  /// What the mode is above the noise, around 1: nothing; 0: not known.
  double significance{};
  std::vector<std::string> id_lines{};  ///< of a Universal File of another program, up to five
  /// Of a normal mode, for this scale of its shape; with displacements in m and rad [kg]; 0: not
  /// known.
  double modal_mass{};
  [[nodiscard]] double omega() const { return std::abs(pole); }
  [[nodiscard]] double damping_ratio() const { return -pole.real() / std::abs(pole); }
};

struct ModalResults {
  std::string title{};
  std::string date{};  ///< ISO 8601
  std::vector<Channel> outputs{};
  std::vector<Channel> inputs{};  ///< empty: not known
  double from{}, to{};            ///< band that was looked at [Hz]
  double line_spacing{};          ///< of the responses they were found in [Hz]; 0: not known
  std::vector<ModalResult> modes{};
  Geometry geometry{};  ///< of the points of the outputs
};

/// 0 for displacements, 1 for speeds, 2 for accelerations, by the unit.
int time_derivatives(const std::string& unit);

/// Does the channel show motion against the ground? Accelerometers do. Lengths of legs, poses that
/// follow from them and their speeds are against the base, and so are accelerations along a leg,
/// which are lengths differentiated. Differs where the base gives way.
bool against_ground(const data::Channel& channel);

/// Modal assurance criterion |aᴴ b|²/(|a|² |b|²); 0 where one of them is zero.
double mac(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);
/// Modal phase collinearity: 1 for a real shape.  Mean phase deviation [rad]: 0 for a real shape.
double modal_phase_collinearity(const Eigen::VectorXcd& shape);
double mean_phase_deviation(const Eigen::VectorXcd& shape);

enum class ModalDataset { shapes = 55, analysis = 2414 };

/// Written whole or not at all. Throws std::invalid_argument for shapes of another size than
/// outputs, else as base::write_file_whole.
void write_modal_results(const std::string& path, const ModalResults& results,
                         ModalDataset dataset = ModalDataset::shapes);

struct ReadModalResultsResult {
  ModalResults results{};
  std::vector<base::Diagnostic> notes{};
};

/// Datasets 55 and 2414 of normal modes (analysis type 2, with their viscous damping) and complex
/// eigenvalues (3, 7), real or complex, three or six values per node. Lengths become metres by
/// dataset 164, and shapes of speeds or accelerations displacements. Throws base::InputError.
ReadModalResultsResult read_modal_results(const std::string& path);

/// Identifiers of matrices: of a whole superelement, or of its modes with the interface held and
/// of the interface apart.
namespace matrix_identifier {
inline constexpr int mass = 131, coupling_mass = 132, interface_mass = 134, stiffness = 139,
                     interface_stiffness = 142;
}

struct MatrixDataset {
  int identifier{};                ///< of what, see above; others are kept
  Eigen::MatrixXd values{};        ///< in units of the file
  unsigned line{};                 ///< of its identifier
  double length{1.0}, force{1.0};  ///< units of the file in a metre and in a newton
};

/// Real matrices of a Universal File: datasets 252 and 2453, and 250 read by the same layout. No
/// dataset 164: SI.
///
///     record 1  I10    identifier
///     record 2  6I10   type (2 real, 4 double precision), form, rows, columns, storage key (1 by
///                      rows, 2 by columns, 11 sparse), number of entries of a sparse one
///     record 3  4E20.12 or 4D20.12; sparse: 2(2I10,E20.12), row, column, value
///
/// The values of `coupling_mass`, modes × interface, stand one mode after the other whatever the
/// key says, as Code_Aster writes them (IMPR_MACR_ELEM, FORMAT='IDEAS').
///
/// Empty where the file holds modes only. Throws base::InputError with line, for a file of neither,
/// for complex and binary matrices, and for more than 3000 rows.
///
/// Layouts: dataset 252 as Code_Aster writes it; dataset 2453 in the manual of Abaqus, "Exchanging
/// Abaqus data with ZAERO".
std::vector<MatrixDataset> read_matrix_datasets(const std::string& path);

struct ColumnHead {
  std::string name{};
  std::string unit{};
  std::string description{};
};

struct ColumnFile {
  std::vector<ColumnHead> columns{};
  std::uint64_t rows{};
  int threads{};        ///< that pack the columns; 0: one per processor
  std::string study{};  ///< which one, in a few words in the first 64 KiB; empty: none
  std::map<std::string, std::string> texts{};
  std::map<std::string, double> numbers{};
  /// Hands all rows over, some at a time, one row after the other, columns side by side.
  std::function<void(const std::function<void(std::span<const double>)>&)> each_rows{};
};

/// Writes the file whole or not at all. Throws base::InputError for a place that cannot be written
/// to, base::ComputationError where writing failed.
void write_columns(const std::string& path, const ColumnFile& file);

}  // namespace hydrapod::data
