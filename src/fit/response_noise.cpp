#include "fit/response_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "signal/statistics.hpp"

namespace bodesmith {
namespace {

constexpr double kLeastRelative = 1e-7;

/// |deviation| squared of every inner point from the line through its neighbours, as the variance of one point.
std::vector<double> neighbour_variances(const FrequencyRecord& record) {
  std::vector<double> out;
  for (std::size_t i = 1; i + 1 < record.response.size(); ++i) {
    const double low = std::log(record.frequency[i - 1].value);
    const double high = std::log(record.frequency[i + 1].value);
    const double t = (std::log(record.frequency[i].value) - low) / (high - low);
    const std::complex<double> line = (1.0 - t) * record.response[i - 1] + t * record.response[i + 1];
    out.push_back(std::norm(record.response[i] - line) / (1.0 + (1.0 - t) * (1.0 - t) + t * t));
  }
  return out;
}

std::size_t half_window(std::size_t count) {
  return std::clamp<std::size_t>(count / 60, 5, 60);
}

/// variance = floor + share |H|^2.
struct TwoPartNoise {
  double floor = 0.0;
  double share = 0.0;
  double variance(std::complex<double> h) const { return floor + share * std::norm(h); }
};

/// By reweighted least squares of |error|^2 on 1 and |H|^2, both parts at least a trace above 0.
TwoPartNoise two_part_noise(const std::vector<std::complex<double>>& errors,
                            const std::vector<std::complex<double>>& response) {
  const auto count = static_cast<double>(errors.size());
  double all = 0.0;
  double power = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    all += std::norm(errors[i]) / count;
    power += std::norm(response[i]) / count;
  }
  const double trace = 1e-14 * power + 1e-290;
  TwoPartNoise out{std::max(0.5 * all, trace), std::max(0.5 * all / std::max(power, 1e-290), 1e-14)};
  for (int round = 0; round < 30; ++round) {
    double s11 = 0.0, s1h = 0.0, shh = 0.0, e1 = 0.0, eh = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double h = std::norm(response[i]);
      const double weight = 1.0 / std::pow(out.variance(response[i]), 2);
      const double e = std::norm(errors[i]);
      s11 += weight, s1h += weight * h, shh += weight * h * h, e1 += weight * e, eh += weight * e * h;
    }
    const double determinant = s11 * shh - s1h * s1h;
    if (!(determinant > 1e-12 * s11 * shh)) break;
    const double floor = (e1 * shh - eh * s1h) / determinant;
    const double share = (s11 * eh - s1h * e1) / determinant;
    // One part negative: the other takes all.
    out = floor < 0.0   ? TwoPartNoise{1e-6 * out.floor + trace, std::max(eh / shh, 1e-14)}
          : share < 0.0 ? TwoPartNoise{std::max(e1 / s11, trace), 1e-6 * out.share + 1e-14}
                        : TwoPartNoise{std::max(floor, trace), std::max(share, 1e-14)};
  }
  return out;
}

}  // namespace

std::vector<double> noise_from_neighbours(const FrequencyRecord& record) {
  const std::size_t count = record.response.size();
  const std::vector<double> variances = neighbour_variances(record);
  const std::size_t half = half_window(count);
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i > half + 1 ? i - half - 1 : 0;
    const std::size_t to = std::min(variances.size(), i + half);
    std::vector<double> window(variances.begin() + static_cast<std::ptrdiff_t>(std::min(from, to)),
                               variances.begin() + static_cast<std::ptrdiff_t>(to));
    double variance = 0.0;
    if (!window.empty()) {
      variance = median(std::move(window)) / std::log(2.0);  // |complex normal|^2 is exponential
    }
    const double magnitude = std::abs(record.response[i]);
    out[i] = std::max(std::sqrt(variance), kLeastRelative * magnitude);
    if (!record.coherence.empty()) {
      const double c = std::clamp(record.coherence[i], 1e-3, 1.0);
      out[i] = std::max(out[i], magnitude * std::sqrt((1.0 - c) / (2.0 * c)));
    }
    if (!(out[i] > 0.0)) out[i] = 1e-300;
  }
  return out;
}

std::vector<double> noise_from_errors(const std::vector<std::complex<double>>& errors,
                                      const std::vector<std::complex<double>>& response) {
  const std::size_t count = errors.size();
  const TwoPartNoise parts = two_part_noise(errors, response);
  const std::size_t half = std::clamp<std::size_t>(count / 12, 20, 400);
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i > half ? i - half : 0;
    const std::size_t to = std::min(count, i + half + 1);
    // Summed anew: magnitudes of many decades would leave nothing of a running sum.
    double mean = 0.0;
    for (std::size_t j = from; j < to; ++j) mean += std::norm(errors[j]) / parts.variance(response[j]);
    mean /= static_cast<double>(to - from);
    out[i] = std::max(std::sqrt(mean * parts.variance(response[i])), kLeastRelative * std::abs(response[i]));
    if (!(out[i] > 0.0)) out[i] = 1e-300;
  }
  return out;
}

}  // namespace bodesmith
