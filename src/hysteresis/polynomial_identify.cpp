#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/polynomial_disturbance.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

std::vector<ParameterInfo> common_infos() {
  return {
      word("minor", "which branch holds after a reversal inside the stroke", {"slope_sign", "nested"}),
      optional(
          scalar("amplitude", "1", "stroke that slope_sign assumes, as a part of the full one", 1e-9, 1.0),
          {1.0}),
      optional(scalar("switch_delay_s", "s",
                      "the branch switch of slope_sign acts this much after the input has turned", 0.0),
               {0.0}),
      optional(array("alpha", "1", "strokes of the amplitude gains, rising", 1e-9), {}),
      optional(array("alpha_1", "1", "amplitude gains of the ascending branch"), {}),
      optional(array("alpha_2", "1", "amplitude gains of the descending branch"), {}),
      optional(array("rate_frequency_hz", "Hz", "operating frequencies of the rate gains, rising", 1e-12),
               {}),
      optional(array("rate_ascending", "1", "rate gains of the ascending branch"), {}),
      optional(array("rate_descending", "1", "rate gains of the descending branch"), {}),
      optional(scalar("operating_hz", "Hz",
                      "frequency at which the rate gains are taken; 0: they are left out", 0.0),
               {0.0}),
  };
}

std::vector<ParameterInfo> polynomial_infos() {
  std::vector<ParameterInfo> out = {
      array("ascending", "1", "a1, a2, a3 of the ascending branch"),
      array("descending", "1", "a1, a2, a3 of the descending branch"),
  };
  for (ParameterInfo& info : common_infos()) out.push_back(std::move(info));
  return out;
}

std::vector<ParameterInfo> sine_infos() {
  std::vector<ParameterInfo> out = {
      scalar("A_ascending", "1", "amplitude of the ascending branch"),
      scalar("A_descending", "1", "amplitude of the descending branch"),
  };
  for (ParameterInfo& info : common_infos()) out.push_back(std::move(info));
  return out;
}

void check_polynomial(const Parameters& values) {
  (void)PolynomialDisturbance::from_polynomial(values);
}
void check_sine(const Parameters& values) {
  (void)PolynomialDisturbance::from_sine(values);
}
std::unique_ptr<Operator> make_polynomial(const Parameters& values) {
  return std::make_unique<PolynomialOperator>(PolynomialDisturbance::from_polynomial(values));
}
std::unique_ptr<Operator> make_sine(const Parameters& values) {
  return std::make_unique<PolynomialOperator>(PolynomialDisturbance::from_sine(values));
}
std::unique_ptr<Inverse> invert_polynomial(const Parameters& values) {
  return std::make_unique<PolynomialInverse>(PolynomialDisturbance::from_polynomial(values));
}
std::unique_ptr<Inverse> invert_sine(const Parameters& values) {
  return std::make_unique<PolynomialInverse>(PolynomialDisturbance::from_sine(values));
}

/// Scalings of the record and the branches' shapes; what both methods end with.
struct Fit {
  StageModel stage;
  PolynomialDisturbance model;
};

Parameters to_parameters(const PolynomialDisturbance& model, bool sine) {
  Parameters out;
  if (sine) {
    out.set("A_ascending", model.ascending.sine).set("A_descending", model.descending.sine);
  } else {
    const auto list = [](const std::array<double, 3>& a) { return std::vector<double>(a.begin(), a.end()); };
    out.set("ascending", list(model.ascending.polynomial))
        .set("descending", list(model.descending.polynomial));
  }
  out.set("minor", model.nested ? "nested" : "slope_sign");
  if (!model.alpha.empty())
    out.set("alpha", model.alpha).set("alpha_1", model.alpha_1).set("alpha_2", model.alpha_2);
  return out;
}

