#include "fit/waveform/waveform_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/whole_number.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr Index kUnknowns = 2 * kSearchHarmonics + 1;  ///< Re G_0, Re G_1, Im G_1, ...

VectorXcd coefficients(const Disturbance& disturbance, DrivenPath path) {
  const auto series = triangle_series(disturbance, path, kSearchHarmonics).coefficient;
  return Eigen::Map<const VectorXcd>(series.data(), eigen_index(series.size()));
}

/// What one branch contributes to the whole waveform.
VectorXcd branch_coefficients(Disturbance disturbance, Disturbance::Branch branch) {
  (branch == Disturbance::Branch::ascending ? disturbance.descending : disturbance.ascending) = {0.0, 0.0,
                                                                                                 0.0};
  return coefficients(disturbance, DrivenPath::whole);
}

/// Samples of the half of the period that counts, as a factor of their Gram matrix. Half a period holds about half as many
/// independent waveforms as the whole: what is smaller than a ten-millionth of the largest is left out.
MatrixXd half_period_map(const VectorXcd& coefficient, DrivenPath path) {
  constexpr Index kSamples = 4 * kSearchHarmonics;
  MatrixXd map(kSamples / 2, kUnknowns);
  for (Index m = 0; m < kSamples / 2; ++m) {
    const double phase =
        (static_cast<double>(m) + 0.5) / kSamples + (path == DrivenPath::descending ? 0.5 : 0.0);
    map(m, 0) = coefficient(0).real();
    for (Index k = 1; k <= kSearchHarmonics; ++k) {
      const double turns = std::fmod(static_cast<double>(k) * phase, 1.0);
      const Complex turn = 2.0 * coefficient(k) * std::polar(1.0, 2.0 * std::numbers::pi * turns);
      map(m, 2 * k - 1) = turn.real();
      map(m, 2 * k) = -turn.imag();
    }
  }
  map /= std::sqrt(static_cast<double>(kSamples));
  constexpr double kNegligible = 1e-14;  // of the largest, squared
  const SymmetricEigen own = symmetric_eigen(gram(map));
  const double largest = own.values(kUnknowns - 1);
  Index first = 0;
  while (own.values(first) < kNegligible * largest) ++first;
  const Index kept = kUnknowns - first;
  return own.values.tail(kept).cwiseSqrt().asDiagonal() * own.vectors.rightCols(kept).transpose();
}

}  // namespace

WaveformErrorMap::WaveformErrorMap(const Disturbance& disturbance, DrivenPath path)
    : path_(path), coefficient_(coefficients(disturbance, path)) {
  if (path == DrivenPath::whole) {
    ascending_ = branch_coefficients(disturbance, Disturbance::Branch::ascending);
    descending_ = branch_coefficients(disturbance, Disturbance::Branch::descending);
  } else {
    window_ = half_period_map(coefficient_, path);
    by_window_ = FixedMatrix(window_);
  }
}

Index WaveformErrorMap::rows() const {
  return path_ == DrivenPath::whole ? kUnknowns : window_.rows();
}

void WaveformErrorMap::apply(const VectorXcd& g, const MatrixXcd* g_slope, const BranchGains& gains,
                             VectorXd& e, MatrixXd* slope) const {
  if (path_ == DrivenPath::whole)
    apply_whole(g, g_slope, gains, e, slope);
  else
    apply_half(g, g_slope, path_ == DrivenPath::ascending ? gains.ascending : gains.descending, e, slope);
}

void WaveformErrorMap::apply_whole(const VectorXcd& g, const MatrixXcd* g_slope, const BranchGains& gains,
                                   VectorXd& e, MatrixXd* slope) const {
  e.resize(rows());
  if (slope != nullptr) slope->resize(rows(), g_slope->cols());
  for (Index k = 0; k <= kSearchHarmonics; ++k) {
    const Complex u = coefficient_(k);
    const double size = k == 0 ? 1.0 : std::numbers::sqrt2;
    const Complex error =
        size * (g(k) * u - gains.ascending * ascending_(k) - gains.descending * descending_(k));
    const Index row = k == 0 ? 0 : 2 * k - 1;
    e(row) = error.real();
    if (k > 0) e(row + 1) = error.imag();
    if (slope == nullptr) continue;
    const Eigen::RowVectorXcd change = size * u * g_slope->row(k);
    slope->row(row) = change.real();
    if (k > 0) slope->row(row + 1) = change.imag();
  }
}

