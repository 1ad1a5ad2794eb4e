/// Superelements in Universal Files: matrices as Code_Aster and Abaqus write them, and the modes of
/// a free structure.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "support/beam_payload.hpp"
#include "support/run_program.hpp"
#include "support/universal_text.hpp"

namespace hydrapod::test {
namespace {

using Eigen::MatrixXd;
using exchange::PayloadElement;
using testing::HasSubstr;

PayloadElement read(const std::string& text, int node = 11) {
  const TemporaryFolder folder;
  write_text(folder / "cabin.unv", text);
  return exchange::read_universal_element(folder / "cabin.unv", node);
}

std::string refusal(const std::string& text, int node = 11) {
  try {
    exchange::payload_modes(read(text, node), {});
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "accepted";
}

// 61.7 kg on a spring of 2.3e5 N/m along x, 0.83 m above the interface, on a foot of 31 kg with 7,
// 8 and 9 kg m²
constexpr double swinging = 61.7, spring = 2.3e5, height = 0.83;

void expect_the_mass_on_a_spring(const PayloadElement& element) {
  const auto payload = exchange::payload_modes(element, {});
  ASSERT_EQ(payload.modes.size(), 1U);
  const auto& mode = payload.modes[0];
  const double frequency = std::sqrt(spring / swinging) / base::two_pi;
  EXPECT_NEAR(mode.frequency, frequency, 1e-12 * frequency);
  const double l = std::sqrt(swinging), sign = std::copysign(1.0, mode.participation->x());
  EXPECT_NEAR(sign * mode.participation->x(), l, 1e-12 * l);
  EXPECT_NEAR(sign * mode.participation_moment.y(), l * height, 1e-12 * l);
  EXPECT_NEAR(mode.participation->tail(2).norm(), 0.0, 1e-12 * l);
  EXPECT_NEAR(payload.mass(0, 0), 31.0 + swinging, 1e-10);
  EXPECT_NEAR(payload.mass(1, 1), 31.0, 1e-10);
  EXPECT_NEAR(payload.mass(4, 4), 8.0 + swinging * height * height, 1e-10);
}

/// Physical coordinates: the motion of the mass is the seventh. 2.3e5 · 0.83 = 190900,
/// 2.3e5 · 0.83² = 158447.
constexpr const char* sparse = R"(    -1
  2453
       131
         4         3         7         7        11         7
         1         1  3.100000000000D+01         2         2  3.100000000000D+01
         3         3  3.100000000000D+01         4         4  7.000000000000D+00
         5         5  8.000000000000D+00         6         6  9.000000000000D+00
         7         7  6.170000000000D+01
    -1
    -1
  2453
       139
         4         3         7         7        11         9
         1         1  2.300000000000D+05         1         5  1.909000000000D+05
         1         7 -2.300000000000D+05         5         1  1.909000000000D+05
         5         5  1.584470000000D+05         5         7 -1.909000000000D+05
         7         1 -2.300000000000D+05         7         5 -1.909000000000D+05
         7         7  2.300000000000D+05
    -1
)";

TEST(UniversalElement, IsReadFromSparseMatrices) { expect_the_mass_on_a_spring(read(sparse)); }

/// Craig and Bampton: φ = 1 at the mass; 31 + 61.7 = 92.7, 61.7 · 0.83 = 51.211,
/// 8 + 61.7 · 0.83² = 50.50513.
constexpr const char* in_parts = R"(    -1
   481
         1
Mgen_a
    -1
    -1
   252
       131
         4         1         1         1         2
  6.170000000000D+01
    -1
    -1
   252
       139
         4         1         1         1         2
  2.300000000000D+05
    -1
    -1
   252
       134
         4         1         6         6         2
  9.270000000000D+01  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  5.121100000000D+01  0.000000000000D+00  0.000000000000D+00  3.100000000000D+01
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  3.100000000000D+01  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  7.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  5.121100000000D+01  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  5.050513000000D+01  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  9.000000000000D+00
    -1
    -1
   252
       142
         4         1         6         6         2
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
    -1
    -1
   252
       132
         4         1         1         6         2
  6.170000000000D+01  0.000000000000D+00  0.000000000000D+00  0.000000000000D+00
  5.121100000000D+01  0.000000000000D+00
    -1
)";

TEST(UniversalElement, IsReadFromMatricesOfModesAndInterface) {
  expect_the_mass_on_a_spring(read(in_parts));
}

/// Code_Aster states modes × interface by columns, and writes one mode after the other.
std::string coupling_dataset(const MatrixXd& L) {
  auto text = matrix_dataset(132, L.transpose());
  const auto turned = fmt::format("{:10}{:10}{:10}\n", 6, L.rows(), 2);
  text.replace(text.find(turned), turned.size(), fmt::format("{:10}{:10}{:10}\n", L.rows(), 6, 2));
  return text;
}

/// Two masses that swing in odd directions, their modes scaled to φ = 1 at the mass.
TEST(UniversalElement, HasTheModesOfSeveralMasses) {
  const double masses[]{83.1, 61.7}, springs[]{2.3e5, 4.1e5};
  const spatial::Vector3 directions[]{{0.6, 0.0, 0.8}, {0.28, 0.96, 0.0}},
      places[]{{0.31, -0.12, 0.83}, {-0.27, 0.41, 0.55}};
  spatial::Matrix6 M_cc = spatial::Matrix6::Identity() * 17.3;
  MatrixXd L(2, 6), M = MatrixXd::Zero(2, 2), K = M;
  for (int k = 0; k < 2; ++k) {
    spatial::Vector6 d;
    d << directions[k], places[k].cross(directions[k]);
    M_cc += masses[k] * d * d.transpose();
    L.row(k) = masses[k] * d;
    M(k, k) = masses[k];
    K(k, k) = springs[k];
  }
  const auto payload = exchange::payload_modes(
      read(matrix_dataset(131, M) + matrix_dataset(139, K) + matrix_dataset(134, M_cc) +
           matrix_dataset(142, MatrixXd::Zero(6, 6)) + coupling_dataset(L)),
      {});
  ASSERT_EQ(payload.modes.size(), 2U);
  for (int k = 0; k < 2; ++k) {  // the first is the lower one
    const auto& mode = payload.modes[static_cast<std::size_t>(k)];
    const double frequency = std::sqrt(springs[k] / masses[k]) / base::two_pi;
    EXPECT_NEAR(mode.frequency, frequency, 1e-11 * frequency);
    const auto found = model::participation(mode);
    const spatial::Vector6 expected = L.row(k).transpose() / std::sqrt(masses[k]);
    EXPECT_LT(std::min((found - expected).norm(), (found + expected).norm()), 1e-10) << k;
  }
}

/// The same in millimetres, newtons and tonnes, which dataset 164 states: lengths of the
/// seventh coordinate too.
TEST(UniversalElement, IsTheSameInMillimetres) {
  constexpr const char* in_millimetres = R"(    -1
   164
         9USER_DEFINED                2
  1.00000000000000000D+03  1.00000000000000000D+00  1.00000000000000000D+00
  2.73150000000000000D+02
    -1
    -1
  2453
       131
         2         3         7         7        11         7
         1         1  3.100000000000E-02         2         2  3.100000000000E-02
         3         3  3.100000000000E-02         4         4  7.000000000000E+03
         5         5  8.000000000000E+03         6         6  9.000000000000E+03
         7         7  6.170000000000E-02
    -1
    -1
  2453
       139
         2         3         7         7        11         9
         1         1  2.300000000000E+02         1         5  1.909000000000E+05
         1         7 -2.300000000000E+02         5         1  1.909000000000E+05
         5         5  1.584470000000E+08         5         7 -1.909000000000E+05
         7         1 -2.300000000000E+02         7         5 -1.909000000000E+05
         7         7  2.300000000000E+02
    -1
)";
  expect_the_mass_on_a_spring(read(in_millimetres));
}

