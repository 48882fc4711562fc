#include <algorithm>
#include <cmath>

#include "tuning/controller_kind.hpp"

namespace bodesmith::tuning {
namespace {

constexpr Eigen::Index kLoop = 4;  ///< numbers without notches
constexpr Eigen::Index kPerNotch = 3;

/// C(s) = (1 + w_i/s) lead(s) notches(s)/(1 + s/w_r):
///   lead = (1 + s sqrt(a)/w_l)/(1 + s/(w_l sqrt(a))),  notch = (s^2 + 2 z w s + w^2)/(s^2 + 2 p w s + w^2), one a resonance.
/// x = lg of w_i/w_c, a, w_l/w_c, w_r/w_c; then for each notch w/w_resonance, z/p, p.
class NotchLead final : public ControllerKind {
 public:
  NotchLead() : ControllerKind("notch-lead", "integral, lead, a notch a resonance, roll-off") {}
  Bounds bounds(const ShapeSetting& setting) const override {
    const Eigen::Index count = notches(setting);
    Bounds out{Eigen::VectorXd(kLoop + kPerNotch * count), Eigen::VectorXd(kLoop + kPerNotch * count)};
    const double roll_off = std::log10(setting.derivative_corner.value / setting.crossover.value);
    out.lower.head(kLoop) << -3.0, 0.0, -0.3, roll_off - 0.5;
    out.upper.head(kLoop) << setting.decades(), 1.3, 0.7, roll_off;
    for (Eigen::Index i = 0; i < count; ++i) {
      out.lower.segment<kPerNotch>(kLoop + kPerNotch * i) << -0.08, -2.0, -1.5;
      out.upper.segment<kPerNotch>(kLoop + kPerNotch * i) << 0.08, 0.0, 0.2;
    }
    return out;
  }
  SeriesController make(const Eigen::VectorXd& x, const ShapeSetting& setting) const override {
    const double w = setting.crossover.rad_s().value;
    SeriesController out;
    out.pid.proportional = 1.0;
    out.pid.integral_per_s = std::pow(10.0, x(0)) * w;
    const double root_a = std::pow(10.0, 0.5 * x(1));
    const double centre = std::pow(10.0, x(2)) * w;
    out.filter.sections.push_back(
        Section::pole_zero(1.0, RadPerSecond{centre / root_a}, RadPerSecond{centre * root_a}));
    for (Eigen::Index i = 0; i < notches(setting); ++i) {
      const auto y = x.segment<kPerNotch>(kLoop + kPerNotch * i);
      const double at = std::pow(10.0, y(0)) * setting.resonances[static_cast<std::size_t>(i)].rad_s().value;
      const double pole = std::pow(10.0, y(2));
      out.filter.sections.push_back({1.0, roots(at, pole * std::pow(10.0, y(1))), roots(at, pole)});
    }
    const double roll_off = std::pow(10.0, x(3)) * w;
    out.filter.sections.push_back({roll_off, {}, {Complex(-roll_off, 0.0)}});
    return out;
  }

 private:
  /// More than two resonances above the crossover are rolled off.
  static Eigen::Index notches(const ShapeSetting& setting) {
    return static_cast<Eigen::Index>(std::min<std::size_t>(setting.resonances.size(), 2));
  }
  /// Of s^2 + 2 zeta w s + w^2.
  static std::vector<Complex> roots(double w, double zeta) {
    const Complex turn = std::sqrt(Complex(zeta * zeta - 1.0, 0.0));
    return {w * (-zeta + turn), w * (-zeta - turn)};
  }
};

}  // namespace

BODESMITH_ENTRY(ControllerKind, notch_lead_kind, NotchLead)

}  // namespace bodesmith::tuning
