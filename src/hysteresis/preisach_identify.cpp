#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/everett_trace.hpp"
#include "hysteresis/preisach.hpp"
#include "hysteresis/preisach_identify.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/non_negative_map.hpp"

namespace bodesmith::hysteresis {
namespace {

const std::vector<ParameterInfo>& infos() {
  static const std::vector<ParameterInfo> list = {
      scalar("u_min", "u", "lower end of the input range: all relays off"),
      scalar("u_max", "u", "upper end of the input range: all relays on"),
      array("w", "y", "weights of the relays, L (L + 1)/2 of them: (0,0), (1,0), (1,1), (2,0), …", 0.0),
      optional(scalar("offset", "y", "output with all relays off"), {0.0}),
      word("interpolation", "how a relay's weight is spread", {"bilinear", "relays"}),
  };
  return list;
}

void check(const Parameters& values) {
  (void)Preisach::from(values);
}

std::unique_ptr<Operator> make(const Parameters& values) {
  const Preisach model = Preisach::from(values);
  if (model.bilinear)
    return std::make_unique<EverettOperator<BilinearEverett>>(BilinearEverett(model.table),
                                                              model.table->u_min, model.offset);
  return std::make_unique<EverettOperator<RelayEverett>>(RelayEverett(model.table), model.table->u_min,
                                                         model.offset);
}

std::unique_ptr<Inverse> make_inverse_of(const Parameters& values) {
  const Preisach model = Preisach::from(values);
  if (!model.bilinear)
    throw DesignError("relays make a staircase, which has no inverse; use interpolation = \"bilinear\"");
  const EverettTable& table = *model.table;
  using Op = EverettOperator<BilinearEverett>;
  return std::make_unique<EverettInverse<BilinearEverett>>(
      Op(BilinearEverett(model.table), table.u_min, model.offset), table.u_min, model.offset,
      model.offset + table.at(table.levels, 0));
}

/// The plane at twice the levels: the same weight, spread over the four (on the diagonal three) cells.
Eigen::VectorXd refined(const Eigen::VectorXd& coarse, std::size_t levels) {
  const std::size_t fine = 2 * levels;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fine * (fine + 1) / 2));
  const auto at = [&](std::size_t i, std::size_t j) -> double& {
    return out(static_cast<Eigen::Index>(i * (i + 1) / 2 + j));
  };
  for (std::size_t i = 0; i < levels; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double w = coarse(static_cast<Eigen::Index>(i * (i + 1) / 2 + j));
      if (i == j) {
        at(2 * i, 2 * i) += 0.25 * w;
        at(2 * i + 1, 2 * i + 1) += 0.25 * w;
        at(2 * i + 1, 2 * i) += 0.5 * w;
      } else {
        for (const std::size_t a : {0u, 1u})
          for (const std::size_t b : {0u, 1u}) at(2 * i + a, 2 * j + b) += 0.25 * w;
      }
    }
  }
  return out;
}

}  // namespace

PreisachWeights fit_preisach_weights(std::span<const TimeRecord> records, double skip_s, double u_min,
                                     double u_max, std::size_t levels, CellShape shape, int iterations) {
  // Levels that are halved as long as they can be: 200 is solved as 25, 50, 100, 200.
  std::vector<std::size_t> ladder{levels};
  while (ladder.back() % 2 == 0 && ladder.back() > 30) ladder.push_back(ladder.back() / 2);
  std::reverse(ladder.begin(), ladder.end());

  Eigen::VectorXd y(static_cast<Eigen::Index>(counted_samples(records, skip_s)));
  Eigen::Index at = 0;
  for (const TimeRecord& record : records)
    for (std::size_t i = first_counted(record, skip_s); i < record.size(); ++i) y(at++) = record.y[i];
  const double mean = y.mean();
  const auto n = static_cast<double>(y.size());
  const Eigen::VectorXd centred = y.array() - mean;

  PreisachWeights out;
  Eigen::VectorXd weights;
  for (std::size_t stage = 0; stage < ladder.size(); ++stage) {
    EverettTrace trace(u_min, u_max, ladder[stage], shape);
    for (const TimeRecord& record : records) trace.add(record, first_counted(record, skip_s));
    // The offset is solved for by taking the mean out of every column.
    NonNegativeMap map;
    map.columns = trace.columns();
    map.rows = trace.rows();
    map.apply = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
      trace.apply(x, r);
      r.array() -= r.mean();
    };
    Eigen::VectorXd level(y.size());
    map.adjoint = [&](const Eigen::VectorXd& r, Eigen::VectorXd& g) {
      level = r.array() - r.mean();
      trace.adjoint(level, g);
    };
    // A relay that is on for a part p of the time has a column of length √(n p (1 − p)); never or always on:
    // not seen.
    Eigen::VectorXd on;
    trace.adjoint(Eigen::VectorXd::Ones(y.size()), on);
    Eigen::VectorXd scale(trace.columns());
    out.unseen = 0;
    for (Eigen::Index k = 0; k < scale.size(); ++k) {
      const double p = on(k) / n;
      const double variance = n * p * (1.0 - p);
      scale(k) = variance > 1e-6 * n ? 1.0 / std::sqrt(variance) : 0.0;
      if (scale(k) == 0.0) ++out.unseen;
    }
    if (stage == 0) {
      weights = Eigen::VectorXd::Zero(trace.columns());
      const double total = centred.maxCoeff() - centred.minCoeff();
      Eigen::Index seen = 0;
      for (Eigen::Index k = 0; k < scale.size(); ++k) seen += scale(k) > 0.0;
      for (Eigen::Index k = 0; k < scale.size(); ++k)
        if (scale(k) > 0.0) weights(k) = total / static_cast<double>(std::max<Eigen::Index>(seen, 1));
    } else {
      weights = refined(weights, ladder[stage - 1]);
    }
    const NonNegativeResult solved = solve_non_negative(map, centred, weights, scale, 1e-9, iterations,
                                                        stage + 1 < ladder.size() ? 1e-3 : 1e-4);
    weights = solved.x;
    out.iterations += solved.iterations;
    out.kkt = solved.kkt;
    out.converged = solved.converged;
    if (stage + 1 == ladder.size()) {
      Eigen::VectorXd fitted;
      trace.apply(weights, fitted);
      out.offset = mean - fitted.mean();
      out.rms = std::sqrt((fitted.array() + out.offset - y.array()).square().mean());
    }
  }
  out.weights.assign(weights.data(), weights.data() + weights.size());
  out.active = static_cast<std::size_t>(
      std::count_if(out.weights.begin(), out.weights.end(), [](double w) { return w > 0.0; }));
  return out;
}

namespace {

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  const Range u = input_range(records, 0.0);
  if (!(u.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  const bool paper = options.method == "paper";
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
  Parameters values;
  values.set("u_min", u.low).set("u_max", u.high).set("w", fit.weights).set("offset", fit.offset);
  values.set("interpolation", paper ? "relays" : "bilinear");
  out.stage.model = checked_model("preisach", values);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace

ModelType preisach_type() {
  return {"preisach",
          "weighted relays by a stack of turning points and the Everett function; exact inverse",
          "Mayergoyz 1991; first seed, section V.B",
          infos(),
          check,
          make,
          make_inverse_of,
          identify};
}

}  // namespace bodesmith::hysteresis