const MastMatrices mast_in_file = mast_matrices({});

void expect_the_mast(const PayloadElement& element, const MatrixXd& M, double tolerance) {
  const auto expected = exchange::payload_modes({M, mast_in_file.K, {}}, {});
  const auto found = exchange::payload_modes(element, {});
  ASSERT_EQ(found.modes.size(), expected.modes.size());
  for (std::size_t k = 0; k < found.modes.size(); ++k) {
    const auto &a = expected.modes[k], &b = found.modes[k];
    EXPECT_NEAR(b.frequency, a.frequency, tolerance * a.frequency) << k;
    const auto A = model::participation(a), B = model::participation(b);
    EXPECT_LT(std::min((A - B).norm(), (A + B).norm()), 10.0 * tolerance * A.norm()) << k;
  }
  EXPECT_LT((found.mass - expected.mass).norm(), tolerance * expected.mass.norm());
}

/// 54 × 54, twelve digits after the point.
TEST(UniversalElement, KeepsTheNumbersOfFullMatrices) {
  expect_the_mast(read(matrix_dataset(131, mast_in_file.M) + matrix_dataset(139, mast_in_file.K)),
                  mast_in_file.M, 1e-8);
}

/// The mast of 97.7 kg on a rigid platform.
MatrixXd with_platform(double mass) {
  MatrixXd M = mast_in_file.M;
  M.diagonal().head<6>() +=
      mass * (spatial::Vector6() << 1.0, 1.0, 1.0, 0.61, 0.57, 0.73).finished();
  return M;
}

