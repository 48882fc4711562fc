#include "fit/alternation.hpp"

#include <algorithm>
#include <cmath>

#include "fit/curve_search.hpp"

namespace bodesmith {

double alternating_level(const std::vector<double>& errors, std::size_t count) {
  // The largest of every run of one sign.
  std::vector<double> peaks;
  for (const double e : errors) {
    if (e == 0.0) continue;
    if (peaks.empty() || (e > 0.0) != (peaks.back() > 0.0)) {
      peaks.push_back(e);
    } else if (std::abs(e) > std::abs(peaks.back())) {
      peaks.back() = e;
    }
  }
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  // Leave out the smallest: alone at an end, with its smaller neighbour inside, where the signs must go on alternating.
  while (peaks.size() > count) {
    const auto least = std::min_element(peaks.begin(), peaks.end(), smaller);
    if (least == peaks.begin() || least + 1 == peaks.end()) {
      peaks.erase(least);
    } else if (peaks.size() == count + 1) {
      peaks.erase(smaller(peaks.front(), peaks.back()) ? peaks.begin() : peaks.end() - 1);
    } else {
      const auto neighbour = smaller(*(least - 1), *(least + 1)) ? least - 1 : least + 1;
      const auto first = std::min(least, neighbour);
      peaks.erase(first, first + 2);
    }
  }
  if (peaks.size() < count || peaks.empty()) return 0.0;
  return std::abs(*std::min_element(peaks.begin(), peaks.end(), smaller));
}

double alternation_bound(const RootModel& model, const CurveTarget& target, const Eigen::VectorXd& theta) {
  Eigen::VectorXd error;
  curve_errors(model, target, theta, error, nullptr);
  const auto count = static_cast<std::size_t>(model.zeros() + model.poles() + 2);
  return alternating_level({error.data(), error.data() + error.size()}, count);
}

}  // namespace bodesmith
