#include "chain/blocks/hysteresis.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

#include "base/error.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

using hysteresis::BranchCurves;
using hysteresis::ModelType;
using hysteresis::Operator;

/// Any operator of the hysteresis room.
class OperatorKernel final : public MemoryKernel {
 public:
  OperatorKernel(std::unique_ptr<Operator> op, std::optional<BranchCurves> curves)
      : operator_(std::move(op)), curves_(std::move(curves)) {}
  double reset(double u, bool equilibrium) override {
    const double y = operator_->reset(equilibrium ? u : 0.0);
    return equilibrium || u == 0.0 ? y : operator_->step(u, 0.0);
  }
  double step(double u, double dt_s) override { return operator_->step(u, dt_s); }
  double peek(double u, double dt_s) const override { return operator_->peek(u, dt_s); }
  bool has_branches() const override { return curves_.has_value(); }
  double on_branch(bool rising, double u) const override {
    const std::vector<double>& polynomial = rising ? curves_->rising : curves_->falling;
    return polynomial.empty() ? curves_->curve(rising, u) : polynomial_at(polynomial, u);
  }
  std::vector<double> branch_polynomial(bool rising) const override {
    if (!curves_) return {};
    return rising ? curves_->rising : curves_->falling;
  }
  double switch_delay_s() const override { return curves_ ? curves_->switch_delay_s : 0.0; }
  bool rate_independent() const override { return operator_->rate_independent(); }

 private:
  std::unique_ptr<Operator> operator_;
  std::optional<BranchCurves> curves_;
};

/// Any model of hysteresis/ as a block.
class HysteresisBlock final : public BlockType {
 public:
  explicit HysteresisBlock(const ModelType& model)
      : BlockType(model.name(), model.what(), model.parameters()), model_(&model) {}

  std::string validate(const Block& block) const override {
    try {
      model_->validate(parameters_of(block));
    } catch (const DesignError& error) {
      return error.what();
    }
    return {};
  }
  Kernel kernel(const Block& block) const override {
    const hysteresis::Model model = hysteresis_model_of(block);
    return std::make_unique<OperatorKernel>(make_operator(model), model_->branch_curves(model.parameters));
  }
  std::optional<Complex> transfer(const Block& block, Complex s) const override {
    return model_->response(parameters_of(block), s);
  }
  /// The model's own inverse, sample by sample, where it has one.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    if (wanted.values.empty()) return FoundInput{};
    std::unique_ptr<hysteresis::Inverse> inverse;
    try {
      inverse = make_inverse(hysteresis_model_of(block));
    } catch (const DesignError&) {
      return std::nullopt;
    }
    const auto [low, high] = std::minmax_element(wanted.values.begin(), wanted.values.end());
    const double tolerance = 1e-6 * std::max(*high - *low, 1e-300);
    FoundInput out;
    for (std::size_t i = 0; i < wanted.values.size(); ++i) {
      const double y = wanted.values[i];
      out.values.push_back(i == 0 ? inverse->reset(y) : inverse->step(y, wanted.step_s));
      if (std::abs(inverse->achieved() - y) > tolerance) out.out_of_reach.push_back(i);
    }
    return out;
  }
  std::vector<PolynomialList> polynomials() const override {
    std::vector<PolynomialList> out;
    for (const std::string_view key : model_->polynomial_lists()) out.push_back({key, 0});
    return out;
  }
  bool steps_within_samples(const Block& block) const override {
    return model_->steps_within_samples(parameters_of(block));
  }
  const ModelType* hysteresis_model() const override { return model_; }

  static hysteresis::Parameters parameters_of(const Block& block) {
    hysteresis::Parameters out;
    for (const ParameterSpec& spec : block.type().specs()) {
      switch (spec.shape) {
        case ParameterSpec::Shape::number:
        case ParameterSpec::Shape::flag:
          out.set(spec.name, block.get(spec.name));
          break;
        case ParameterSpec::Shape::word:
          out.set(spec.name, std::string_view(block.word(spec.name)));
          break;
        case ParameterSpec::Shape::list:
          out.set(spec.name, block.list(spec.name));
          break;
      }
    }
    return out;
  }

 private:
  const ModelType* model_;
};

}  // namespace

const BlockType& hysteresis_block_type(const ModelType& model) {
  static std::mutex mutex;  // threads make blocks
  const std::lock_guard<std::mutex> lock(mutex);
  static std::map<const ModelType*, std::unique_ptr<HysteresisBlock>> types;
  std::unique_ptr<HysteresisBlock>& type = types[&model];
  if (type == nullptr) type = std::make_unique<HysteresisBlock>(model);
  return *type;
}

hysteresis::Model hysteresis_model_of(const Block& block) {
  return block.hysteresis_model()->model(HysteresisBlock::parameters_of(block));
}

Block hysteresis_block(const hysteresis::Model& model) {
  Block out(hysteresis_block_type(*model.type));
  for (const ParameterSpec& spec : model.type->parameters()) {
    switch (spec.shape) {
      case ParameterSpec::Shape::number:
      case ParameterSpec::Shape::flag:
        out.set(spec.name, model.parameters.number(spec.name));
        break;
      case ParameterSpec::Shape::word:
        out.set_word(spec.name, model.parameters.word(spec.name));
        break;
      case ParameterSpec::Shape::list:
        out.set(spec.name, model.parameters.list(spec.name));
        break;
    }
  }
  return out;
}

}  // namespace bodesmith::chain
