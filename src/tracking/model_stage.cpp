#include "tracking/model_stage.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "base/error.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::tracking {
namespace {

using Branch = Disturbance::Branch;

/// Rounds until the output repeats, at most so many.
constexpr int kMaxRounds = 40;

/// The model through u, again and again until two rounds agree: where the rate does not count through its turning points alone, which
/// are what is remembered, and once through all of it.
std::vector<double> settled_output(const hysteresis::Identified& found, std::span<const double> u,
                                   double step_s) {
  const auto model = hysteresis::make_operator(found.model);
  std::vector<double> y(u.size());
  std::vector<std::size_t> every(u.size()), turns;
  std::iota(every.begin(), every.end(), 0);
  std::ranges::copy_if(every, std::back_inserter(turns), [&](std::size_t i) {
    const double before = u[(i + u.size() - 1) % u.size()], behind = u[(i + 1) % u.size()];
    return (u[i] - before) * (behind - u[i]) <= 0.0;
  });
  const auto change_over = [&](const std::vector<std::size_t>& samples) {
    double change = 0.0;
    for (const std::size_t i : samples) {
      const double next = found.output(model->step(found.input(u[i]), step_s));
      change = std::max(change, std::abs(next - y[i]));
      y[i] = next;
    }
    return change;
  };
  model->reset(found.input(u.front()));
  const std::vector<std::size_t>& first = model->rate_independent() ? turns : every;
  for (int round = 0; round < kMaxRounds; ++round) {
    if (change_over(first) < 1e-9 && round > 0) break;
  }
  if (model->rate_independent()) change_over(every);
  return y;
}

/// Twice the area between the branches: above 0 where the descending one lies above the ascending one.
double loop_area(const Disturbance& d) {
  double sum = 0.0;
  for (int i = 0; i <= 64; ++i) {
    const double x = i / 64.0;
    sum += d.value(Branch::descending, x) - d.value(Branch::ascending, x);
  }
  return sum;
}

std::vector<double> mirrored_at(const std::vector<double>& u, std::vector<double> y) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = 2.0 * u[i] - y[i];
  return y;
}

}  // namespace

Sections lowpass_path(Hertz corner) {
  const double w = corner.rad_s().value;
  return Sections{1.0, {Section{w, {}, {-w}}}, std::nullopt};
}

Sections resonance_path(Hertz natural_frequency, double damping_ratio) {
  const double w = natural_frequency.rad_s().value;
  Section s;
  s.gain = w * w;
  if (damping_ratio < 1.0) {
    const double im = w * std::sqrt(1.0 - damping_ratio * damping_ratio);
    s.poles = {{-damping_ratio * w, im}, {-damping_ratio * w, -im}};
  } else {
    const double root = std::sqrt(damping_ratio * damping_ratio - 1.0);
    s.poles = {-w * (damping_ratio - root), -w * (damping_ratio + root)};
  }
  return Sections{1.0, {s}, std::nullopt};
}

IdentifiedStage::IdentifiedStage(const hysteresis::ModelType& type, Disturbance disturbance, StagePaths paths,
                                 Options options)
    : type_(type),
      disturbance_(std::move(disturbance)),
      paths_(std::move(paths)),
      options_(std::move(options)),
      mirrored_(loop_area(disturbance_) < 0.0) {}

const std::string& IdentifiedStage::name() const {
  return type_.name();
}

TimeRecord IdentifiedStage::loops(Hertz operating) const {
  TimeRecord out;
  out.file = "loops of the polynomial stage";
  const auto samples = static_cast<double>(options_.samples);
  out.step_s = 0.5 / (operating.value * samples);
  out.u = {0.0};
  // The first stroke twice: what happens before the loops have closed is not fitted.
  for (const double stroke : {1.0, 1.0, 0.75, 0.5, 0.25}) {
    for (std::size_t i = 1; i <= options_.samples; ++i)
      out.u.push_back(stroke * static_cast<double>(i) / samples);
    for (std::size_t i = options_.samples; i-- > 0;)
      out.u.push_back(stroke * static_cast<double>(i) / samples);
  }
  PolynomialStage::Options truth;
  truth.rule = PolynomialStage::Rule::nested;
  out.y = PolynomialStage(disturbance_, {}, truth).response(out.u, out.step_s, operating, DriveKind::smooth);
  if (mirrored_) out.y = mirrored_at(out.u, std::move(out.y));
  return out;
}

const IdentifiedStage::Found& IdentifiedStage::found(Hertz operating) const {
  const std::pair<double, double> key = {disturbance_.rate_gain(Branch::ascending, operating),
                                         disturbance_.rate_gain(Branch::descending, operating)};
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  const TimeRecord record = loops(operating);
  hysteresis::IdentifyOptions options = options_.identify;
  const std::size_t stroke = 2 * options_.samples;
  options.skip_s = static_cast<double>(stroke) * record.step_s;
  Found out{type_.identify(std::span(&record, 1), options)};
  const std::vector<double> y = settled_output(out.model, record.u, record.step_s);
  const auto second_stroke = [&](const std::vector<double>& all) {
    return std::span<const double>(all).subspan(stroke, stroke);
  };
  out.fit_percent = error_figures(second_stroke(y), second_stroke(record.y)).rms_percent;
  return known_.emplace(key, std::move(out)).first->second;
}

double IdentifiedStage::fit_percent(Hertz operating) const {
  return found(operating).fit_percent;
}

std::vector<double> IdentifiedStage::response(std::span<const double> v, double step_s, Hertz operating,
                                              DriveKind /*kind*/) const {
  check_drive(v);
  const std::vector<double> u = through_path(paths_.drive, v, step_s);
  std::vector<double> q = settled_output(found(operating).model, u, step_s);
  if (mirrored_) q = mirrored_at(u, std::move(q));
  return through_path(paths_.mechanics, q, step_s);
}

}  // namespace bodesmith::tracking
