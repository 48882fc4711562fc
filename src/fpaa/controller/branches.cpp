#include "fpaa/controller/branches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/multiplier.hpp"
#include "fpaa/cams/transfer_function.hpp"

namespace bodesmith::fpaa {
namespace {

using Direction = Disturbance::Branch;

/// X Y/3 keeps a product of full-scale voltages at full scale.
constexpr Multiplier kFullScaleMultiplier{.scale_per_v = 1.0 / kFullScaleV};
/// Of full scale that a branch's output may take.
constexpr double kBranchV = 2.9;
/// Of a sine that a compensator takes: the disturbance is no sine.
constexpr double kCompensatorShare = 0.7;
/// Largest weight of a sum aimed at: a capacitor ratio near 1 has the finest steps.
constexpr double kGreatestWeight = 1.5;
constexpr int kWeightPoints = 101;
/// A line in parallel with the table is taken when the table's slope, rms over the range, falls to this share or less:
/// the 8 bits of the converter then act on a flatter remainder.
constexpr double kLinePays = 0.8;

/// What a Multiplier makes of a control voltage of full scale, over 1.
double amplitude_factor() {
  return kFullScaleMultiplier.scale_per_v * Multiplier::quantised(kFullScaleV);
}

double mean_square_slope(const std::vector<double>& values, double line_step) {
  double sum = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double slope = values[i] - values[i - 1] - line_step;
    sum += slope * slope;
  }
  return sum;
}

std::vector<double> points_of(const DriveRange& range) {
  std::vector<double> out;
  for (int i = 0; i < kWeightPoints; ++i)
    out.push_back(range.low + (range.high - range.low) * i / (kWeightPoints - 1.0));
  return out;
}

}  // namespace

TableShape table_shape(const Disturbance& d, Direction branch, const DriveRange& range,
                       const VoltScale& scale) {
  const std::vector<double> points = points_of(range);
  std::vector<double> values;
  for (const double x : points) values.push_back(d.value(branch, x));
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  TableShape out;
  if (mean_square_slope(values, step) <= kLinePays * kLinePays * mean_square_slope(values, 0.0)) {
    out.line = step / (points[1] - points[0]);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.greatest = std::max(out.greatest, std::abs(values[i] - out.line * (points[i] - scale.centre)));
  }
  return out;
}

double table_volts(const Disturbance& d, Direction branch, const TableShape& shape, const VoltScale& scale,
                   double input_v) {
  if (shape.greatest == 0.0) return 0.0;
  const double x = scale.stroke(input_v);
  return -kFullScaleV * (d.value(branch, x) - shape.line * (x - scale.centre)) / shape.greatest;
}

const char* ControllerBranches::name_of(Direction branch) {
  return branch == Direction::ascending ? "Ascending" : "Descending";
}

ControllerBranches::ControllerBranches(ControllerVariant& variant, const Disturbance& disturbance,
                                       const BranchPlans& compensators, const ControllerOptions& options)
    : out_(variant),
      disturbance_(disturbance),
      options_(options),
      range_(drive_range(disturbance, compensators)) {
  for (const Direction branch : kBranches) {
    Side& made = sides_[branch_index(branch)];
    const Plan* plan = compensators[branch_index(branch)];
    made.compensated = plan != nullptr;
    made.most_v = plan != nullptr && plan->max_input_v > 0.0
                      ? std::min(kBranchV, kCompensatorShare * plan->max_input_v)
                      : kBranchV;
    made.greatest = greatest_disturbance(disturbance, branch, range_);
    const std::vector<double> gains = rate_gains(disturbance, branch, compensators);
    made.greatest_gain = *std::ranges::max_element(gains);
    if (out_.by != PolynomialBy::lookup) made.weights = power_weights(branch);
  }
  // As capacitors make it: the branches' own gains then take up the difference.
  ControllerCam sum = cam("Output", sum_diff_cam(), {"r", "Branch"});
  sum.weights = {1.0, -wanted_output_weight()};
  set_weights_first_exact(sum);
  output_weight_ = -sum.realised.required_number("gain_2");
  for (Side& made : sides_) {
    for (double& w : made.weights) w /= output_weight_;
  }
}