/// The paper's way: the line through the ends of the full stroke is what should be; the disturbance of each
/// branch is fitted to what differs (eq. 4, 5 or 10), over all branches that span the stroke.
Fit fit_full_strokes(std::span<const TimeRecord> records, double skip_s, bool sine) {
  const Range u = input_range(records, 0.0);
  double low = 0.0, high = 0.0;
  int lows = 0, highs = 0;
  const auto full = [&](const TimeRecord& record, const Branch& branch) {
    return branch.first >= first_counted(record, skip_s) &&
           std::abs(record.u[branch.last] - record.u[branch.first]) > 0.97 * u.width();
  };
  for (const TimeRecord& record : records) {
    for (const Branch& branch : branches(record.u)) {
      if (!full(record, branch)) continue;
      (branch.rising ? low : high) += record.y[branch.first];
      (branch.rising ? high : low) += record.y[branch.last];
      ++lows;
      ++highs;
    }
  }
  if (lows == 0)
    throw InputError(
        records[0].file, 0,
        "no branch spans the whole range of the input, expected full strokes (at least one up and one down)");
  low /= lows;
  high /= highs;
  if (!(high != low))
    throw InputError(records[0].file, 0, "the output is the same at both ends of the stroke");
  Fit out;
  out.stage.input_gain = 1.0 / u.width();
  out.stage.input_offset = -u.low / u.width();
  out.stage.output_gain = high - low;
  out.stage.output_offset = low;
  std::vector<double> x[2], d[2];
  for (const TimeRecord& record : records) {
    for (const Branch& branch : branches(record.u)) {
      if (!full(record, branch)) continue;
      for (std::size_t i = branch.first; i <= branch.last; ++i) {
        const double at = out.stage.input_offset + out.stage.input_gain * record.u[i];
        x[branch.rising].push_back(at);
        d[branch.rising].push_back((record.y[i] - low) / (high - low) - at);
      }
    }
  }
  if (x[0].size() < 3 || x[1].size() < 3)
    throw InputError(records[0].file, 0, "holds no full stroke up and down of at least three samples each");
  if (sine) {
    out.model.ascending.is_sine = out.model.descending.is_sine = true;
    out.model.ascending.sine = fit_sine(x[1], d[1]).amplitude;
    out.model.descending.sine = fit_sine(x[0], d[0]).amplitude;
  } else {
    out.model.ascending.polynomial = fit_polynomial(x[1], d[1]).a;
    out.model.descending.polynomial = fit_polynomial(x[0], d[0]).a;
  }
  return out;
}

