#include "hysteresis/model_type.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/progress.hpp"

namespace bodesmith::hysteresis {
namespace {

using Shape = ParameterSpec::Shape;

void set_default(Parameters& out, const ParameterSpec& spec) {
  if (spec.shape == Shape::word) {
    out.set(spec.name, std::string_view(spec.words.front()));
  } else {
    out.set(spec.name, *spec.default_value);
  }
}

/// "r has 2 numbers, expected one"; empty when the value is legal.
std::string error_of(const Parameters& given, const ParameterSpec& spec) {
  if (spec.shape == Shape::word) {
    const std::string error = spec.validate(given.word(spec.name));
    return error.empty() ? error : spec.name + " " + error;
  }
  const std::vector<double>& numbers = given.list(spec.name);
  if (spec.shape != Shape::list && numbers.size() != 1)
    return fmt::format("{} has {} numbers, expected one", spec.name, numbers.size());
  for (const double number : numbers) {
    if (const std::string error = spec.validate(number); !error.empty()) return spec.name + " " + error;
  }
  return {};
}

}  // namespace

Parameters::Value& Parameters::value(std::string_view name) {
  for (Value& candidate : values_) {
    if (candidate.name == name) return candidate;
  }
  values_.push_back({std::string(name), {}, {}});
  return values_.back();
}

const Parameters::Value& Parameters::value(std::string_view name) const {
  for (const Value& candidate : values_) {
    if (candidate.name == name) return candidate;
  }
  throw std::logic_error(fmt::format("hysteresis parameter '{}' is not set", name));
}

Parameters& Parameters::set(std::string_view name, double number) {
  value(name).numbers = {number};
  return *this;
}

Parameters& Parameters::set(std::string_view name, std::vector<double> numbers) {
  value(name).numbers = std::move(numbers);
  return *this;
}

Parameters& Parameters::set(std::string_view name, std::string_view text) {
  value(name).word = std::string(text);
  return *this;
}

bool Parameters::has(std::string_view name) const {
  return std::ranges::any_of(values_, [&](const Value& v) { return v.name == name; });
}

double Parameters::number(std::string_view name) const {
  const Value& found = value(name);
  if (found.numbers.size() != 1)
    throw std::logic_error(fmt::format("hysteresis parameter '{}' is not one number", name));
  return found.numbers[0];
}

const std::vector<double>& Parameters::list(std::string_view name) const {
  return value(name).numbers;
}

const std::string& Parameters::word(std::string_view name) const {
  return value(name).word;
}

Parameters completed(const Parameters& given, const std::vector<ParameterSpec>& specs,
                     std::string_view where) {
  for (const Parameters::Value& value : given.values()) {
    if (find_parameter(specs, value.name) == nullptr)
      throw DesignError(fmt::format("{}: there is no parameter '{}'", where, value.name));
  }
  Parameters out;
  for (const ParameterSpec& spec : specs) {
    if (!given.has(spec.name)) {
      if (!spec.optional()) throw DesignError(fmt::format("{}: parameter '{}' is missing", where, spec.name));
      set_default(out, spec);
      continue;
    }
    if (const std::string error = error_of(given, spec); !error.empty())
      throw DesignError(fmt::format("{}: {}", where, error));
    if (spec.shape == Shape::word) {
      out.set(spec.name, std::string_view(given.word(spec.name)));
    } else {
      out.set(spec.name, given.list(spec.name));
    }
  }
  return out;
}

ModelType::ModelType(std::string name, std::string what, std::vector<ParameterSpec> parameters)
    : name_(std::move(name)), what_(std::move(what)), parameters_(std::move(parameters)) {}

Model ModelType::model(const Parameters& values) const {
  Model out{this, completed(values, parameters_, name_)};
  validate(out.parameters);
  return out;
}

std::unique_ptr<Operator> make_operator(const Model& model) {
  return model.type->make_operator(model.parameters);
}

std::unique_ptr<Inverse> make_inverse(const Model& model) {
  return model.type->make_inverse(model.parameters);
}

// Each function stands in the model's own file. A new model is one line here.
BODESMITH_REGISTRY(ModelType, model_type_registry, "hysteresis model", polynomial_hysteresis_type,
                   sine_hysteresis_type, exponential_operator_type, ellipse_type, fractional_dynamic_type,
                   krasnoselskii_pokrovskii_type, preisach_type, prandtl_ishlinskii_type, bouc_wen_type)

Model make_model(std::string_view type, const Parameters& values) {
  return model_type_registry().get(type).model(values);
}

Identified ModelType::identify(std::span<const TimeRecord> records, const IdentifyOptions& options) const {
  for (const TimeRecord& record : records) record.require_measured_sizes();
  const Stopwatch watch;
  Identified out = fit(records, options);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace bodesmith::hysteresis