void WaveformErrorMap::apply_half(const VectorXcd& g, const MatrixXcd* g_slope, double gain, VectorXd& e,
                                  MatrixXd* slope) const {
  VectorXd parts(kUnknowns);
  parts(0) = g(0).real() - gain;
  for (Index k = 1; k <= kSearchHarmonics; ++k) {
    parts(2 * k - 1) = g(k).real() - gain;
    parts(2 * k) = g(k).imag();
  }
  e = by_window_.times(parts).col(0);
  if (slope == nullptr) return;
  MatrixXd changes(kUnknowns, g_slope->cols());
  changes.row(0) = g_slope->row(0).real();
  for (Index k = 1; k <= kSearchHarmonics; ++k) {
    changes.row(2 * k - 1) = g_slope->row(k).real();
    changes.row(2 * k) = g_slope->row(k).imag();
  }
  *slope = by_window_.times(changes);
}

MatrixXd WaveformErrorMap::matrix() const {
  if (path_ != DrivenPath::whole) return window_;
  MatrixXd out = MatrixXd::Zero(rows(), rows());
  out(0, 0) = coefficient_(0).real();
  for (Index k = 1; k <= kSearchHarmonics; ++k) {
    const Complex u = std::numbers::sqrt2 * coefficient_(k);
    out(2 * k - 1, 2 * k - 1) = u.real();
    out(2 * k - 1, 2 * k) = -u.imag();
    out(2 * k, 2 * k - 1) = u.imag();
    out(2 * k, 2 * k) = u.real();
  }
  return out;
}

WaveformProblem::WaveformProblem(const Disturbance& disturbance, const std::vector<Hertz>& operating,
                                 DrivenPath path)
    : map_(disturbance, path), operating_(operating) {
  for (const Hertz f : operating) {
    gains_.push_back({disturbance.rate_gain(Disturbance::Branch::ascending, f),
                      disturbance.rate_gain(Disturbance::Branch::descending, f)});
    std::vector<RadPerSecond>& harmonics = harmonics_.emplace_back();
    for (Index k = 0; k <= kSearchHarmonics; ++k) {
      // A real G has a real limit at 0 Hz; a frequency next to it stands for it.
      harmonics.push_back(Hertz{f.value * (k == 0 ? 1e-9 : static_cast<double>(k))}.rad_s());
    }
  }
}

void WaveformProblem::error(const RootModel& model, const VectorXd& theta, std::size_t i, VectorXd& e,
                            MatrixXd* slope) const {
  VectorXcd g;
  MatrixXcd g_slope;
  if (slope != nullptr) g_slope.resize(kSearchHarmonics + 1, theta.size());
  RootResponse(model, theta).values(harmonics_[i], g, slope != nullptr ? &g_slope : nullptr);
  g(0) = g(0).real();
  if (slope != nullptr) g_slope.array().colwise() *= g.array();
  map_.apply(g, slope != nullptr ? &g_slope : nullptr, gains_[i], e, slope);
}

void WaveformProblem::errors(const RootModel& model, const VectorXd& theta, VectorXd& e,
                             MatrixXd* slope) const {
  const Index rows = map_.rows();
  e.resize(rows * eigen_index(count()));
  if (slope != nullptr) slope->resize(e.size(), theta.size());
  const double root = std::sqrt(1.0 / static_cast<double>(count()));
  VectorXd one;
  MatrixXd part;
  for (std::size_t i = 0; i < count(); ++i) {
    error(model, theta, i, one, slope != nullptr ? &part : nullptr);
    const Index first = eigen_index(i) * rows;
    e.segment(first, rows) = root * one;
    if (slope != nullptr) slope->middleRows(first, rows) = root * part;
  }
}

double WaveformProblem::worst_square(const RootModel& model, const VectorXd& theta) const {
  double worst = 0.0;
  VectorXd e;
  for (std::size_t i = 0; i < count(); ++i) {
    error(model, theta, i, e, nullptr);
    worst = std::max(worst, e.squaredNorm());
  }
  return worst;
}

