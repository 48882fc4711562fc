#pragma once

#include <Eigen/LU>

extern template void Eigen::PartialPivLU<Eigen::MatrixXd>::compute();  // compiled once, in dense.cpp
