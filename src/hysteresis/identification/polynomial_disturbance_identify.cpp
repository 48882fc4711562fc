#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "hysteresis/polynomial_disturbance.hpp"
#include "numeric/index.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith::hysteresis {
namespace {

/// Scalings of the record and the branches' shapes; what both methods end with.
struct DisturbanceFit {
  Scaling input;
  Scaling output;
  PolynomialDisturbance model;
};

Parameters to_parameters(const PolynomialDisturbance& model) {
  Parameters out;
  if (model.ascending.is_sine) {
    out.set("A_ascending", model.ascending.sine).set("A_descending", model.descending.sine);
  } else {
    const auto list = [](const std::array<double, 3>& a) { return std::vector<double>(a.begin(), a.end()); };
    out.set("ascending", list(model.ascending.polynomial))
        .set("descending", list(model.descending.polynomial));
  }
  out.set("minor", model.nested ? "nested" : "slope_sign");
  if (!model.strokes.alpha.empty())
    out.set("alpha", model.strokes.alpha)
        .set("alpha_1", model.strokes.ascending)
        .set("alpha_2", model.strokes.descending);
  return out;
}

/// The branches of the records that span the input's whole range.
/// Of the input's range: what a full stroke may lack, and so what the input may turn by within a stroke (a drive that
/// was found for a stage with a lag swings where it turns).
constexpr double kLack = 0.03;

struct FullStroke {
  const TimeRecord* record;
  Branch branch;
};

std::vector<FullStroke> full_strokes(std::span<const TimeRecord> records, double skip_s, double range) {
  std::vector<FullStroke> out;
  for (const TimeRecord& record : records) {
    for (const Branch& branch : branches(record.u, kLack)) {
      if (branch.first >= first_counted(record, skip_s) &&
          std::abs(record.u[branch.last] - record.u[branch.first]) > (1.0 - kLack) * range)
        out.push_back({&record, branch});
    }
  }
  if (out.empty())
    throw InputError(
        records[0].file, 0,
        "no branch spans the whole range of the input, expected full strokes (at least one up and one down)");
  return out;
}

/// The paper's way: the line through the ends of the full stroke is what should be; the disturbance of each
/// branch is fitted to what differs (eq. 4, 5 or 10), over all branches that span the stroke.
DisturbanceFit fit_full_strokes(std::span<const TimeRecord> records, double skip_s, bool sine) {
  const Range u = input_range(records, 0.0);
  const std::vector<FullStroke> strokes = full_strokes(records, skip_s, u.width());
  double low = 0.0, high = 0.0;
  for (const auto& [record, branch] : strokes) {
    (branch.rising ? low : high) += record->y[branch.first];
    (branch.rising ? high : low) += record->y[branch.last];
  }
  low /= static_cast<double>(strokes.size());
  high /= static_cast<double>(strokes.size());
  if (!(high != low))
    throw InputError(records[0].file, 0, "the output is the same at both ends of the stroke");
  DisturbanceFit out;
  out.input = {1.0 / u.width(), -u.low / u.width()};
  out.output = {high - low, low};
  std::vector<double> x[2], d[2];
  for (const auto& [record, branch] : strokes) {
    for (std::size_t i = branch.first; i <= branch.last; ++i) {
      const double at = out.input(record->u[i]);
      x[branch.rising].push_back(at);
      d[branch.rising].push_back((record->y[i] - low) / (high - low) - at);
    }
  }
  if (x[0].size() < 3 || x[1].size() < 3)
    throw InputError(records[0].file, 0, "holds no full stroke up and down of at least three samples each");
  if (sine) {
    out.model.ascending.is_sine = out.model.descending.is_sine = true;
    out.model.ascending.sine = fit_sine(x[1], d[1]);
    out.model.descending.sine = fit_sine(x[0], d[0]);
  } else {
    out.model.ascending.polynomial = fit_polynomial(x[1], d[1]).a;
    out.model.descending.polynomial = fit_polynomial(x[0], d[0]).a;
  }
  return out;
}

double shortest_stroke(std::span<const TimeRecord> records) {
  const double full = input_range(records, 0.0).width();
  double out = 1.0;
  for (const TimeRecord& record : records) {
    const std::vector<Branch> list = branches(record.u, kLack);
    for (std::size_t i = 1; i + 1 < list.size(); ++i)
      out = std::min(out, std::abs(record.u[list[i].last] - record.u[list[i].first]) / full);
  }
  return out;
}

/// The search's unknowns: offset and gain as parts of the output's range, the shapes, and the amplitude gains
/// below the full stroke (ascending, then descending).
class DisturbanceUnknowns {
 public:
  DisturbanceUnknowns(DisturbanceFit base, bool sine) : base_(std::move(base)), sine_(sine) {}

