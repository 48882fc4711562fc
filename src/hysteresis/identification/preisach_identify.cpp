#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hysteresis/identification/preisach_identify.hpp"

#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "hysteresis/preisach.hpp"
#include "numeric/index.hpp"
#include "numeric/optimisation/non_negative_least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

/// The plane at twice the levels: the same weight, spread over the four (on the diagonal three) cells.
Eigen::VectorXd refined(const Eigen::VectorXd& coarse, std::size_t levels) {
  const std::size_t fine = 2 * levels;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(eigen_index(fine * (fine + 1) / 2));
  const auto at = [&](std::size_t i, std::size_t j) -> double& {
    return out(eigen_index(i * (i + 1) / 2 + j));
  };
  for (std::size_t i = 0; i < levels; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double w = coarse(eigen_index(i * (i + 1) / 2 + j));
      if (i == j) {
        at(2 * i, 2 * i) += 0.25 * w;
        at(2 * i + 1, 2 * i + 1) += 0.25 * w;
        at(2 * i + 1, 2 * i) += 0.5 * w;
      } else {
        for (const std::size_t a : {std::size_t{0}, std::size_t{1}})
          for (const std::size_t b : {std::size_t{0}, std::size_t{1}}) at(2 * i + a, 2 * j + b) += 0.25 * w;
      }
    }
  }
  return out;
}

/// Levels that are halved as long as they can be: 200 is solved as 25, 50, 100, 200.
std::vector<std::size_t> coarse_to_fine(std::size_t levels) {
  std::vector<std::size_t> out{levels};
  while (out.back() % 2 == 0 && out.back() > 30) out.push_back(out.back() / 2);
  std::ranges::reverse(out);
  return out;
}

/// One over the length of every column: a relay that is on for a part p of the n samples has a column of length
/// √(n p (1 − p)). 0: never or always on, not seen.
Eigen::VectorXd column_scale(const EverettTrace& trace) {
  const auto n = static_cast<double>(trace.rows());
  Eigen::VectorXd on;
  trace.adjoint(Eigen::VectorXd::Ones(trace.rows()), on);
  Eigen::VectorXd scale(trace.columns());
  for (Eigen::Index k = 0; k < scale.size(); ++k) {
    const double p = on(k) / n;
    const double variance = n * p * (1.0 - p);
    scale(k) = variance > 1e-6 * n ? 1.0 / std::sqrt(variance) : 0.0;
  }
  return scale;
}

/// Products with the trace's columns, their means taken out (which solves for the offset).
class CentredTrace {
 public:
  explicit CentredTrace(const EverettTrace& trace) : trace_(trace) {}
  LinearMap map() {
    LinearMap out;
    out.columns = trace_.columns();
    out.rows = trace_.rows();
    out.apply = [this](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
      trace_.apply(x, r);
      r.array() -= r.mean();
    };
    out.adjoint = [this](const Eigen::VectorXd& r, Eigen::VectorXd& g) {
      centred_ = r.array() - r.mean();
      trace_.adjoint(centred_, g);
    };
    return out;
  }

 private:
  const EverettTrace& trace_;
  Eigen::VectorXd centred_;
};

}  // namespace

PreisachWeights fit_preisach_weights(std::span<const TimeRecord> records, double skip_s, double u_min,
                                     double u_max, std::size_t levels, CellShape shape, int iterations) {
  const Eigen::VectorXd y = counted_outputs(records, skip_s);
  const double mean = y.mean();
  const Eigen::VectorXd centred = y.array() - mean;
  PreisachWeights out;
  Eigen::VectorXd weights;
  std::size_t before = 0;
  for (const std::size_t plane : coarse_to_fine(levels)) {
    EverettTrace trace(u_min, u_max, plane, shape);
    for (const TimeRecord& record : records) trace.add(record, first_counted(record, skip_s));
    const Eigen::VectorXd scale = column_scale(trace);
    weights = before == 0 ? Eigen::VectorXd::Zero(scale.size()).eval() : refined(weights, before);
    const bool last = plane == levels;
    CentredTrace columns(trace);
    const NonNegativeResult solved =
        non_negative_least_squares(columns.map(), centred, weights, scale,
                                   {.max_iterations = iterations, .min_gain = last ? 1e-4 : 1e-3});
    weights = solved.x;
    out.iterations += solved.iterations;
    out.kkt = solved.kkt;
    out.converged = converged(solved.termination);
    out.unseen = std_index((scale.array() == 0.0).count());
    before = plane;
    if (!last) continue;
    Eigen::VectorXd fitted;
    trace.apply(weights, fitted);
    out.offset = mean - fitted.mean();
    out.rms = std::sqrt((fitted.array() + out.offset - y.array()).square().mean());
  }
  out.weights = to_vector(weights);
  out.active = std_index((weights.array() > 0.0).count());
  return out;
}

Identified identify_preisach(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Range u = swept_range(records);
  const bool paper = options.as_in_paper();
  const auto levels = static_cast<std::size_t>(options.size > 0 ? options.size : 200);
  const PreisachWeights fit = fit_preisach_weights(records, options.skip_s, u.low, u.high, levels,
                                                   paper ? CellShape::relays : CellShape::bilinear,
                                                   static_cast<int>(3000 * options.effort));
  Identified out;
  out.method = fmt::format(
      "non-negative least squares of {} relay weights on the stack of extremes ({}), {} iterations",
      fit.weights.size(), paper ? "relays" : "bilinear Everett function", fit.iterations);
  out.converged = fit.converged;
  out.notes.push_back(
      fmt::format("{} of {} weights are above 0; {} relays never switch in the record and stay 0", fit.active,
                  fit.weights.size(), fit.unseen));
  out.notes.push_back(
      "single relay weights are not determined by a record (only their sums are): no uncertainty is given "
      "for them");
  out.uncertainty.push_back(
      {"offset", fit.offset,
       fit.rms / std::sqrt(static_cast<double>(counted_samples(records, options.skip_s)))});
  out.model = make_model("preisach", Parameters()
                                         .set("u_min", u.low)
                                         .set("u_max", u.high)
                                         .set("w", fit.weights)
                                         .set("offset", fit.offset)
                                         .set("interpolation", paper ? "relays" : "bilinear"));
  return out;
}

}  // namespace bodesmith::hysteresis
