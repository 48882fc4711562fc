#pragma once

#include <Eigen/Core>
#include <vector>

namespace bodesmith {

/// exp(M) of a small dense matrix (row-major, n x n), in place, by scaling and squaring of a Taylor sum:
/// relative error of a few 2^s eps, 2^s the scaling. `work` is resized to what is needed and can be kept: no
/// allocation afterwards.
void matrix_exponential(double* m, int n, std::vector<double>& work);
/// The same of any square matrix.
Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& m);

}  // namespace bodesmith