std::vector<Hertz> checked_operating(const Disturbance& disturbance, std::vector<Hertz> operating) {
  if (operating.empty()) operating = operating_frequencies(disturbance);
  if (operating.empty()) {
    throw InputError(
        "the disturbance has no rate gains, expected a 'rate' table (a static disturbance needs no filter)");
  }
  std::ranges::sort(operating);
  return operating;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kReweightings = 60;  ///< for the worst frequency: the bound then stands to four digits

/// Unknowns of the least squares problem: Re and Im of G at each distinct frequency (Re only at 0).
class SharedHarmonics {
 public:
  explicit SharedHarmonics(const std::vector<Hertz>& operating) : operating_(operating) {
    for (const Hertz f : operating) {
      for (Index k = 1; k <= kSearchHarmonics; ++k) {
        if (place_.emplace(key(f, k), unknowns_).second) unknowns_ += 2;
      }
    }
  }

  Index unknowns() const { return unknowns_; }
  /// Of column c (0: Re G_0, then Re G_1, Im G_1, ...) of operating frequency i.
  Index unknown(std::size_t i, Index c) const {
    if (c == 0) return 0;
    return place_.at(key(operating_[i], (c + 1) / 2)) + (c + 1) % 2;
  }

 private:
  /// Harmonics closer than a tenth of a microhertz are one.
  static long long key(Hertz f, Index k) {
    return whole_number<long long>(std::round(f.value * static_cast<double>(k) * 1e7));
  }

  const std::vector<Hertz>& operating_;
  std::map<long long, Index> place_;
  Index unknowns_ = 1;
};

/// The least squares problem for any weights of the frequencies; what does not depend on these is made once.
class WeightedProblem {
 public:
  explicit WeightedProblem(const WaveformProblem& problem) : map_(problem.map().matrix()), gram_(gram(map_)) {
    const SharedHarmonics shared(problem.operating());
    unknowns_ = shared.unknowns();
    for (std::size_t i = 0; i < problem.count(); ++i) {
      // -e at G = 0.
      VectorXd e;
      problem.map().apply(Eigen::VectorXcd::Zero(kSearchHarmonics + 1), nullptr, problem.gains(i), e,
                          nullptr);
      target_.push_back(-e);
      pull_.push_back(transpose_times(map_, target_.back()));
      auto& place = place_.emplace_back();
      for (Index a = 0; a < map_.cols(); ++a) place.push_back(shared.unknown(i, a));
    }
  }

  /// Mean square errors of the best G at each operating frequency.
  std::vector<double> best_possible(const std::vector<double>& weight) const {
    MatrixXd normal = MatrixXd::Zero(unknowns_, unknowns_);
    VectorXd right = VectorXd::Zero(unknowns_);
    for (std::size_t i = 0; i < place_.size(); ++i) {
      const std::vector<Index>& place = place_[i];
      for (Index a = 0; a < map_.cols(); ++a) right(place[std_index(a)]) += weight[i] * pull_[i](a);
      for (Index b = 0; b < map_.cols(); ++b) {
        double* column = normal.col(place[std_index(b)]).data();
        for (Index a = 0; a < map_.cols(); ++a) column[place[std_index(a)]] += weight[i] * gram_(a, b);
      }
    }
    normal.diagonal().array() += 1e-13 * normal.diagonal().maxCoeff();
    const VectorXd g = solve_ldlt(normal, right);
    std::vector<double> out;
    for (std::size_t i = 0; i < place_.size(); ++i) {
      VectorXd part(map_.cols());
      for (Index a = 0; a < map_.cols(); ++a) part(a) = g(place_[i][std_index(a)]);
      out.push_back((map_ * part - target_[i]).squaredNorm());
    }
    return out;
  }

 private:
  MatrixXd map_;
  MatrixXd gram_;
  Index unknowns_ = 0;
  std::vector<VectorXd> target_, pull_;  ///< each operating frequency
  std::vector<std::vector<Index>> place_;
};

}  // namespace

double waveform_lower_bound(const Disturbance& disturbance, const std::vector<Hertz>& given, DrivenPath path,
                            bool worst) {
  const std::vector<Hertz> operating = checked_operating(disturbance, given);
  const WaveformProblem waveforms(disturbance, operating, path);
  const WeightedProblem problem(waveforms);
  std::vector<double> weight(operating.size(), 1.0 / static_cast<double>(operating.size()));
  double bound = 0.0;
  for (int iteration = 0; iteration < (worst ? kReweightings : 1); ++iteration) {
    stop_if_interrupted();
    const std::vector<double> square = problem.best_possible(weight);
    double sum = 0.0;
    double total = 0.0;
    for (std::size_t i = 0; i < square.size(); ++i) sum += weight[i] * square[i];
    bound = std::max(bound, sum);
    // Towards the frequencies with the larger errors; none quite to 0.
    for (std::size_t i = 0; i < square.size(); ++i) {
      weight[i] *= std::sqrt(square[i] + 1e-12 * sum) + std::numeric_limits<double>::min();
      total += weight[i];
    }
    for (double& w : weight) w /= total;
  }
  return 100.0 * std::sqrt(bound);
}

}  // namespace bodesmith
