#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Amplitude and phase (degrees, at t = 0 of the scene) of a sine in the residual.
std::pair<double, double> fit_line(const Scene& scene, double hz) {
  double s = 0.0;
  double c = 0.0;
  const double w = Hertz{hz}.rad_s().value;
  for (std::size_t i = 0; i < scene.residual.size(); ++i) {
    const double t = scene.start_s + scene.step_s * static_cast<double>(i);
    s += scene.residual[i] * std::sin(w * t);
    c += scene.residual[i] * std::cos(w * t);
  }
  const double n = 0.5 * static_cast<double>(scene.residual.size());
  return {std::hypot(s, c) / n, to_degrees(std::atan2(c, s))};
}

class MainsHum final : public Effect {
 public:
  std::string_view name() const override { return "mains_hum"; }
  std::string_view what() const override { return "a sinusoid of the mains is added"; }
  std::string_view symptom() const override { return "a line of the residual at 50 or 60 Hz or a harmonic"; }
  std::vector<std::string_view> confused_with() const override { return {"resonance"}; }
  std::string_view experiment() const override { return "a record without drive: hum stays"; }
  bool independent_of_input() const override { return true; }
  /// The mains and its harmonics are separate lines.
  bool repeatable() const override { return true; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    struct Line {
      double hz;
      double amplitude;
      double phase_deg;
    };
    std::vector<Line> lines;
    for (double mains : {50.0, 60.0}) {
      for (int harmonic = 1; harmonic <= 5; ++harmonic) {
        const double hz = mains * harmonic;
        if (hz > 0.8 * scene.top_hz || hz * scene.duration_s < 3.0) continue;
        const auto [amplitude, phase] = fit_line(scene, hz);
        lines.push_back({hz, amplitude, phase});
      }
    }
    std::sort(lines.begin(), lines.end(),
              [](const Line& a, const Line& b) { return a.amplitude > b.amplitude; });
    if (lines.size() > 2) lines.resize(2);
    for (const auto& line : lines) {
      auto block = chain::make_block("hum");
      block.set("frequency_hz", line.hz);
      const double size = scene.boundary.back().size();
      out.push_back(insert_block(
          scene, *this, scene.model->size(), block,
          {linear_unknown("amplitude", -10.0 * size, 10.0 * size, std::max(line.amplitude, 1e-6 * size)),
           linear_unknown("phase_deg", -1e4, 1e4, 30.0)},
          {{std::max(line.amplitude, 1e-6 * size), line.phase_deg}}));
    }
  }
};

}  // namespace

const Effect& mains_hum_effect() {
  static const MainsHum effect;
  return effect;
}

}  // namespace bodesmith::gap