/// All modes of the free structure are the structure: six digits in the file.
TEST(UniversalElement, OfAllModesOfTheFreeStructureIsTheStructure) {
  const auto M = with_platform(113.0);
  const auto element = read(free_modes_text(M, mast_in_file.K, M.rows(), 0.013));
  EXPECT_EQ(element.M.rows(), M.rows());
  expect_the_mast(element, M, 1e-4);
  EXPECT_GT(element.C.size(), 0);
  EXPECT_EQ(read(free_modes_text(M, mast_in_file.K, M.rows(), 0.0)).C.size(), 0);
}

/// Rigid modes and one of 0.013 damping, a mass on a spring: the structure between two masses has
/// ω² = k (1/m_1 + 1/m_2), with the foot held k/m_2 and the same dashpot.
TEST(UniversalElement, HasTheDampingOfTheFreeModes) {
  const double foot = 31.0, omega = std::sqrt(spring * (1.0 / foot + 1.0 / swinging));
  const double reduced = 1.0 / (1.0 / foot + 1.0 / swinging), ratio = 0.013;
  const double total = foot + swinging;
  std::string text;
  for (int k = 0; k < 6; ++k) {  // y, z, rx, ry, rz and x of both
    const double inertias[]{total, foot, foot, 7.0, 8.0, 9.0};
    text += mode_dataset(k + 1, 0.0, inertias[k], 0.0, 5, spatial::Vector6::Unit(k));
  }
  // stretched by 1: the foot moves by −m_2/m
  text += mode_dataset(7, omega / base::two_pi, reduced, ratio, 5,
                       spatial::Vector6::Unit(0) * (-swinging / total));
  const auto payload = exchange::payload_modes(read(text, 5), {});
  ASSERT_EQ(payload.modes.size(), 1U);
  const double held = std::sqrt(spring / swinging);
  EXPECT_NEAR(payload.modes[0].frequency, held / base::two_pi, 1e-5 * held);
  // dashpot c = 2 ζ ω m_r, ζ_held = c/(2 ω_held m_2)
  const double expected = ratio * omega * reduced / (held * swinging);
  EXPECT_NEAR(payload.modes[0].damping_ratio, expected, 1e-5 * expected);
  EXPECT_NEAR(payload.modes[0].participation->norm(), std::sqrt(swinging), 1e-4);
  EXPECT_NEAR(payload.mass(0, 0), total, 1e-4 * total);
}

/// Modes that are left out make the structure stiffer. They count little where the node has mass.
TEST(UniversalElement, OfSomeFreeModesIsHardlyStifferWithMassAtTheNode) {
  for (const double mass : {51.0, 13700.0}) {
    const auto M = with_platform(mass);
    const auto all = exchange::payload_modes({M, mast_in_file.K, {}}, {});
    const auto some =
        exchange::payload_modes(read(free_modes_text(M, mast_in_file.K, 14, 0.0)), {});
    for (std::size_t k = 0; k < 4; ++k) {
      const double ratio = some.modes[k].frequency / all.modes[k].frequency;
      EXPECT_GT(ratio, 1.0 - 1e-5);
      EXPECT_LT(ratio, mass < 100.0 ? 1.0005 : 1.00002) << k;
    }
  }
}

