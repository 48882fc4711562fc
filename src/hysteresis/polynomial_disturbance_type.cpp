#include "hysteresis/identification.hpp"
#include "hysteresis/polynomial_disturbance.hpp"

namespace bodesmith::hysteresis {
namespace {

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

/// The cubic through four of the operator's values, met while moving in that direction.
std::vector<double> branch_cubic(Operator& op, int direction) {
  double y[4];
  for (int i = 0; i < 4; ++i) {
    const double x = i / 3.0;
    op.reset(x - direction);
    y[i] = op.step(x, 0.0);
  }
  // Newton's divided differences at 0, 1/3, 2/3, 1, multiplied out.
  const double d1 = y[1] - y[0];
  const double d2 = y[2] - 2.0 * y[1] + y[0];
  const double d3 = y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0];
  return {y[0], 3.0 * d1 - 1.5 * d2 + d3, 4.5 * d2 - 4.5 * d3, 4.5 * d3};
}

class DisturbanceType : public ShapedModelType<PolynomialDisturbance> {
 public:
  using ShapedModelType::ShapedModelType;
  /// With the slope's sign as the rule each branch is one curve, and a turn inside the stroke jumps between them.
  std::optional<BranchCurves> branch_curves(const Parameters& values) const override {
    const PolynomialDisturbance model = PolynomialDisturbance::from(values);
    if (model.nested) return std::nullopt;
    BranchCurves out;
    if (model.ascending.is_sine) return out;
    PolynomialDisturbance at_once = model;
    at_once.switch_delay_s = 0.0;
    PolynomialOperator op(at_once);
    out.rising = branch_cubic(op, 1);
    out.falling = branch_cubic(op, -1);
    out.switch_delay_s = model.switch_delay_s;
    return out;
  }

 protected:
  std::unique_ptr<Operator> operator_of(const PolynomialDisturbance& model) const override {
    return std::make_unique<PolynomialOperator>(model);
  }
  std::unique_ptr<Inverse> inverse_of(const PolynomialDisturbance& model) const override {
    return std::make_unique<PolynomialInverse>(model);
  }
};

class PolynomialHysteresisType final : public DisturbanceType {
 public:
  PolynomialHysteresisType()
      : DisturbanceType(
            "polynomial_hysteresis", "cubic disturbance added to the input, one polynomial a branch",
            "Modeling and Control of Piezoelectric Hysteresis, eq. 1-8, 11-13",
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
                        "Modeling and Control of Piezoelectric Hysteresis, eq. 9, 10",
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

const ModelType& polynomial_hysteresis_type() {
  static const PolynomialHysteresisType type;
  return type;
}

const ModelType& sine_hysteresis_type() {
  static const SineHysteresisType type;
  return type;
}

}  // namespace bodesmith::hysteresis
