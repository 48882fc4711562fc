// Gains at a few frequencies to integer sections, with the installed library alone.
#include <bodesmith/approximate/approximate.hpp>
#include <bodesmith/fit/cascade_fit.hpp>
#include <cmath>
#include <cstdio>

int main() {
  bodesmith::BodePoints points;
  for (const auto& [f, gain] : {std::pair{1.0, 1.0}, {10.0, 1.06}, {100.0, 1.17}}) {
    bodesmith::BodePoint point;
    point.frequency = bodesmith::Hertz{f};
    point.gain = gain;
    points.points.push_back(point);
  }
  const bodesmith::CascadeFit fit = bodesmith::fit_cascade(points);
  bodesmith::ApproximationOptions options;
  options.order = 3;
  const auto sections = bodesmith::approximate_cascade(fit.cascade, options).sections;
  const double gain = std::abs(sections.response(bodesmith::Hertz{100.0}.rad_s()));
  std::printf("gain at 100 Hz: %.4f\n", gain);
  return std::abs(gain - 1.17) < 0.002 ? 0 : 1;
}