  Eigen::Index shapes() const { return sine_ ? 2 : 4; }
  /// Of one branch.
  Eigen::Index gains() const {
    return base_.model.strokes.alpha.empty() ? 0 : eigen_index(base_.model.strokes.alpha.size() - 1);
  }
  Eigen::Index count() const { return 2 + shapes() + 2 * gains(); }

  Eigen::VectorXd start() const {
    Eigen::VectorXd x(count());
    x.head(2) << 0.0, 1.0;
    const PolynomialDisturbance& model = base_.model;
    if (sine_) {
      x.segment(2, 2) << model.ascending.sine, model.descending.sine;
    } else {
      x.segment(2, 4) << model.ascending.polynomial[0], model.ascending.polynomial[1],
          model.descending.polynomial[0], model.descending.polynomial[1];
    }
    for (const Eigen::Index branch : {0, 1})
      x.segment(2 + shapes() + branch * gains(), gains()) = as_eigen(model.strokes.alpha).head(gains());
    return x;
  }

  DisturbanceFit fit(const Eigen::VectorXd& x) const {
    DisturbanceFit out = base_;
    out.output = {base_.output.gain * x(1), base_.output.offset + base_.output.gain * x(0)};
    if (sine_) {
      out.model.ascending.sine = x(2);
      out.model.descending.sine = x(3);
    } else {
      out.model.ascending.polynomial = {x(2), x(3), -x(2) - x(3)};
      out.model.descending.polynomial = {x(4), x(5), -x(4) - x(5)};
    }
    as_eigen(out.model.strokes.ascending).head(gains()) = x.segment(2 + shapes(), gains());
    as_eigen(out.model.strokes.descending).head(gains()) = x.segment(2 + shapes() + gains(), gains());
    return out;
  }

  std::vector<ParameterUncertainty> uncertainty(const Eigen::VectorXd& x,
                                                const Eigen::VectorXd& deviation) const {
    std::vector<ParameterUncertainty> out;
    if (sine_) {
      out = {{"A_ascending", x(2), deviation(2)}, {"A_descending", x(3), deviation(3)}};
    } else {
      add_uncertainty(out, "ascending", x, deviation, 2, 2);
      add_uncertainty(out, "descending", x, deviation, 4, 2);
    }
    add_uncertainty(out, "alpha_1", x, deviation, 2 + shapes(), gains());
    add_uncertainty(out, "alpha_2", x, deviation, 2 + shapes() + gains(), gains());
    return out;
  }

 private:
  DisturbanceFit base_;
  bool sine_;
};

/// From the start on, all samples; `iterations` = 1 gives the deviations at the start.
LeastSquaresResult refine(const DisturbanceUnknowns& unknowns, std::span<const TimeRecord> records,
                          double skip_s, int iterations) {
  const auto residual = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
    const DisturbanceFit at = unknowns.fit(x);
    r.resize(eigen_index(counted_samples(records, skip_s)));
    Eigen::Index k = 0;
    PolynomialOperator op(at.model);
    drive(
        op, records, skip_s,
        [&](double y, const TimeRecord& record, std::size_t i) { r(k++) = at.output(y) - record.y[i]; },
        at.input);
  };
  const Eigen::Index n = unknowns.count();
  Eigen::VectorXd lower = Eigen::VectorXd::Constant(n, -5.0);
  lower(1) = 0.1;
  return fit_parameters(residual, unknowns.start(), lower, Eigen::VectorXd::Constant(n, 5.0),
                        Eigen::VectorXd::Constant(n, 0.1), iterations);
}

/// `own` parameters of the branches' shapes, and those that cubics and sines have in common.
std::vector<ParameterSpec> disturbance_parameters(std::vector<ParameterSpec> own) {
  own.insert(
      own.end(),
      {
          one_word_of("minor", "which branch holds after a reversal inside the stroke",
                      {"slope_sign", "nested"}),
          between("amplitude", "1", "stroke that slope_sign assumes, as a part of the full one", 1e-9, 1.0)
              .with_default(1.0),
          not_negative("switch_delay_s", "s",
                       "the branch switch of slope_sign acts this much after the input has turned")
              .with_default(0.0),
          optional_list_of(above_zero("alpha", "1", "strokes of the amplitude gains, rising")),
          optional_list_of(any_number("alpha_1", "1", "amplitude gains of the ascending branch")),
          optional_list_of(any_number("alpha_2", "1", "amplitude gains of the descending branch")),
          optional_list_of(
              above_zero("rate_frequency_hz", "Hz", "operating frequencies of the rate gains, rising")),
          optional_list_of(any_number("rate_ascending", "1", "rate gains of the ascending branch")),
          optional_list_of(any_number("rate_descending", "1", "rate gains of the descending branch")),
          not_negative("operating_hz", "Hz",
                       "frequency at which the rate gains are taken; 0: they are left out")
              .with_default(0.0),
      });
  return own;
}

