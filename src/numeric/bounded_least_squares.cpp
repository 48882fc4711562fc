#include "numeric/bounded_least_squares.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bodesmith {
namespace {

using Real = long double;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

Matrix to_eigen(const LongMatrix& a) {
  const auto rows = static_cast<Eigen::Index>(a.size());
  const auto columns = static_cast<Eigen::Index>(a.empty() ? 0 : a.front().size());
  Matrix out(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) out(i, j) = a[static_cast<size_t>(i)][static_cast<size_t>(j)];
  }
  return out;
}

Vector to_eigen(const LongVector& b) {
  return Eigen::Map<const Vector>(b.data(), static_cast<Eigen::Index>(b.size()));
}

Vector solve(const Matrix& a, const Vector& b) {
  const Eigen::ColPivHouseholderQR<Matrix> qr(a);
  Vector x = qr.solve(b);
  x += qr.solve(b - a * x);
  return x;
}

}  // namespace

LongVector least_squares(const LongMatrix& a, const LongVector& b) {
  const Vector x = solve(to_eigen(a), to_eigen(b));
  return {x.data(), x.data() + x.size()};
}

LongMatrix least_squares_inverse(const LongMatrix& a) {
  const Matrix m = to_eigen(a);
  const Matrix inverse = Eigen::ColPivHouseholderQR<Matrix>(m).solve(Matrix::Identity(m.rows(), m.rows()));
  LongMatrix out;
  for (Eigen::Index i = 0; i < inverse.rows(); ++i) {
    const Vector row = inverse.row(i);
    out.emplace_back(row.data(), row.data() + row.size());
  }
  return out;
}

double condition_number(const LongMatrix& a) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(to_eigen(a).cast<double>());
  const auto& values = svd.singularValues();
  const double least = values(values.size() - 1);
  return least > 0.0 ? values(0) / least : std::numeric_limits<double>::infinity();
}

BoundedSolution bounded_least_squares(const LongMatrix& rows, const LongVector& wanted, Real lower,
                                      Real upper) {
  const Matrix a = to_eigen(rows);
  const Vector b = to_eigen(wanted);
  const Eigen::Index n = a.cols();
  Vector x = Vector::Constant(n, lower);
  std::vector<int> bound(static_cast<size_t>(n), -1);
  const auto at = [&](Eigen::Index i) -> int& { return bound[static_cast<size_t>(i)]; };
  const Real tiny = 1e-15L * (1.0L + b.norm()) * (1.0L + a.norm());
  std::vector<char> barred(static_cast<size_t>(n), 0);  // freed in vain at this corner (rounding)
  for (int guard = 0; guard < 100 * (static_cast<int>(n) + 1); ++guard) {
    const Vector downhill = a.transpose() * (b - a * x);
    Eigen::Index enter = -1;
    Real steepest = tiny;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (at(i) == 0 || barred[static_cast<size_t>(i)] != 0) continue;
      const Real gain = at(i) < 0 ? downhill(i) : -downhill(i);
      if (gain > steepest) {
        steepest = gain;
        enter = i;
      }
    }
    if (enter < 0) break;
    const int came_from = at(enter);
    at(enter) = 0;
    for (bool first = true;; first = false) {
      std::vector<Eigen::Index> free;
      Vector fixed_part = b;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (at(i) == 0)
          free.push_back(i);
        else
          fixed_part -= a.col(i) * x(i);
      }
      if (free.empty()) break;
      Matrix part(a.rows(), static_cast<Eigen::Index>(free.size()));
      for (size_t j = 0; j < free.size(); ++j) part.col(static_cast<Eigen::Index>(j)) = a.col(free[j]);
      const Vector target = solve(part, fixed_part);
      // The way from x to the target, up to the first bound.
      Real way = 1.0L;
      Eigen::Index stop = -1;
      int side = 0;
      for (size_t j = 0; j < free.size(); ++j) {
        const Eigen::Index i = free[j];
        const Real z = target(static_cast<Eigen::Index>(j));
        if (z >= lower && z <= upper) continue;
        const Real edge = z < lower ? lower : upper;
        const Real step = z == x(i) ? 0.0L : (edge - x(i)) / (z - x(i));
        if (step < way || stop < 0) {
          way = std::clamp(step, 0.0L, 1.0L);
          stop = i;
          side = z < lower ? -1 : 1;
        }
      }
      for (size_t j = 0; j < free.size(); ++j) {
        const Eigen::Index i = free[j];
        x(i) += way * (target(static_cast<Eigen::Index>(j)) - x(i));
      }
      if (stop < 0) {
        std::fill(barred.begin(), barred.end(), 0);
        break;
      }
      x(stop) = side < 0 ? lower : upper;
      at(stop) = side;
      if (first && stop == enter && side == came_from) {
        barred[static_cast<size_t>(enter)] = 1;
        break;
      }
    }
  }
  BoundedSolution out;
  out.x.assign(x.data(), x.data() + n);
  out.bound = bound;
  const Vector downhill = a.transpose() * (b - a * x);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Real violation = at(i) == 0 ? std::abs(downhill(i)) : at(i) < 0 ? downhill(i) : -downhill(i);
    out.optimality_residual = std::max(out.optimality_residual, violation);
  }
  return out;
}

}  // namespace bodesmith
