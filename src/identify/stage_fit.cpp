#include "identify/stage_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "base/whole_number.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/least_squares.hpp"
#include "numeric/optimisation/minimum.hpp"

namespace bodesmith::identify {
namespace {

std::vector<TimeRecord> all_advanced(std::span<const TimeRecord> records, double delay_s) {
  std::vector<TimeRecord> out;
  for (const TimeRecord& record : records) out.push_back(advanced(record, delay_s));
  return out;
}

bool output_falls(std::span<const TimeRecord> records, double skip_s) {
  const double middle = hysteresis::swept_range(records, skip_s).middle(),
               output_middle = hysteresis::output_range(records, skip_s).middle();
  double sum = 0.0;
  for (const TimeRecord& record : records)
    for (std::size_t i = hysteresis::first_counted(record, skip_s); i < record.size(); ++i)
      sum += (record.u[i] - middle) * (record.y[i] - output_middle);
  return sum < 0.0;
}

/// Of an output that falls as the input rises the model of -y too, turned round behind it: weights that are none below 0 make no other.
Identified identify_model(const hysteresis::ModelType* model, std::span<const TimeRecord> records,
                          const IdentifyOptions& options) {
  if (model == nullptr) return identify_linear(records, options);
  Identified out = model->identify(records, options);
  if (!output_falls(records, options.skip_s)) return out;
  std::vector<TimeRecord> turned(records.begin(), records.end());
  for (TimeRecord& record : turned)
    for (double& y : record.y) y = -y;
  Identified other = model->identify(turned, options);
  other.output = {-other.output.gain, -other.output.offset};
  for (auto& one : other.uncertainty)
    if (one.name == "offset") one.value = -one.value;
  other.notes.emplace_back(
      "the output falls as the input rises: the model is that of -y, turned round behind it");
  const auto rms = [&](const Identified& found) {
    return error_figures(StageModel(found, 0.0), records, options.skip_s).rms;
  };
  return rms(other) < rms(out) ? other : out;
}

}  // namespace

TimeRecord advanced(const TimeRecord& record, double delay_s) {
  TimeRecord out = record;
  if (delay_s == 0.0) return out;
  out.y = later_by(record.y, -delay_s / record.step_s);
  const auto lost = whole_number<std::size_t>(std::ceil(delay_s / record.step_s));
  const std::size_t kept = record.size() > lost + 2 ? record.size() - lost : 2;
  out.u.resize(kept);
  out.y.resize(kept);
  return out;
}

Identified identify_linear(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d rhs = Eigen::Vector2d::Zero();
  const hysteresis::Range u = hysteresis::swept_range(records, options.skip_s);
  const hysteresis::Range y = hysteresis::output_range(records, options.skip_s);
  const auto each = [&](auto&& use) {
    for (const TimeRecord& record : records)
      for (std::size_t i = hysteresis::first_counted(record, options.skip_s); i < record.size(); ++i)
        use(Eigen::Vector2d(1.0, record.u[i] - u.middle()), record.y[i] - y.middle());
  };
  each([&](const Eigen::Vector2d& row, double target) {
    gram += row * row.transpose();
    rhs += target * row;
  });
  const Eigen::Vector2d x = solve_ldlt(gram, rhs);
  std::vector<double> residual;
  each([&](const Eigen::Vector2d& row, double target) { residual.push_back(row.dot(x) - target); });
  const Eigen::VectorXd deviation = parameter_deviation(gram, as_eigen(residual));
  Identified out;
  out.output = {x(1), x(0) + y.middle() - x(1) * u.middle()};
  out.method = "linear least squares";
  out.uncertainty = {{"gain", x(1), deviation(1)}, {"offset", out.output.offset, deviation(0)}};
  out.compute_s = watch.seconds();
  return out;
}

double best_delay(std::span<const TimeRecord> records, const IdentifyOptions& options, bool linear) {
  IdentifyOptions plain = options;
  plain.method = "best";
  plain.size = 10;
  plain.asymmetric = false;
  const hysteresis::ModelType* model =
      linear ? nullptr : &hysteresis::model_type_registry().get("prandtl_ishlinskii");
  const auto error_at = [&](double delay_s) {
    const std::vector<TimeRecord> shifted = all_advanced(records, delay_s);
    return error_figures(StageModel(identify_model(model, shifted, plain), 0.0), shifted, plain.skip_s).rms;
  };
  const double step = records[0].step_s;
  constexpr int kScan = 8;
  int best = 0;
  double min_error = 0.0;
  for (int i = 0; i <= kScan; ++i) {
    const double here = error_at(i * step);
    if (i == 0 || here < min_error) {
      min_error = here;
      best = i;
    }
  }
  const double found =
      minimum_between(std::max(best - 1, 0) * step, std::min(best + 1, kScan) * step, 0.02 * step, error_at);
  return error_at(found) < error_at(0.0) ? found : 0.0;
}

StageFit fit_stage(const hysteresis::ModelType* model, std::span<const TimeRecord> training,
                   std::span<const TimeRecord> holdout, const StageFitOptions& options) {
  const Stopwatch watch;
  StageFit out;
  out.model = model == nullptr ? "linear" : model->name();
  const double delay_s = options.delay_s      ? *options.delay_s
                         : options.find_delay ? best_delay(training, options.identify, model == nullptr)
                                              : 0.0;
  out.identified = identify_model(model, all_advanced(training, delay_s), options.identify);
  out.stage = StageModel(out.identified, delay_s);
  out.compute_s = watch.seconds();
  out.training = error_figures(out.stage, training, options.identify.skip_s);
  if (!holdout.empty()) out.holdout = error_figures(out.stage, holdout, options.identify.skip_s);
  return out;
}

ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s) {
  ErrorSum sum;
  for (const TimeRecord& record : records)
    sum.add(stage.simulate(record.u, record.step_s), record.y, hysteresis::first_counted(record, skip_s));
  return sum.figures();
}

}  // namespace bodesmith::identify