class DisturbanceType : public ShapedModelType<PolynomialDisturbance, PolynomialOperator, PolynomialInverse> {
 public:
  using ShapedModelType::ShapedModelType;
  /// With the slope's sign as the rule each branch is one curve, and a turn inside the stroke jumps between them.
  std::optional<BranchCurves> branch_curves(const Parameters& values) const override {
    const PolynomialDisturbance model = PolynomialDisturbance::from(values);
    if (model.nested) return std::nullopt;
    BranchCurves out;
    out.curve = [model](bool rising, double u) { return model.plain(rising, u); };
    out.switch_delay_s = model.switch_delay_s;
    if (model.ascending.is_sine) return out;
    out.rising = cubic_of([&](double u) { return model.plain(true, u); });
    out.falling = cubic_of([&](double u) { return model.plain(false, u); });
    return out;
  }
};

class PolynomialHysteresisType final : public DisturbanceType {
 public:
  PolynomialHysteresisType()
      : DisturbanceType(
            "polynomial_hysteresis", "cubic disturbance added to the input, one polynomial a branch",
            disturbance_parameters({
                list_of(any_number("ascending", "1", "a1, a2, a3 of the ascending branch")),
                list_of(any_number("descending", "1", "a1, a2, a3 of the descending branch")),
                any_number("constant_ascending", "1", "added on the ascending branch of slope_sign")
                    .with_default(0.0),
                any_number("constant_descending", "1", "added on the descending branch of slope_sign")
                    .with_default(0.0),
            })) {}
  std::vector<std::string_view> polynomial_lists() const override { return {"ascending", "descending"}; }

 protected:
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_polynomial(records, options, false);
  }
};

class SineHysteresisType final : public DisturbanceType {
 public:
  SineHysteresisType()
      : DisturbanceType("sine_hysteresis", "half a sine added to the input, one amplitude a branch",
                        disturbance_parameters({
                            any_number("A_ascending", "1", "amplitude of the ascending branch"),
                            any_number("A_descending", "1", "amplitude of the descending branch"),
                        })) {}

 protected:
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_polynomial(records, options, true);
  }
};

}  // namespace

Identified identify_polynomial(std::span<const TimeRecord> records, const IdentifyOptions& options,
                               bool sine) {
  DisturbanceFit fit = fit_full_strokes(records, options.skip_s, sine);
  const bool paper = options.as_in_paper();
  const bool with_gains = shortest_stroke(records) < 0.8;
  fit.model.nested = !paper;
  if (with_gains && !paper) {
    fit.model.strokes.alpha = {0.25, 0.5, 0.75, 1.0};
    fit.model.strokes.ascending = fit.model.strokes.descending = fit.model.strokes.alpha;
  }
  const DisturbanceUnknowns unknowns(fit, sine);
  // The paper's method only needs the deviations at its own solution.
  const LeastSquaresResult solved = refine(unknowns, records, options.skip_s, paper ? 1 : 40);
  if (!paper) fit = unknowns.fit(solved.values);
  Identified out;
  out.method =
      paper
          ? "least squares over full strokes (eq. 4, 5, 10), branch by the sign of the slope"
          : "least squares over full strokes, then the nested rule on all samples by nonlinear least squares";
  if (with_gains && paper)
    out.notes.push_back(
        "strokes shorter than 80 % are in the record, and the paper's rule has no memory of them");
  if (!with_gains)
    out.notes.push_back("the record has full strokes only: amplitude gains are taken as the stroke itself");
  out.uncertainty = unknowns.uncertainty(paper ? unknowns.start() : solved.values, solved.deviation);
  out.converged = paper || converged(solved.termination);
  out.input = fit.input;
  out.output = fit.output;
  out.model = make_model(sine ? "sine_hysteresis" : "polynomial_hysteresis", to_parameters(fit.model));
  return out;
}

BODESMITH_ENTRY(ModelType, polynomial_hysteresis_type, PolynomialHysteresisType)

BODESMITH_ENTRY(ModelType, sine_hysteresis_type, SineHysteresisType)

}  // namespace bodesmith::hysteresis
