// Gains at a few frequencies to sections, parts and their tolerances, with the installed library alone.
#include <bodesmith/bodesmith.hpp>
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
  // By way of a fractional cascade, and directly.
  const bodesmith::CascadeFit fit = bodesmith::fit_cascade(points);
  bodesmith::ApproximationOptions options;
  options.order = 3;
  const auto sections = bodesmith::approximate_cascade(fit.cascade, options).sections;
  const double gain = std::abs(sections.response(bodesmith::Hertz{100.0}.rad_s()));
  std::printf("gain at 100 Hz: %.4f\n", gain);
  const bodesmith::DirectFit direct = bodesmith::fit_directly_within(points, {}, 0.05, 1, 4);
  std::printf("%d poles directly, %.3f dB from the points\n", direct.sections.pole_count(), direct.max_db);

  // Op-amps and preferred values, and what tolerances of 1 % and 5 % do to them.
  const bodesmith::synthesis::Realised made = bodesmith::synthesis::realise(direct.sections);
  bodesmith::tolerance::Options tolerances;
  tolerances.samples = 2000;
  tolerances.grid = bodesmith::log_grid({bodesmith::Hertz{1.0}, bodesmith::Hertz{100.0}}, 20);
  const auto design = bodesmith::tolerance::design_of_circuit(made.circuit, direct.sections, "consumer",
                                                              bodesmith::tolerance::OpAmps::ideal);
  const auto statistics = bodesmith::tolerance::run_monte_carlo(design, tolerances, bodesmith::Team());
  const double within_db = statistics.worst_db.quantile(0.95);
  std::printf("95 of 100 circuits within %.2f dB\n", within_db);
  const bool good =
      std::abs(gain - 1.17) < 0.002 && direct.max_db <= 0.05 && within_db > 0.0 && within_db < 1.0;
  return good ? 0 : 1;
}
