#pragma once
/// Eigen's decompositions and kernels of dynamic size, compiled once for the whole project.
///
/// Part of the precompiled headers of library, program and tests: what is listed here is declared
/// `extern` there, and its code comes from numerics/eigen_*.cpp. Files with a decomposition take
/// half the time to compile for it; results are the same. The kernels are internal to Eigen 3.4.

#include <Eigen/Dense>
#include <complex>

// clang-format off
/// A class, and its compute(A) for a plain A: a template of its own, which the class does not hold.
#define HYDRAPOD_EIGEN_COMPUTED(declare, Solver, ...)                      \
  declare class Eigen::Solver<__VA_ARGS__>;                                \
  declare Eigen::Solver<__VA_ARGS__>& Eigen::Solver<__VA_ARGS__>::compute( \
      const Eigen::EigenBase<__VA_ARGS__>&);
#define HYDRAPOD_EIGEN_VALUES(declare, Solver, Option, ...)                \
  declare class Eigen::Solver<__VA_ARGS__>;                                \
  declare Eigen::Solver<__VA_ARGS__>& Eigen::Solver<__VA_ARGS__>::compute( \
      const Eigen::EigenBase<__VA_ARGS__>&, Option);

#define HYDRAPOD_EIGEN_REAL(declare)                                                               \
  declare class Eigen::JacobiSVD<Eigen::MatrixXd>;                                                 \
  HYDRAPOD_EIGEN_VALUES(declare, EigenSolver, bool, Eigen::MatrixXd)                               \
  HYDRAPOD_EIGEN_VALUES(declare, SelfAdjointEigenSolver, int, Eigen::MatrixXd)                     \
  HYDRAPOD_EIGEN_VALUES(declare, SelfAdjointEigenSolver, int, Eigen::Matrix<double, 6, 6>)         \
  declare class Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>;                         \
  declare class Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>;             \
  declare class Eigen::PartialPivLU<Eigen::MatrixXd>;                                              \
  declare class Eigen::PartialPivLU<Eigen::Matrix<double, 6, 6>>;                                  \
  declare class Eigen::HouseholderQR<Eigen::MatrixXd>;                                             \
  declare class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;                                       \
  HYDRAPOD_EIGEN_COMPUTED(declare, LLT, Eigen::MatrixXd)                                           \
  HYDRAPOD_EIGEN_COMPUTED(declare, LLT, Eigen::Matrix<double, 6, 6>)                               \
  HYDRAPOD_EIGEN_COMPUTED(declare, LDLT, Eigen::MatrixXd)                                          \
  HYDRAPOD_EIGEN_COMPUTED(declare, LDLT, Eigen::Matrix<double, 6, 6>)

#define HYDRAPOD_EIGEN_COMPLEX(declare)                                          \
  declare class Eigen::JacobiSVD<Eigen::MatrixXcd>;                              \
  HYDRAPOD_EIGEN_VALUES(declare, SelfAdjointEigenSolver, int, Eigen::MatrixXcd)  \
  HYDRAPOD_EIGEN_VALUES(declare, ComplexEigenSolver, bool, Eigen::MatrixXcd)     \
  declare class Eigen::PartialPivLU<Eigen::MatrixXcd>;                           \
  declare class Eigen::HouseholderQR<Eigen::MatrixXcd>;                          \
  declare class Eigen::ColPivHouseholderQR<Eigen::MatrixXcd>;                    \
  HYDRAPOD_EIGEN_COMPUTED(declare, LLT, Eigen::MatrixXcd)

#if EIGEN_VERSION_AT_LEAST(3, 4, 0) && !EIGEN_VERSION_AT_LEAST(3, 4, 90)
/// Products: matrix with matrix, and matrix (stored by columns, 0, or rows, 1) with vector.
#define HYDRAPOD_EIGEN_PRODUCT(declare, Scalar)                                              \
  declare struct Eigen::internal::gebp_kernel<                                               \
      Scalar, Scalar, long, Eigen::internal::blas_data_mapper<Scalar, long, 0, 0, 1>,        \
      Eigen::internal::gebp_traits<Scalar, Scalar>::mr,                                      \
      Eigen::internal::gebp_traits<Scalar, Scalar>::nr, false, false>;
