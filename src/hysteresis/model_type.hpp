#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/parameter.hpp"
#include "base/registry.hpp"
#include "hysteresis/inverse.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

/// Values of the parameters of one model, by name.
class Parameters {
 public:
  struct Value {
    std::string name;
    std::vector<double> numbers;
    std::string word;
  };

  Parameters() = default;
  /// Sets or replaces.
  Parameters& set(std::string_view name, double value);
  Parameters& set(std::string_view name, std::vector<double> values);
  Parameters& set(std::string_view name, std::string_view word);
  Parameters& set(std::string_view name, const char* word) { return set(name, std::string_view(word)); }

  bool has(std::string_view name) const;
  /// These throw std::logic_error when the parameter is absent or of another shape: completed() comes first.
  double number(std::string_view name) const;
  const std::vector<double>& list(std::string_view name) const;
  const std::string& word(std::string_view name) const;

  const std::vector<Value>& values() const { return values_; }

 private:
  Value& value(std::string_view name);
  const Value& value(std::string_view name) const;
  std::vector<Value> values_;
};

/// All parameters of `specs` in their order, with the defaults of those that are not given. Throws DesignError
/// `WHERE: …` for a missing or an unknown name, another shape and a value that is not legal.
Parameters completed(const Parameters& given, const std::vector<ParameterSpec>& specs,
                     std::string_view where);

class ModelType;
struct Identified;
struct IdentifyOptions;

/// A model as it stands in model.toml: its type and the values of all its parameters.
struct Model {
  const ModelType* type = nullptr;  ///< null: no hysteresis
  Parameters parameters;
};

/// Of models whose output is one curve of the input while it rises and another one while it falls, whatever came
/// before: it jumps between them when the input turns.
struct BranchCurves {
  std::function<double(bool rising, double u)> curve;
  /// The same as y = c0 + c1 u + …, where the curves are polynomials; empty otherwise.
  std::vector<double> rising;
  std::vector<double> falling;
  double switch_delay_s = 0.0;  ///< the branch follows the input's direction this much later
};

/// One kind of model: everything the program needs to know of it. A new one is a file of its own and one line
/// in model_type.cpp.
class ModelType {
 public:
  ModelType(std::string name, std::string what, std::vector<ParameterSpec> parameters);
  virtual ~ModelType() = default;

  const std::string& name() const { return name_; }  ///< `type` of the block in model.toml
  const std::string& what() const { return what_; }  ///< one line for a person
  const std::vector<ParameterSpec>& parameters() const { return parameters_; }

  /// Fills in what is optional and checks everything; throws DesignError.
  Model model(const Parameters& values) const;
  /// From records that begin at rest. Throws InputError when the records cannot determine the model.
  Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) const;

  // All of these take the values of every parameter, each legal by itself.

  /// Throws DesignError when the values do not go together (lengths of lists, order of tables). A message about
  /// one number begins with its name.
  virtual void validate(const Parameters& values) const = 0;
  virtual std::unique_ptr<Operator> make_operator(const Parameters& values) const = 0;
  /// Throws DesignError when the model with these values has no inverse (not monotone).
  virtual std::unique_ptr<Inverse> make_inverse(const Parameters& values) const = 0;
  /// Nothing for models that remember more than the input's direction.
  virtual std::optional<BranchCurves> branch_curves(const Parameters&) const { return std::nullopt; }
  /// True of models of steady sines, whose output for other inputs means little: never the best of several.
  virtual bool for_steady_sines() const { return false; }
  /// With these values step() solves an equation in steps of its own, hundreds where it is steep.
  virtual bool steps_within_samples(const Parameters&) const { return false; }
  /// H(s) of a model that is linear (constants and drifts left out), on the imaginary axis and to the right of it.
  virtual std::optional<std::complex<double>> response(const Parameters&, std::complex<double> /*s*/) const {
    return std::nullopt;
  }
  /// Lists that hold the coefficients of u, u², … of a polynomial which a circuit makes by multipliers.
  virtual std::vector<std::string_view> polynomial_lists() const { return {}; }

 protected:
  virtual Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const = 0;

 private:
  std::string name_;
  std::string what_;
  std::vector<ParameterSpec> parameters_;
};

/// A type whose parameters become one value: `Shape::from(parameters)`, which throws DesignError when they do
/// not go together. Operator and inverse are made of that: of
/// the classes named here, or as the type itself says.
template <class Shape, class ItsOperator = void, class ItsInverse = void>
class ShapedModelType : public ModelType {
 public:
  using ModelType::ModelType;
  void validate(const Parameters& values) const final { (void)Shape::from(values); }
  std::unique_ptr<Operator> make_operator(const Parameters& values) const final {
    return operator_of(Shape::from(values));
  }
  std::unique_ptr<Inverse> make_inverse(const Parameters& values) const final {
    return inverse_of(Shape::from(values));
  }

 protected:
  virtual std::unique_ptr<Operator> operator_of(const Shape& s) const {
    return made<ItsOperator, Operator>(s);
  }
  virtual std::unique_ptr<Inverse> inverse_of(const Shape& s) const { return made<ItsInverse, Inverse>(s); }

 private:
  template <class Made, class Base>
  static std::unique_ptr<Base> made(const Shape& shape) {
    if constexpr (!std::is_void_v<Made>) return std::make_unique<Made>(shape);
    throw std::logic_error("the type says itself what it makes");
  }
};

std::unique_ptr<Operator> make_operator(const Model& model);
std::unique_ptr<Inverse> make_inverse(const Model& model);

/// All types, in the order of the contract.
Registry<ModelType>& model_type_registry();

/// A model of the type of that name. InputError for an unknown name, DesignError for values that do not fit.
Model make_model(std::string_view type, const Parameters& values);

struct IdentifyOptions {
  std::uint64_t seed = 1;
  /// `best` (the better method, default) or `paper` (what the paper does).
  std::string method = "best";
  /// Size of the model where it has one: plays, exponential operators, Preisach or KP levels. 0: the type's
  /// default.
  int size = 0;
  /// Operating frequency where the model asks for it; 0: taken from the record.
  double frequency_hz = 0.0;
  /// Seconds at the start of every record that are simulated but not fitted.
  double skip_s = 0.0;
  /// Ask for the asymmetric form where the type has one (Prandtl-Ishlinskii: dead zones behind the plays).
  bool asymmetric = false;
  /// Effort of a stochastic search, relative to its default.
  double effort = 1.0;

  bool as_in_paper() const { return method == "paper"; }
};

/// A parameter with its standard deviation, from the residual's Jacobian at the solution, widened for the
/// residual's own correlation (effective sample size).
struct ParameterUncertainty {
  std::string name;  ///< e.g. "w[3]"
  double value = 0.0;
  double standard_deviation = 0.0;
};

/// gain u + offset.
struct Scaling {
  double gain = 1.0;
  double offset = 0.0;

  double operator()(double u) const { return offset + gain * u; }
};

/// What was found: y = output(H[input(u)]), H the model.
struct Identified {
  Model model;
  Scaling input;
  Scaling output;
  std::string method;  ///< in words
  std::vector<ParameterUncertainty> uncertainty;
  std::vector<std::string> notes;  ///< what a person must know (not identifiable, limits met)
  bool converged = true;           ///< false: the search stopped at its limit, not at a minimum
  double compute_s = 0.0;
};

}  // namespace bodesmith::hysteresis
