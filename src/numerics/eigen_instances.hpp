#pragma once
/// Eigen's decompositions and kernels of dynamic size, compiled once for the whole project.
///
/// Part of the precompiled headers of library, program and tests: what is listed here is declared
/// `extern` there, and its code comes from numerics/eigen_*.cpp. Files with a decomposition take
/// half the time to compile for it; results are the same. The kernels are internal to Eigen 3.4.

#include <Eigen/Dense>
#include <complex>

// clang-format off
#define HYDRAPOD_EIGEN_REAL(declare)                                       \
  declare class Eigen::JacobiSVD<Eigen::MatrixXd>;                         \
  declare class Eigen::EigenSolver<Eigen::MatrixXd>;                       \
  declare class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;            \
  declare class Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>; \
  declare class Eigen::PartialPivLU<Eigen::MatrixXd>;                      \
  declare class Eigen::PartialPivLU<Eigen::Matrix<double, 6, 6>>;          \
  declare class Eigen::HouseholderQR<Eigen::MatrixXd>;                     \
  declare class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;               \
  declare class Eigen::LLT<Eigen::MatrixXd>;                               \
  declare class Eigen::LLT<Eigen::Matrix<double, 6, 6>>;                   \
  declare class Eigen::LDLT<Eigen::MatrixXd>;

#define HYDRAPOD_EIGEN_COMPLEX(declare)                          \
  declare class Eigen::JacobiSVD<Eigen::MatrixXcd>;              \
  declare class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>; \
  declare class Eigen::PartialPivLU<Eigen::MatrixXcd>;           \
  declare class Eigen::HouseholderQR<Eigen::MatrixXcd>;          \
  declare class Eigen::ColPivHouseholderQR<Eigen::MatrixXcd>;

#if EIGEN_VERSION_AT_LEAST(3, 4, 0) && !EIGEN_VERSION_AT_LEAST(3, 4, 90)
/// Products: matrix with matrix, and matrix (stored by columns, 0, or rows, 1) with vector.
#define HYDRAPOD_EIGEN_PRODUCT(declare, Scalar)                                              \
  declare struct Eigen::internal::gebp_kernel<                                               \
      Scalar, Scalar, long, Eigen::internal::blas_data_mapper<Scalar, long, 0, 0, 1>,        \
      Eigen::internal::gebp_traits<Scalar, Scalar>::mr,                                      \
      Eigen::internal::gebp_traits<Scalar, Scalar>::nr, false, false>;
#define HYDRAPOD_EIGEN_TIMES_VECTOR(declare, Scalar, matrix, conjugate, vector, version)     \
  declare struct Eigen::internal::general_matrix_vector_product<                             \
      long, Scalar, Eigen::internal::const_blas_data_mapper<Scalar, long, matrix>, matrix,   \
      conjugate, Scalar, Eigen::internal::const_blas_data_mapper<Scalar, long, vector>,      \
      false, version>;
#define HYDRAPOD_EIGEN_PRODUCTS(declare)                                                     \
  HYDRAPOD_EIGEN_PRODUCT(declare, double)                                                    \
  HYDRAPOD_EIGEN_PRODUCT(declare, std::complex<double>)                                      \
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
