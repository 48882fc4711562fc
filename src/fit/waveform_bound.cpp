#include "fit/waveform_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/progress.hpp"
#include "base/whole_number.hpp"
#include "fit/waveform_problem.hpp"
#include "numeric/dense.hpp"
#include "numeric/index.hpp"

namespace bodesmith {
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
  explicit WeightedProblem(const WaveformProblem& problem)
      : map_(problem.map().matrix()), gram_(map_.transpose() * map_) {
    const SharedHarmonics shared(problem.operating());
    unknowns_ = shared.unknowns();
    for (std::size_t i = 0; i < problem.count(); ++i) {
      // -e at G = 0.
      VectorXd e;
      problem.map().apply(Eigen::VectorXcd::Zero(kSearchHarmonics + 1), nullptr, problem.gains(i), e,
                          nullptr);
      target_.push_back(-e);
      pull_.push_back(map_.transpose() * target_.back());
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