/// Of the signals that add_powers() names, for an output weight of 1. Outside V = S x, S x^2, S x^3; on the
/// board 3 V, V = S (x - centre), V^2/3, V^3/9: about the middle of the range the higher coefficients are the
/// least.
std::vector<double> ControllerBranches::power_weights(Direction branch) const {
  const auto& a = disturbance_.coefficients(branch);
  if (out_.by == PolynomialBy::outside) return {a[0], a[1], a[2]};
  const double s = out_.scale.volts_per_stroke;
  const double x = out_.scale.centre;
  return {s * disturbance_.value(branch, x) / kFullScaleV, disturbance_.slope(branch, x),
          kFullScaleV * (a[1] + 3.0 * a[2] * x) / s, kFullScaleV * kFullScaleV * a[2] / (s * s)};
}

double ControllerBranches::wanted_output_weight() const {
  double out = 0.0;
  for (const Side& made : sides_) {
    out = std::max(out, made.greatest_gain * made.greatest * out_.scale.volts_per_stroke / made.most_v);
    for (const double w : made.weights)
      out = std::max(out, made.greatest_gain * std::abs(w) / kGreatestWeight);
  }
  return out > 0.0 ? out : 1.0;
}

ControllerCam ControllerBranches::cam(const std::string& name, const Cam& cam,
                                      std::vector<std::string> inputs) const {
  ControllerCam out;
  out.name = name;
  out.cam = &cam;
  out.clock_a = options_.fast_clock;
  out.delay_cycles = cam.facts().delay_cycles;
  // A CAM whose resources are not publicly known gets a CAB of its own.
  const Resources whole_cab{kOpAmps, kCapacitors, 1, 0, 0};
  out.resources = cam.resources(inputs.size()).value_or(whole_cab);
  out.inputs = std::move(inputs);
  return out;
}

void ControllerBranches::add_outside(OutsidePart part) {
  if (out_.find_outside(part.name) == nullptr) out_.outside.push_back(std::move(part));
}

BranchInputs ControllerBranches::add_powers(std::vector<ControllerCam>& cams, const std::string& prefix,
                                            const std::string& argument, int group) {
  using Kind = OutsidePart::Kind;
  BranchInputs out{argument, {}};
  const double error = 1.0 + options_.outside_error_percent / 100.0;
  const double per_v = error / out_.scale.volts_per_stroke;
  const std::string low = prefix.empty() ? "" : "first_";
  if (out_.by == PolynomialBy::outside) {
    add_outside({Kind::multiplier, low + "x2", {argument, argument}, per_v});
    add_outside({Kind::multiplier, low + "x3", {low + "x2", argument}, per_v});
    out.powers = {argument, low + "x2", low + "x3"};
  } else if (out_.by == PolynomialBy::multipliers) {
    add_multiplier(cams, prefix + "Square", {argument, argument}, group);
    add_multiplier(cams, prefix + "Cube", {prefix + "Square", argument}, group);
    add_outside({Kind::constant, "one", {}, kFullScaleV});
    out.powers = {"one", argument, prefix + "Square", prefix + "Cube"};
  }
  return out;
}

std::string ControllerBranches::add_branch(std::vector<ControllerCam>& cams, const std::string& prefix,
                                           Direction branch, const BranchInputs& inputs, int group) {
  const std::string name = prefix + name_of(branch);
  const std::string last = out_.by == PolynomialBy::lookup ? add_table(cams, name, branch, inputs, group)
                                                           : add_sum(cams, name, branch, inputs, group);
  if (disturbance_.amplitude.alpha.empty()) return last;
  const std::string control = std::string("amplitude_") + name_of(branch);
  add_outside({OutsidePart::Kind::constant, control, {}, kFullScaleV});
  return add_multiplier(cams, name + "Amplitude", {last, control}, group);
}