#define HYDRAPOD_EIGEN_PACK(declare, Scalar, order)                                          \
  declare struct Eigen::internal::gemm_pack_lhs<                                             \
      Scalar, long, Eigen::internal::const_blas_data_mapper<Scalar, long, order>,            \
      Eigen::internal::gebp_traits<Scalar, Scalar>::mr,                                      \
      Eigen::internal::gebp_traits<Scalar, Scalar>::LhsProgress,                             \
      Eigen::internal::gebp_traits<Scalar, Scalar>::LhsPacket4Packing, order>;               \
  declare struct Eigen::internal::gemm_pack_rhs<                                             \
      Scalar, long, Eigen::internal::const_blas_data_mapper<Scalar, long, order>,            \
      Eigen::internal::gebp_traits<Scalar, Scalar>::nr, order>;
/// Triangular systems with several right sides; triangles as Eigen numbers them.
#define HYDRAPOD_EIGEN_TRIANGLE(declare, Scalar, triangle, conjugate, order)                 \
  declare struct Eigen::internal::triangular_solve_matrix<                                   \
      Scalar, long, Eigen::OnTheLeft, triangle, conjugate, order, Eigen::ColMajor, 1>;
#define HYDRAPOD_EIGEN_TIMES_VECTOR(declare, Scalar, matrix, conjugate, vector, version)     \
  declare struct Eigen::internal::general_matrix_vector_product<                             \
      long, Scalar, Eigen::internal::const_blas_data_mapper<Scalar, long, matrix>, matrix,   \
      conjugate, Scalar, Eigen::internal::const_blas_data_mapper<Scalar, long, vector>,      \
      false, version>;
#define HYDRAPOD_EIGEN_PRODUCTS(declare)                                                     \
  HYDRAPOD_EIGEN_PRODUCT(declare, double)                                                    \
  HYDRAPOD_EIGEN_PRODUCT(declare, std::complex<double>)                                      \
  HYDRAPOD_EIGEN_PACK(declare, double, 0)                                                    \
  HYDRAPOD_EIGEN_PACK(declare, double, 1)                                                    \
  HYDRAPOD_EIGEN_PACK(declare, std::complex<double>, 0)                                      \
  HYDRAPOD_EIGEN_PACK(declare, std::complex<double>, 1)                                      \
  HYDRAPOD_EIGEN_TRIANGLE(declare, double, Eigen::Lower, false, 0)                           \
  HYDRAPOD_EIGEN_TRIANGLE(declare, double, Eigen::Upper, false, 0)                           \
  HYDRAPOD_EIGEN_TRIANGLE(declare, double, Eigen::Upper, false, 1)                           \
  HYDRAPOD_EIGEN_TRIANGLE(declare, double, Eigen::UnitLower, false, 0)                       \
  HYDRAPOD_EIGEN_TRIANGLE(declare, double, Eigen::UnitUpper, false, 1)                       \
  HYDRAPOD_EIGEN_TRIANGLE(declare, std::complex<double>, Eigen::Lower, false, 0)             \
  HYDRAPOD_EIGEN_TRIANGLE(declare, std::complex<double>, Eigen::Upper, false, 0)             \
  HYDRAPOD_EIGEN_TRIANGLE(declare, std::complex<double>, Eigen::Upper, true, 1)              \
  HYDRAPOD_EIGEN_TRIANGLE(declare, std::complex<double>, Eigen::UnitLower, false, 0)         \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, double, 0, false, 0, 0)                               \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, double, 0, false, 1, 0)                               \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, double, 1, false, 0, 0)                               \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, double, 1, false, 1, 0)                               \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, double, 1, false, 1, 1)                               \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, std::complex<double>, 0, false, 0, 0)                 \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, std::complex<double>, 0, false, 1, 0)                 \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, std::complex<double>, 1, false, 0, 0)                 \
  HYDRAPOD_EIGEN_TIMES_VECTOR(declare, std::complex<double>, 1, true, 0, 0)
#else
#define HYDRAPOD_EIGEN_PRODUCTS(declare)
#endif
// clang-format on

HYDRAPOD_EIGEN_REAL(extern template)
HYDRAPOD_EIGEN_COMPLEX(extern template)
HYDRAPOD_EIGEN_PRODUCTS(extern template)
