#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::tracking {

/// What the stage must follow, from 0 to alpha of the full stroke, as a function of the phase theta in [0, 1) of
/// one repeat. It begins at its lowest point; between two turning points it moves one way.
///   triangle            0, alpha
///   sine                alpha (1 - cos 2 pi theta)/2
///   two_tone            alpha (1/2 - (cos 2 pi theta + cos 6 pi theta/2)/3): one inner loop on either way
///   decaying_triangle   turns at 0, 1, .1, .9, .2, .8, .3, .7, .4, .6 of alpha, half a period of the operating
///                       frequency each, and begins again: one repeat is five operating periods
class Reference {
 public:
  enum class Shape { triangle, sine, two_tone, decaying_triangle };

  /// InputError when alpha is not above 0.
  explicit Reference(Shape shape = Shape::triangle, double alpha = 1.0);

  Shape shape() const { return shape_; }
  double alpha() const { return alpha_; }
  /// Operating periods in one repeat.
  std::size_t periods() const;
  /// Phases of the turning points, the first one 0; from the even ones (0, 2, …) it rises.
  const std::vector<double>& turns() const { return turns_; }
  /// The piece between two turning points in which theta lies; at a turning point the one that begins there.
  std::size_t piece(double theta) const;
  static bool rises(std::size_t piece) { return piece % 2 == 0; }

  double value(double theta) const;
  /// d/dtheta; at a corner the slope of `piece`.
  double slope(double theta, std::size_t piece) const;
  /// The slowest of its ways from one turning point to the next, where it is fastest: the stroke of a triangle of the operating
  /// frequency with that slope.
  double least_swing() const;
  /// One repeat, evenly.
  std::vector<double> samples(std::size_t count) const;

 private:
  Shape shape_;
  double alpha_;
  std::vector<double> turns_;
};

/// The words of the project file: "triangle", "sine", "two_tone", "decaying_triangle".
std::string_view to_string(Reference::Shape shape);

}  // namespace bodesmith::tracking
