#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

namespace bodesmith {

// The dense linear algebra that many files need, compiled once: Eigen's decompositions and products cost
// seconds wherever they are instantiated. Same algorithms, same digits as the expressions named.

/// AᵀA.
Eigen::MatrixXd gram(const Eigen::MatrixXd& a);
/// Aᵀv.
Eigen::VectorXd transpose_times(const Eigen::MatrixXd& a, const Eigen::VectorXd& v);
/// A v and A B.
Eigen::VectorXd times(const Eigen::MatrixXd& a, const Eigen::VectorXd& v);
Eigen::MatrixXd times(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// L of A = L Lᵀ for a symmetric positive definite A, zeros above.
Eigen::MatrixXd cholesky_factor(const Eigen::MatrixXd& a);
/// X of L X = B, L lower triangular.
Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& l, const Eigen::MatrixXd& b);

/// x of A x = b for a symmetric positive (semi)definite A, by LDLᵀ.
Eigen::VectorXd solve_ldlt(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// The same for every column of B.
Eigen::MatrixXd solve_ldlt_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// x of A x = b for any square A, by LU with partial pivoting.
Eigen::VectorXd solve_lu(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::VectorXcd solve_lu(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b);
/// The same for every column of B.
Eigen::MatrixXd solve_lu_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXcd solve_lu_columns(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);
/// A⁻¹ and det A by the same.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);
Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& a);
std::complex<double> determinant(const Eigen::MatrixXcd& a);

/// Orthonormal columns that span A's, by Householder's reflections; A has no fewer rows than columns.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& a);

/// X of least norm that leaves the least of A X = B, columns of A that depend on others included.
Eigen::MatrixXd least_norm_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// A = U diag(values) Vᵀ for a square A, values falling.
struct SquareSvd {
  Eigen::MatrixXd u;
  Eigen::VectorXd values;
  Eigen::MatrixXd v;
};
SquareSvd square_svd(const Eigen::MatrixXd& a);
/// Falling.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);
/// The right singular vector of the smallest singular value, by way of A's triangular factor; A has no fewer rows than
/// columns.
Eigen::VectorXd smallest_singular_vector(const Eigen::MatrixXd& a);

/// A = V diag(values) Vᵀ for a symmetric A, values rising.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
/// Eigenvalues of any square real A, in no order; none where the iteration does not end.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a);

/// A V = V diag(values) for any square real A; nothing where the iteration does not end.
struct EigenSystem {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};
std::optional<EigenSystem> eigen_system(const Eigen::MatrixXd& a);

/// exp(M) of a small dense matrix (row-major, n x n), in place, by scaling and squaring of a Taylor sum:
/// relative error of a few 2^s eps, 2^s the scaling. `work` is resized to what is needed and can be kept: no
/// allocation afterwards.
void matrix_exponential(double* m, int n, std::vector<double>& work);
/// The same of any square matrix.
Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& m);

}  // namespace bodesmith
