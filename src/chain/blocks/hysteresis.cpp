#include <algorithm>
#include <memory>

#include "base/error.hpp"
#include "chain/blocks/block_list.hpp"
#include "hysteresis/registry.hpp"

namespace bodesmith::chain {
namespace {

using hysteresis::ModelType;
using hysteresis::Operator;
using hysteresis::ParameterInfo;

/// Any operator of the hysteresis room.
class OperatorKernel final : public MemoryKernel {
 public:
  /// `at_once`: the same operator whose switch does not wait, when its branches are cubic and nothing else
  /// counts.
  OperatorKernel(std::unique_ptr<Operator> op, bool jumps, const Operator* at_once = nullptr,
                 double switch_delay_s = 0.0)
      : operator_(std::move(op)), jumps_(jumps), switch_delay_s_(switch_delay_s) {
    if (at_once == nullptr) return;
    up_ = branch(*at_once, 1);
    down_ = branch(*at_once, -1);
  }
  std::unique_ptr<MemoryKernel> clone() const override {
    auto copy = std::make_unique<OperatorKernel>(operator_->clone(), jumps_);
    copy->switch_delay_s_ = switch_delay_s_;
    copy->up_ = up_;
    copy->down_ = down_;
    copy->u_ = u_;
    copy->y_ = y_;
    return copy;
  }
  double reset(double u, bool equilibrium) override {
    u_ = u;
    y_ = operator_->reset(equilibrium ? u : 0.0);
    if (!equilibrium && u != 0.0) y_ = operator_->step(u, 0.0);
    return y_;
  }
  double step(double u, double dt_s) override {
    u_ = u;
    return y_ = operator_->step(u, dt_s);
  }
  double peek(double u, double dt_s) const override { return operator_->peek(u, dt_s); }
  double departing(double next) const override {
    // The smallest move that still has a direction shows the branch that is about to be taken.
    if (!jumps_ || next == u_) return y_;
    return operator_->peek(u_ + 1e-12 * (next - u_), 0.0);
  }
  bool jumps_at_turns() const override { return jumps_; }
  std::vector<double> branch_polynomial(int direction) const override { return direction > 0 ? up_ : down_; }
  double switch_delay_s() const override { return switch_delay_s_; }
  bool rate_independent() const override { return operator_->rate_independent(); }

 private:
  /// The cubic through four of its values, met while moving in that direction.
  static std::vector<double> branch(const Operator& at_once, int direction) {
    const auto probe = at_once.clone();
    double y[4];
    for (int i = 0; i < 4; ++i) {
      const double x = i / 3.0;
      probe->reset(x - direction);
      y[i] = probe->step(x, 0.0);
    }
    // Newton's divided differences at 0, 1/3, 2/3, 1, multiplied out.
    const double d1 = y[1] - y[0];
    const double d2 = y[2] - 2.0 * y[1] + y[0];
    const double d3 = y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0];
    return {y[0], 3.0 * d1 - 1.5 * d2 + d3, 4.5 * d2 - 4.5 * d3, 4.5 * d3};
  }

  std::unique_ptr<Operator> operator_;
  bool jumps_;
  double switch_delay_s_ = 0.0;
  std::vector<double> up_;  ///< see branch_polynomial()
  std::vector<double> down_;
  double u_ = 0.0;
  double y_ = 0.0;
};

ParameterSpec spec_of(const ParameterInfo& info) {
  ParameterSpec s;
  s.name = info.name;
  s.what = info.what;
  s.low = info.lower;
  s.high = info.upper;
  s.words = info.words;
  if (info.shape == ParameterInfo::Shape::array) s.shape = ParameterSpec::Shape::list;
  if (info.shape == ParameterInfo::Shape::word) s.shape = ParameterSpec::Shape::word;
  if (!info.required && info.shape == ParameterInfo::Shape::scalar && !info.otherwise.empty()) {
    s.standard = info.otherwise.front();
  }
  s.optional_list = !info.required && info.shape == ParameterInfo::Shape::array;
  return s;
}

std::vector<ParameterSpec> specs_of(const ModelType& model) {
  std::vector<ParameterSpec> out;
  for (const ParameterInfo& info : model.parameters) out.push_back(spec_of(info));
  return out;
}

class HysteresisBlock final : public NamedBlockType {
 public:
  explicit HysteresisBlock(const ModelType& model)
      : NamedBlockType(model.name, model.what, specs_of(model)), model_(&model) {}

  std::string complaint(const Block& block) const override {
    try {
      hysteresis::checked_model(name(), parameters_of(block));
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  Kernel kernel(const Block& block) const override {
    // With the slope's sign as the rule each branch is one curve, and a turn inside the stroke jumps between
    // them.
    const bool by_slope = (name() == "polynomial_hysteresis" || name() == "sine_hysteresis") &&
                          block.word("minor") == "slope_sign";
    auto parameters = parameters_of(block);
    auto op = hysteresis::make_operator(hysteresis::checked_model(name(), parameters));
    if (!by_slope || name() != "polynomial_hysteresis")
      return std::make_unique<OperatorKernel>(std::move(op), by_slope);
    const double delay = block.get("switch_delay_s");
    parameters.set("switch_delay_s", 0.0);
    const auto at_once = hysteresis::make_operator(hysteresis::checked_model(name(), parameters));
    return std::make_unique<OperatorKernel>(std::move(op), by_slope, at_once.get(), delay);
  }
  std::vector<PolynomialList> polynomials() const override {
    if (name() != "polynomial_hysteresis") return {};
    return {{"ascending", 0}, {"descending", 0}};
  }

 private:
  hysteresis::Parameters parameters_of(const Block& block) const {
    hysteresis::Parameters out;
    for (const ParameterInfo& info : model_->parameters) {
      switch (info.shape) {
        case ParameterInfo::Shape::scalar:
          out.set(info.name, block.get(info.name));
          break;
        case ParameterInfo::Shape::word:
          out.set(info.name, block.word(info.name));
          break;
        case ParameterInfo::Shape::array: {
          std::vector<double> values = block.list(info.name);
          if (!values.empty() || info.required) out.set(info.name, std::move(values));
          break;
        }
      }
    }
    return out;
  }

  const ModelType* model_;
};

}  // namespace

std::vector<const BlockType*> hysteresis_blocks() {
  static const std::vector<std::unique_ptr<HysteresisBlock>> owned = [] {
    std::vector<std::unique_ptr<HysteresisBlock>> all;
    for (const ModelType& model : hysteresis::model_types())
      all.push_back(std::make_unique<HysteresisBlock>(model));
    return all;
  }();
  std::vector<const BlockType*> out;
  for (const auto& type : owned) out.push_back(type.get());
  return out;
}

}  // namespace bodesmith::chain
