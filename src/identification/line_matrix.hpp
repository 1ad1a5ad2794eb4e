#pragma once
/// Small complex matrices of neighbouring lines, computed side by side. Private to the module.
///
/// One number per line in a vector of GCC and Clang, which is held in registers; vectors go by
/// reference: how they are passed by value depends on the processor.

#include <Eigen/Core>
#include <complex>
#include <cstring>
#include <vector>

namespace hydrapod::identification {

#ifdef __AVX512F__
inline constexpr int together = 8;
#else
inline constexpr int together = 4;
#endif
typedef double SomeLines __attribute__((vector_size(together * sizeof(double))));  // NOLINT

struct ComplexLines {
  SomeLines re{}, im{};

  void load(const double* from_re, const double* from_im) {
    std::memcpy(&re, from_re, sizeof re);
    std::memcpy(&im, from_im, sizeof im);
  }
  void store(double* to_re, double* to_im) const {
    std::memcpy(to_re, &re, sizeof re);
    std::memcpy(to_im, &im, sizeof im);
  }
};

/// sum += a b
inline void add_product(const ComplexLines& a, const ComplexLines& b, ComplexLines& sum) {
  sum.re += a.re * b.re;
  sum.im += a.im * b.re;
  sum.re -= a.im * b.im;
  sum.im += a.re * b.im;
}

/// sum += a b*
inline void add_product_conjugate(const ComplexLines& a, const ComplexLines& b, ComplexLines& sum) {
  sum.re += a.re * b.re;
  sum.im += a.im * b.re;
  sum.re += a.im * b.im;
  sum.im -= a.re * b.im;
}

/// A matrix per line, stored by columns.
class LineMatrix {
 public:
  LineMatrix(Eigen::Index rows, Eigen::Index cols)
      : rows_(rows), cols_(cols), values_(static_cast<std::size_t>(rows * cols)) {}
  [[nodiscard]] Eigen::Index rows() const { return rows_; }
  [[nodiscard]] Eigen::Index cols() const { return cols_; }
  ComplexLines& operator()(Eigen::Index i, Eigen::Index j) {
    return values_[static_cast<std::size_t>(i + rows_ * j)];
  }
  const ComplexLines& operator()(Eigen::Index i, Eigen::Index j) const {
    return values_[static_cast<std::size_t>(i + rows_ * j)];
  }
  /// The matrix of one line.
  [[nodiscard]] Eigen::MatrixXcd at(int line) const;
  void set(int line, const Eigen::MatrixXcd& M);

 private:
  Eigen::Index rows_, cols_;
  std::vector<ComplexLines> values_;
};

LineMatrix times(const LineMatrix& A, const LineMatrix& B);          ///< A B
LineMatrix times_adjoint(const LineMatrix& A, const LineMatrix& B);  ///< A Bᴴ
LineMatrix adjoint(const LineMatrix& A);

/// A⁻¹ by elimination with partial pivoting. Whether A can be inverted is not checked.
LineMatrix inverse(LineMatrix A);

/// Of S, Hermitian, and S_rs: |L⁻¹ S_rs|² of each column, S_rr = L Lᴴ, added up over rows; zero in
/// lines whose S_rr is not positive definite. One real row.
LineMatrix explained_powers(LineMatrix S_rr, LineMatrix S_rs);

/// Largest singular value by the smallest, of each line, by one-sided Jacobi rotations. Source:
/// J. Demmel, K. Veselić, SIAM J. Matrix Anal. Appl. 13 (1992) 1204.
void condition(LineMatrix A, SomeLines& result);

}  // namespace hydrapod::identification
