#include "tracking/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/error.hpp"

namespace bodesmith::tracking {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kThird = 0.5;  ///< the third harmonic of two_tone, relative to the fundamental
constexpr std::array<double, 10> kDecaying = {0.0, 1.0, 0.1, 0.9, 0.2, 0.8, 0.3, 0.7, 0.4, 0.6};

double decaying_corner(std::size_t piece) {
  return kDecaying[piece % kDecaying.size()];
}

/// Where the slope sin a + 3 k sin 3a = sin a (1 + 9 k - 12 k sin^2 a) of two_tone is 0, in turns.
std::vector<double> two_tone_turns() {
  const double inner = std::asin(std::sqrt((1.0 + 9.0 * kThird) / (12.0 * kThird))) / kTwoPi;
  return {0.0, inner, 0.5 - inner, 0.5, 0.5 + inner, 1.0 - inner};
}

std::vector<double> turns_of(Reference::Shape shape) {
  if (shape == Reference::Shape::two_tone) return two_tone_turns();
  if (shape != Reference::Shape::decaying_triangle) return {0.0, 0.5};
  std::vector<double> out;
  for (std::size_t i = 0; i < kDecaying.size(); ++i)
    out.push_back(static_cast<double>(i) / static_cast<double>(kDecaying.size()));
  return out;
}

}  // namespace

Reference::Reference(Shape shape, double alpha) : shape_(shape), alpha_(alpha), turns_(turns_of(shape)) {
  // Of the full stroke; below a millionth of it there is nothing to track.
  if (!(alpha >= 1e-6 && alpha <= 1.0))
    throw InputError(
        fmt::format("the reference's amplitude is {} of the full stroke, expected 1e-06 to 1", alpha));
}

std::size_t Reference::periods() const {
  return shape_ == Shape::decaying_triangle ? kDecaying.size() / 2 : 1;
}

std::size_t Reference::piece(double theta) const {
  const auto next = std::upper_bound(turns_.begin(), turns_.end(), theta);
  return next == turns_.begin() ? 0 : static_cast<std::size_t>(next - turns_.begin()) - 1;
}

double Reference::value(double theta) const {
  switch (shape_) {
    case Shape::triangle:
      return alpha_ * (theta < 0.5 ? 2.0 * theta : 2.0 - 2.0 * theta);
    case Shape::sine: {
      const double s = std::sin(0.5 * kTwoPi * theta);
      return alpha_ * s * s;
    }
    case Shape::two_tone: {
      const double sum = std::cos(kTwoPi * theta) + kThird * std::cos(3.0 * kTwoPi * theta);
      return alpha_ * 0.5 * (1.0 - sum / (1.0 + kThird));
    }
    case Shape::decaying_triangle: {
      const double at = theta * static_cast<double>(kDecaying.size());
      const auto i = static_cast<std::size_t>(at);
      const double from = decaying_corner(i);
      return alpha_ * (from + (at - static_cast<double>(i)) * (decaying_corner(i + 1) - from));
    }
  }
  return 0.0;
}

double Reference::slope(double theta, std::size_t piece) const {
  switch (shape_) {
    case Shape::triangle:
      return rises(piece) ? 2.0 * alpha_ : -2.0 * alpha_;
    case Shape::sine:
      return alpha_ * 0.5 * kTwoPi * std::sin(kTwoPi * theta);
    case Shape::two_tone: {
      const double sum = std::sin(kTwoPi * theta) + 3.0 * kThird * std::sin(3.0 * kTwoPi * theta);
      return alpha_ * 0.5 * kTwoPi * sum / (1.0 + kThird);
    }
    case Shape::decaying_triangle:
      return alpha_ * (decaying_corner(piece + 1) - decaying_corner(piece)) *
             static_cast<double>(kDecaying.size());
  }
  return 0.0;
}

double Reference::least_swing() const {
  constexpr int kLooks = 32;
  double least = INFINITY;
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const double from = turns_[i], to = i + 1 < turns_.size() ? turns_[i + 1] : 1.0;
    double fastest = 0.0;
    for (int k = 0; k < kLooks; ++k)
      fastest = std::max(fastest, std::abs(slope(from + (to - from) * (k + 0.5) / kLooks, i)));
    least = std::min(least, fastest);
  }
  return 0.5 * least / static_cast<double>(periods());
}

std::vector<double> Reference::samples(std::size_t count) const {
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back(value(static_cast<double>(i) / static_cast<double>(count)));
  return out;
}

std::string_view to_string(Reference::Shape shape) {
  constexpr std::array kWords = {"triangle", "sine", "two_tone", "decaying_triangle"};
  return kWords.at(static_cast<std::size_t>(shape));
}

}  // namespace bodesmith::tracking