void ControllerBranches::finish(ControllerCam& cam, std::vector<double> weights, std::vector<double> products,
                                Direction branch, int group) const {
  if (!disturbance_.amplitude.alpha.empty()) {
    for (double& w : weights) w /= amplitude_factor();
  }
  cam.weights = std::move(weights);
  cam.products = std::move(products);
  if (!sides_[branch_index(branch)].compensated && !disturbance_.rate.frequency.empty())
    cam.scheduled = branch;
  cam.group = group;
  set_weights(cam, 1.0);
}

std::vector<double> ControllerBranches::products_of(const std::vector<std::vector<double>>& signals) const {
  std::vector<double> out;
  for (const auto& one : signals) {
    for (const auto& other : signals) {
      double sum = 0.0;
      for (std::size_t i = 0; i < one.size(); ++i) sum += one[i] * other[i];
      out.push_back(sum / static_cast<double>(one.size()));
    }
  }
  return out;
}

std::string ControllerBranches::add_sum(std::vector<ControllerCam>& cams, const std::string& name,
                                        Direction branch, const BranchInputs& inputs, int group) {
  const bool outside = out_.by == PolynomialBy::outside;
  std::vector<std::vector<double>> signals(inputs.powers.size());
  for (const double x : points_of(range_)) {
    const double v = outside ? x : out_.scale.volts(x) / kFullScaleV;
    double power = outside ? out_.scale.volts_per_stroke * v : kFullScaleV;
    for (auto& signal : signals) {
      signal.push_back(power);
      power *= v;
    }
  }
  ControllerCam sum = cam(name + "Sum", sum_diff_cam(), inputs.powers);
  sum.option = fmt::format("{} inputs", inputs.powers.size());
  finish(sum, sides_[branch_index(branch)].weights, products_of(signals), branch, group);
  cams.push_back(std::move(sum));
  return cams.back().name;
}

std::string ControllerBranches::add_table(std::vector<ControllerCam>& cams, const std::string& name,
                                          Direction branch, const BranchInputs& inputs, int group) {
  const TableShape shape = table_shape(disturbance_, branch, range_, out_.scale);
  // What follows inverts: the table is upside down.
  LookupTable table;
  table.bytes.fill(128);
  if (shape.greatest > 0.0) {
    table = value_or_throw(LookupTable::of(
        [&](double v) { return fpaa::table_volts(disturbance_, branch, shape, out_.scale, v); }));
  }
  ControllerCam lookup = cam(name + "Table", transfer_function_cam(), {inputs.argument});
  lookup.requested = lookup.realised = table.values();
  lookup.capacitors = {{"Cout", table.cout}};
  lookup.group = group;
  cams.push_back(std::move(lookup));

  const double table_weight =
      -std::max(shape.greatest, 1e-12) * out_.scale.volts_per_stroke / (kFullScaleV * output_weight_);
  if (shape.line == 0.0) {
    ControllerCam gain = cam(name + "Gain", gain_hold_cam(), {name + "Table"});
    gain.option = "Inverting";
    finish(gain, {table_weight}, {}, branch, group);
    cams.push_back(std::move(gain));
    return cams.back().name;
  }
  std::vector<double> from_table, from_argument;
  for (const double x : points_of(range_)) {
    const double v = out_.scale.volts(x);
    from_table.push_back(fpaa::table_volts(disturbance_, branch, shape, out_.scale, v));
    from_argument.push_back(v);
  }
  ControllerCam gain = cam(name + "Gain", sum_diff_cam(), {name + "Table", inputs.argument});
  gain.option = "2 inputs";
  finish(gain, {table_weight, shape.line / output_weight_}, products_of({from_table, from_argument}), branch,
         group);
  cams.push_back(std::move(gain));
  return cams.back().name;
}

std::string ControllerBranches::add_multiplier(std::vector<ControllerCam>& cams, const std::string& name,
                                               std::vector<std::string> inputs, int group) const {
  ControllerCam made = cam(name, multiplier_cam(), std::move(inputs));
  made.option = kFullScaleMultiplier.option();
  made.requested = made.realised = kFullScaleMultiplier.values();
  made.group = group;
  cams.push_back(std::move(made));
  return cams.back().name;
}

}  // namespace bodesmith::fpaa
