#pragma once

#include <Eigen/Core>

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

/// x of A x = b for a symmetric positive (semi)definite A, by LDLᵀ.
Eigen::VectorXd solve_ldlt(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// x of A x = b for any square A, by LU with partial pivoting.
Eigen::VectorXd solve_lu(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::VectorXcd solve_lu(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b);
/// x of min |A x − b|, A with independent columns, by QR with column pivoting.
Eigen::VectorXd solve_qr(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// Falling.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);

/// A = V diag(values) Vᵀ for a symmetric A, values rising.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
/// Eigenvalues of any square real A, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a);

}  // namespace bodesmith
