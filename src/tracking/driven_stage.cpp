#include "tracking/driven_stage.hpp"

#include <cmath>

namespace bodesmith::tracking {
namespace {

/// Roots so far above a repeat's frequency (rad/s times s) count for their value at rest: a state is known to the solver's tolerance, the
/// slope of the drive to that times its pole, which for the resistors that isolate an op-amp's output (4.5e7 rad/s) at a hertz is more
/// than the drive's own. A lag of a hundred-thousandth of a repeat is left out.
constexpr double kFarAbove = 1e5;

StateSpace without_far_roots(Sections sections, double repeat_s) {
  for (Section& section : sections.sections) {
    const auto is_far = [repeat_s](const Complex& root) { return std::abs(root) * repeat_s > kFarAbove; };
    Section slow = section;
    Complex gain = section.gain;
    for (const Complex& zero : section.zeros) {
      if (is_far(zero)) gain *= -zero;
    }
    for (const Complex& pole : section.poles) {
      if (is_far(pole)) gain /= -pole;
    }
    std::erase_if(slow.zeros, is_far);
    std::erase_if(slow.poles, is_far);
    if (slow.zeros.size() > slow.poles.size()) continue;
    slow.gain = gain.real();
    section = std::move(slow);
  }
  return state_space(sections);
}

std::optional<StateSpace> time_domain_of(const Compensator& c, double repeat_s) {
  if (std::holds_alternative<Uncompensated>(c)) return gain_system(0.0);
  if (std::holds_alternative<SlopeGain>(c)) return gain_system(1.0);
  if (const auto* constant = std::get_if<ConstantGain>(&c)) return gain_system(constant->gain);
  if (const auto* sections = std::get_if<Sections>(&c)) return without_far_roots(*sections, repeat_s);
  if (const auto* sum = std::get_if<FilterAndSchedule>(&c)) {
    StateSpace out = without_far_roots(sum->filter, repeat_s);
    out.d += sum->schedule.gain.front();
    return out;
  }
  if (const auto* response = std::get_if<ResponseCompensator>(&c)) {
    if (response->approximation) return without_far_roots(*response->approximation, repeat_s);
  }
  return std::nullopt;
}

/// 1/(1 + s tau).
StateSpace lag(double time_constant_s) {
  StateSpace out;
  out.a = {-1.0 / time_constant_s};
  out.b = {1.0 / time_constant_s};
  out.c = {1.0};
  return out;
}

}  // namespace

DrivenStage::DrivenStage(const Plant& plant, const Options& options, Hertz frequency)
    : reference_(options.reference, options.alpha),
      generator_(plant.generated().at(options.alpha)),
      own_(plant.disturbance.at(options.alpha, frequency)),
      repeat_s_(static_cast<double>(reference_.periods()) / frequency.value),
      before_switch_(options.place == Options::Place::before_switch),
      on_drive_(options.argument == Options::Argument::drive) {}

std::optional<DrivenStage> DrivenStage::of(const Plant& plant, const Design& design, const Options& options,
                                           Hertz frequency) {
  if (plant.stage) return std::nullopt;
  DrivenStage out(plant, options, frequency);
  out.self_fed_ = design.form.is_self_fed();
  out.passes_ = out.self_fed_ ? 1 : static_cast<std::size_t>(design.form.passes);
  const std::array<const Compensator*, 2> both = {&design.ascending, &design.descending};
  for (std::size_t branch = 0; branch < 2; ++branch) {
    const auto* slope = std::get_if<SlopeGain>(both[branch]);
    if (slope == nullptr) continue;
    out.slope_[branch] = *slope;
    out.blocks_.push_back(slope->differentiator_s > 0.0 ? lag(slope->differentiator_s) : gain_system(1.0));
    out.blocks_.push_back(slope->smoothing_s > 0.0 ? lag(slope->smoothing_s) : gain_system(1.0));
  }
  out.detectors_ = out.blocks_.size();
  for (std::size_t pass = 0; pass < out.passes_; ++pass) {
    for (const Compensator* compensator : both) {
      auto system = time_domain_of(*compensator, out.repeat_s_);
      if (!system) return std::nullopt;
      out.blocks_.push_back(std::move(*system));
    }
  }
  out.blocks_.push_back(state_space(plant.drive_path));
  out.blocks_.push_back(state_space(plant.stage_path));
  for (const StateSpace& block : out.blocks_) {
    out.at_.push_back(out.order_);
    out.order_ += block.order();
  }
  return out;
}

DrivenStage::Gains DrivenStage::measured_gains(double reference_slope, const double* x, double* dx) const {
  Gains out;
  std::size_t block = 0;
  for (std::size_t branch = 0; branch < 2; ++branch) {
    if (!slope_[branch]) continue;
    const StateSpace& differentiator = blocks_[block];
    const StateSpace& smoother = blocks_[block + 1];
    const std::size_t first = at_[block];
    const std::size_t second = at_[block + 1];
    block += 2;
    derivative(differentiator, reference_slope, x + first, dx + first);
    const double s = output(differentiator, reference_slope, x + first);
    derivative(smoother, std::abs(s), x + second, dx + second);
    const double to_hz = 0.5 / reference_.alpha();
    const double f = to_hz * output(smoother, std::abs(s), x + second);
    // The slope's own slope counts between corners, where the reference's is a constant or bends slowly.
    const double s_rate = output_slope(differentiator, 0.0, dx + first) * (s < 0.0 ? -1.0 : 1.0);
    out.k[branch] = gain_at(slope_[branch]->table, f);
    out.slope[branch] =
        gain_slope_at(slope_[branch]->table, f) * to_hz * output_slope(smoother, s_rate, dx + second);
  }
  return out;
}

DrivenStage::Wave DrivenStage::compensation(const Gains& gains, const Wave& heard, const double* x,
                                            double* dx, std::size_t first) const {
  Wave c;
  for (std::size_t branch = 0; branch < 2; ++branch) {
    Wave w;
    if (filter_hears(branch)) {
      const double d = generator_.value(kBranches[branch], heard.value);
      w.value = gains.k[branch] * d;
      w.slope = gains.k[branch] * generator_.slope(kBranches[branch], heard.value) * heard.slope +
                gains.slope[branch] * d;
    }
    const StateSpace& filter = blocks_[first + branch];
    const std::size_t at = at_[first + branch];
    derivative(filter, w.value, x + at, dx + at);
    if (!filter_counts(branch)) continue;
    c.value += output(filter, w.value, x + at);
    c.slope += output_slope(filter, w.slope, dx + at);
  }
  return c;
}

DrivenStage::Wave DrivenStage::self_fed(const Gains& gains, const Wave& reference, const double* x,
                                        double* dx) const {
  // v + sum of C x + D k d(v) = r over the branches that are heard and count: rises with v where |D k d'| < 1.
  Wave v = reference;
  double steepness = 1.0;
  for (int i = 0; i < 50; ++i) {
    const Wave c = compensation(gains, {v.value, 0.0}, x, dx, detectors_);
    steepness = 1.0;
    for (std::size_t branch = 0; branch < 2; ++branch) {
      if (filter_hears(branch) && filter_counts(branch))
        steepness +=
            blocks_[detectors_ + branch].d * gains.k[branch] * generator_.slope(kBranches[branch], v.value);
    }
    const double step = (reference.value - c.value - v.value) / steepness;
    v.value += step;
    if (std::abs(step) < 1e-15) break;
  }
  // With v at rest the output's slope is that of everything else.
  const Wave c = compensation(gains, {v.value, 0.0}, x, dx, detectors_);
  v.slope = (reference.slope - c.slope) / steepness;
  return v;
}

DrivenStage::Outputs DrivenStage::evaluate(double theta, const double* x, double* dx) const {
  const Wave r = {reference_.value(theta), reference_.slope(theta, piece_) / repeat_s_};
  const Gains gains = measured_gains(r.slope, x, dx);
  Wave v = r;
  if (self_fed_) {
    v = self_fed(gains, r, x, dx);
  } else {
    for (std::size_t pass = 0; pass < passes_; ++pass) {
      const Wave c = compensation(gains, v, x, dx, detectors_ + 2 * pass);
      v = {r.value - c.value, r.slope - c.slope};
    }
  }
  const std::size_t drive = blocks_.size() - 2;
  derivative(blocks_[drive], v.value, x + at_[drive], dx + at_[drive]);
  Outputs out;
  out.drive = output(blocks_[drive], v.value, x + at_[drive]);
  out.drive_slope = output_slope(blocks_[drive], v.slope, dx + at_[drive]);
  const bool rising = on_drive_ ? drive_rising_ : Reference::rises(piece_);
  const double q = out.drive + own_.value(branch_of(rising), on_drive_ ? out.drive : r.value);
  derivative(blocks_[drive + 1], q, x + at_[drive + 1], dx + at_[drive + 1]);
  out.displacement = output(blocks_[drive + 1], q, x + at_[drive + 1]);
  return out;
}

}  // namespace bodesmith::tracking
