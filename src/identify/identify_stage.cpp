#include "identify/identify_stage.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

std::vector<TimeRecord> all_advanced(std::span<const TimeRecord> records, double delay_s) {
  std::vector<TimeRecord> out;
  for (const TimeRecord& record : records) out.push_back(advanced(record, delay_s));
  return out;
}

}  // namespace

TimeRecord advanced(const TimeRecord& record, double delay_s) {
  TimeRecord out = record;
  if (delay_s == 0.0) return out;
  out.y = delayed(record.y, record.step_s, -delay_s);
  const auto lost = static_cast<std::size_t>(std::ceil(delay_s / record.step_s));
  const std::size_t kept = record.size() > lost + 2 ? record.size() - lost : 2;
  out.u.resize(kept);
  out.y.resize(kept);
  return out;
}

Identified identify_linear(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
  Eigen::Vector2d rhs = Eigen::Vector2d::Zero();
  const Range range = input_range(records, options.skip_s);
  const Range y_range = output_range(records, options.skip_s);
  if (!(range.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  const auto each = [&](auto&& use) {
    for (const TimeRecord& record : records)
      for (std::size_t i = first_counted(record, options.skip_s); i < record.size(); ++i)
        use(Eigen::Vector2d(1.0, record.u[i] - range.middle()), record.y[i] - y_range.middle());
  };
  each([&](const Eigen::Vector2d& row, double y) {
    gram += row * row.transpose();
    rhs += y * row;
  });
  const Eigen::Vector2d x = gram.ldlt().solve(rhs);
  std::vector<double> miss;
  each([&](const Eigen::Vector2d& row, double y) { miss.push_back(row.dot(x) - y); });
  const Eigen::VectorXd deviation = parameter_deviation(
      gram, Eigen::Map<const Eigen::VectorXd>(miss.data(), static_cast<Eigen::Index>(miss.size())));
  Identified out;
  out.stage.output_gain = x(1);
  out.stage.output_offset = x(0) + y_range.middle() - x(1) * range.middle();
  out.method = "linear least squares";
  out.uncertainty = {{"gain", x(1), deviation(1)}, {"offset", out.stage.output_offset, deviation(0)}};
  out.compute_s = watch.seconds();
  return out;
}

double best_delay(std::span<const TimeRecord> records, const IdentifyOptions& options, bool linear) {
  IdentifyOptions plain = options;
  plain.method = "best";
  plain.size = 10;
  plain.asymmetric = false;
  const auto miss = [&](double delay_s) {
    const std::vector<TimeRecord> shifted = all_advanced(records, delay_s);
    const Identified found =
        linear ? identify_linear(shifted, plain) : model_type("prandtl_ishlinskii").identify(shifted, plain);
    return error_figures(found.stage, shifted, plain.skip_s).rms;
  };
  const double step = records[0].step_s;
  constexpr int kScan = 8;
  int best = 0;
  double least = 0.0;
  for (int i = 0; i <= kScan; ++i) {
    const double here = miss(i * step);
    if (i == 0 || here < least) {
      least = here;
      best = i;
    }
  }
  double low = std::max(best - 1, 0) * step;
  double high = std::min(best + 1, kScan) * step;
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double a = high - ratio * (high - low);
  double b = low + ratio * (high - low);
  double at_a = miss(a);
  double at_b = miss(b);
  while (high - low > 0.02 * step) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - ratio * (high - low);
      at_a = miss(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + ratio * (high - low);
      at_b = miss(b);
    }
  }
  const double found = 0.5 * (low + high);
  return miss(found) < miss(0.0) ? found : 0.0;
}

StageFit fit_stage(const std::string& model, std::span<const TimeRecord> training,
                   std::span<const TimeRecord> holdout, const StageFitOptions& options) {
  const Stopwatch watch;
  StageFit out;
  out.model = model;
  const bool linear = model == "linear";
  const double delay_s = options.delay_s      ? *options.delay_s
                         : options.find_delay ? best_delay(training, options.identify, linear)
                                              : 0.0;
  const std::vector<TimeRecord> shifted = all_advanced(training, delay_s);
  out.identified = linear ? identify_linear(shifted, options.identify)
                          : model_type(model).identify(shifted, options.identify);
  out.identified.stage.delay_s += delay_s;
  out.identified.compute_s = watch.seconds();
  out.training = error_figures(out.identified.stage, training, options.identify.skip_s);
  if (!holdout.empty()) out.holdout = error_figures(out.identified.stage, holdout, options.identify.skip_s);
  return out;
}

}  // namespace bodesmith::hysteresis