double shortest_stroke(std::span<const TimeRecord> records) {
  const Range u = input_range(records, 0.0);
  double out = 1.0;
  for (const TimeRecord& record : records) {
    const std::vector<Branch> list = branches(record.u);
    for (std::size_t i = 1; i + 1 < list.size(); ++i)
      out = std::min(out, std::abs(record.u[list[i].last] - record.u[list[i].first]) / u.width());
  }
  return out;
}

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options, bool sine) {
  const Stopwatch watch;
  Fit fit = fit_full_strokes(records, options.skip_s, sine);
  Identified out;
  const bool paper = options.method == "paper";
  const bool with_gains = shortest_stroke(records) < 0.8;
  fit.model.nested = !paper;
  if (with_gains && !paper) {
    for (const double a : {0.25, 0.5, 0.75, 1.0}) {
      fit.model.alpha.push_back(a);
      fit.model.alpha_1.push_back(a);
      fit.model.alpha_2.push_back(a);
    }
  }
  // offset, gain, shapes, amplitude gains below the full stroke.
  const Eigen::Index shapes = sine ? 2 : 4;
  const auto gains =
      static_cast<Eigen::Index>(fit.model.alpha.empty() ? 0 : 2 * (fit.model.alpha.size() - 1));
  const Eigen::Index n = 2 + shapes + gains;
  const double range = fit.stage.output_gain;
  const double offset = fit.stage.output_offset;
  Eigen::VectorXd start(n);
  start(0) = 0.0;
  start(1) = 1.0;
  if (sine) {
    start(2) = fit.model.ascending.sine;
    start(3) = fit.model.descending.sine;
  } else {
    for (int i = 0; i < 2; ++i) {
      start(2 + i) = fit.model.ascending.polynomial[static_cast<std::size_t>(i)];
      start(4 + i) = fit.model.descending.polynomial[static_cast<std::size_t>(i)];
    }
  }
  for (Eigen::Index i = 0; i < gains; ++i)
    start(2 + shapes + i) = fit.model.alpha[static_cast<std::size_t>(i % (gains / 2))];
  const auto put = [&](const Eigen::VectorXd& x) {
    Fit at = fit;
    at.stage.output_offset = offset + range * x(0);
    at.stage.output_gain = range * x(1);
    if (sine) {
      at.model.ascending.sine = x(2);
      at.model.descending.sine = x(3);
    } else {
      at.model.ascending.polynomial = {x(2), x(3), -x(2) - x(3)};
      at.model.descending.polynomial = {x(4), x(5), -x(4) - x(5)};
    }
    for (Eigen::Index i = 0; i < gains / 2; ++i) {
      at.model.alpha_1[static_cast<std::size_t>(i)] = x(2 + shapes + i);
      at.model.alpha_2[static_cast<std::size_t>(i)] = x(2 + shapes + gains / 2 + i);
    }
    return at;
  };
  const auto residual = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    const Fit at = put(x);
    r.resize(static_cast<Eigen::Index>(counted_samples(records, options.skip_s)));
    Eigen::Index k = 0;
    for (const TimeRecord& record : records) {
      PolynomialOperator op(at.model);
      const std::size_t first = first_counted(record, options.skip_s);
      double y = op.reset(at.stage.input_offset + at.stage.input_gain * record.u[0]);
      for (std::size_t i = 0; i < record.size(); ++i) {
        if (i > 0) y = op.step(at.stage.input_offset + at.stage.input_gain * record.u[i], record.step_s);
        if (i >= first) r(k++) = at.stage.output_offset + at.stage.output_gain * y - record.y[i];
      }
    }
  };
  Eigen::VectorXd lower = Eigen::VectorXd::Constant(n, -5.0);
  lower(1) = 0.1;
  const Eigen::VectorXd upper = Eigen::VectorXd::Constant(n, 5.0);
  const Eigen::VectorXd typical = Eigen::VectorXd::Constant(n, 0.1);
  // The paper's method only needs the deviations at its own solution.
  const LeastSquaresResult solved = least_squares(residual, start, lower, upper, typical, paper ? 1 : 40);
  Eigen::VectorXd paper_residual;
  if (!paper) fit = put(solved.x);
  out.method =
      paper
          ? "least squares over full strokes (eq. 4, 5, 10), branch by the sign of the slope"
          : "least squares over full strokes, then the nested rule on all samples by nonlinear least squares";
  if (with_gains && paper)
    out.notes.push_back(
        "strokes shorter than 80 % are in the record, and the paper's rule has no memory of them");
  if (!with_gains)
    out.notes.push_back("the record has full strokes only: amplitude gains are taken as the stroke itself");
  const char* names_polynomial[] = {"ascending[0]", "ascending[1]", "descending[0]", "descending[1]"};
  const char* names_sine[] = {"A_ascending", "A_descending"};
  const Eigen::VectorXd& shown = paper ? start : solved.x;
  for (Eigen::Index i = 0; i < shapes; ++i)
    out.uncertainty.push_back(
        {sine ? names_sine[i] : names_polynomial[i], shown(2 + i), solved.deviation(2 + i)});
  for (Eigen::Index i = 0; i < gains; ++i)
    out.uncertainty.push_back({fmt::format("alpha_{}[{}]", i < gains / 2 ? 1 : 2, i % (gains / 2)),
                               shown(2 + shapes + i), solved.deviation(2 + shapes + i)});
  out.converged = paper || solved.converged;
  out.stage = fit.stage;
  out.stage.model =
      checked_model(sine ? "sine_hysteresis" : "polynomial_hysteresis", to_parameters(fit.model, sine));
  out.compute_s = watch.seconds();
  return out;
}

Identified identify_polynomial(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  return identify(records, options, false);
}
Identified identify_sine(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  return identify(records, options, true);
}

}  // namespace

ModelType polynomial_hysteresis_type() {
  return {"polynomial_hysteresis",
          "cubic disturbance added to the input, one polynomial a branch",
          "first seed, eq. 1-8, 11-13",
          polynomial_infos(),
          check_polynomial,
          make_polynomial,
          invert_polynomial,
          identify_polynomial};
}

ModelType sine_hysteresis_type() {
  return {"sine_hysteresis",
          "half a sine added to the input, one amplitude a branch",
          "first seed, eq. 9, 10",
          sine_infos(),
          check_sine,
          make_sine,
          invert_sine,
          identify_sine};
}

}  // namespace bodesmith::hysteresis