TEST(UniversalElement, OfAFreeStructureWithoutMassAtTheNodeIsRefused) {
  EXPECT_THAT(refusal(free_modes_text(mast_in_file.M, mast_in_file.K, 26, 0.0)),
              HasSubstr("node 11 has too little mass: the lowest frequency is 107.8 Hz free and "
                        "19.5 Hz with the node held"));
}

std::string with(std::string text, const std::string& old, const std::string& now) {
  text.replace(text.find(old), old.size(), now);
  return text;
}

TEST(UniversalElement, ThatIsNoneIsRefusedWithItsLine) {
  const std::string text = sparse;
  EXPECT_THAT(refusal(with(text, "  6.170000000000D+01", "  6.17000000000x+01")),
              HasSubstr("cabin.unv:8:1: error: matrix: \"6.17000000000x+01\""));
  EXPECT_THAT(refusal(with(text, "         7         7  6.17", "         8         7  6.17")),
              HasSubstr("cabin.unv:8:1: error: matrix: row 8, expected 1 to 7"));
  EXPECT_THAT(refusal(with(text, "        11         7\n", "        11         8\n")),
              HasSubstr("cabin.unv:9:1: error: matrix: ends where a row should be"));
  EXPECT_THAT(refusal(with(text, "        11         7\n", "        11         6\n")),
              HasSubstr("cabin.unv:8:1: error: matrix: more than 6 entries"));
  EXPECT_THAT(refusal(with(text, "         4         3         7         7        11         7",
                           "         6         3         7         7        11         7")),
              HasSubstr("cabin.unv:4:1: error: matrix: data type 6, expected 2 (real) or 4"));
  EXPECT_THAT(refusal(with(text, "        11         7\n", "         3         7\n")),
              HasSubstr("cabin.unv:4:1: error: matrix: storage key 3, expected 1 (rows)"));
  EXPECT_THAT(refusal(with(text, "         7         7        11         7",
                           "      4000      4000        11         7")),
              HasSubstr("4000 rows and 4000 columns, expected 1 to 3000"));
  EXPECT_THAT(refusal(with(text, "       139", "       131")),
              HasSubstr("cabin.unv:12:1: error: a second matrix with the identifier 131"));
  EXPECT_THAT(refusal(with(text, "       139", "       147")),
              HasSubstr("has no matrix 139 (stiffness)"));
  EXPECT_THAT(refusal(with(text, "  2453\n", "  2453b     1     1\n")),
              HasSubstr("cabin.unv:2:1: error: dataset 1 is a binary matrix (2453b)"));
  const std::string parts = in_parts;
  EXPECT_THAT(refusal(parts.substr(0, parts.rfind("    -1\n   252"))),
              HasSubstr("has no matrix 132 (mass between modes and interface)"));
  EXPECT_THAT(refusal(with(parts, "1         6         2", "2         3         2")),
              HasSubstr("matrix 132 (mass between modes and interface) has 2 rows and 3 columns, "
                        "expected 1 and 6"));
  EXPECT_THAT(refusal(with(parts, "         4         1         1         6         2\n", "")),
              HasSubstr("error: matrix:"));
}

TEST(UniversalElement, OfModesThatAreNotThoseOfAFreeStructureIsRefused) {
  const auto M = with_platform(113.0);
  const auto text = free_modes_text(M, mast_in_file.K, 12, 0.01);
  EXPECT_THAT(refusal(text, 12), HasSubstr("no mode moves node 12, expected the node that is the "
                                           "platform, one of 11"));
  EXPECT_THAT(refusal(free_modes_text(M, mast_in_file.K, 6, 0.01)),
              HasSubstr("its 6 modes move node 11 in 6 independent ways"));
  EXPECT_THAT(refusal(text.substr(text.find("    -1\n    55", 20))),
              HasSubstr("resists a rigid motion"));
  EXPECT_THAT(refusal(with(text, "  1.00000E+00  0.00000E+00", "  0.00000E+00  0.00000E+00")),
              HasSubstr("mode 1 (0 Hz) has no modal mass"));
  EXPECT_THAT(refusal("    -1\n   151\nNONE\n    -1\n"),
              HasSubstr("neither matrices (datasets 252 and 2453) nor modes (dataset 55 or 2414)"));
}

}  // namespace
}  // namespace hydrapod::test
