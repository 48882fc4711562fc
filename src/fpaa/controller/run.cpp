#include "fpaa/controller/run.hpp"
#include "numeric/quadratic_roots.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {
namespace {

/// Of its time constants that a filter is left to settle: 3e-4 of its start is left.
constexpr double kTimeConstants = 8.0;
/// Of the fast clock, from rest: loop and slope detector.
constexpr double kSettlingCycles = 500.0;

/// The slowest time constant of a transfer of first or second order, in cycles; 0 without poles.
double slowest_cycles(std::vector<double> denominator) {
  denominator.resize(3, 0.0);
  double largest = 0.0;
  for (const auto& pole : quadratic_roots(denominator[2], denominator[1], denominator[0]))
    largest = std::max(largest, std::abs(pole));
  return largest > 0.0 && largest < 1.0 ? -1.0 / std::log(largest) : 0.0;
}

double settling_time(const ControllerVariant& variant) {
  double out = 0.0;
  for (const ControllerCam& cam : variant.cams) {
    out = std::max(
        out, (kSettlingCycles + kTimeConstants * slowest_cycles(cam.z.denominator)) / cam.clock_a.value);
  }
  return out;
}

BoardRun::Part simulated_part(const OutsidePart& part, const VoltScale& scale,
                              const ControllerReference& reference, double start) {
  BoardRun::Part out{part.name, part.inputs, {}};
  const double value = part.value;
  switch (part.kind) {
    case OutsidePart::Kind::reference:
      out.value = [=, x = reference.x](double t, std::span<const double>) {
        return scale.volts(x(t - start));
      };
      break;
    case OutsidePart::Kind::constant:
      out.value = [=](double, std::span<const double>) { return value; };
      break;
    case OutsidePart::Kind::multiplier:
      out.value = [=](double, std::span<const double> in) { return value * in[0] * in[1]; };
      break;
    case OutsidePart::Kind::switched:
      out.value = [=, rises = reference.rises](double t, std::span<const double> in) {
        return rises(t - start) ? in[0] : in[1];
      };
      break;
  }
  return out;
}

}  // namespace

ControllerRun::ControllerRun(const ControllerVariant& variant, const ControllerReference& reference)
    : settling_s_(settling_time(variant)), scale_(variant.scale), drive_(variant.drive) {
  const std::vector<WiredCam> cams(variant.cams.begin(), variant.cams.end());
  std::vector<BoardRun::Part> parts;
  for (const OutsidePart& part : variant.outside)
    parts.push_back(simulated_part(part, scale_, reference, settling_s_));
  simulation_ = std::make_unique<BoardRun>(cams, std::move(parts), board_by_name(variant.board));
  simulation_->advance_to(settling_s_);
  simulation_->forget_clipping();
}

double ControllerRun::drive(double time_s) {
  if (time_s - last_s_ > 2.0 * settling_s_) simulation_->skip_towards(time_s);  // settles anew from there on
  last_s_ = time_s;
  simulation_->advance_to(settling_s_ + time_s);
  return scale_.stroke(simulation_->value(drive_));
}

std::vector<std::string> ControllerRun::clipped() const {
  std::vector<std::string> out = simulation_->clipped();
  out.erase(std::remove(out.begin(), out.end(), "SlopeGain"), out.end());
  out.erase(std::remove(out.begin(), out.end(), "SlopeFilter"), out.end());
  return out;
}

}  // namespace bodesmith::fpaa
