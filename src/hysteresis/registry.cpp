#include "hysteresis/registry.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::hysteresis {

// Each stands in the model's own file.
ModelType polynomial_hysteresis_type();
ModelType sine_hysteresis_type();
ModelType exponential_operator_type();
ModelType ellipse_type();
ModelType fractional_dynamic_type();
ModelType krasnoselskii_pokrovskii_type();
ModelType preisach_type();
ModelType prandtl_ishlinskii_type();
ModelType bouc_wen_type();

const std::vector<ModelType>& model_types() {
  static const std::vector<ModelType> all = {
      polynomial_hysteresis_type(),
      sine_hysteresis_type(),
      exponential_operator_type(),
      ellipse_type(),
      fractional_dynamic_type(),
      krasnoselskii_pokrovskii_type(),
      preisach_type(),
      prandtl_ishlinskii_type(),
      bouc_wen_type(),
  };
  return all;
}

const ModelType* find_model_type(std::string_view name) {
  for (const ModelType& type : model_types()) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

const ModelType& model_type(std::string_view name) {
  if (const ModelType* found = find_model_type(name)) return *found;
  std::vector<std::string> names;
  for (const ModelType& type : model_types()) names.push_back(type.name);
  throw InputError(
      fmt::format("there is no hysteresis model '{}', expected one of {}", name, join(names, ", ")));
}

Model model_from_node(const Node& block) {
  const std::string name = block.at("type").string();
  const ModelType* type = find_model_type(name);
  if (type == nullptr) {
    std::vector<std::string> names;
    for (const ModelType& known : model_types()) names.push_back(known.name);
    block.at("type").fail(fmt::format("is \"{}\", expected a hysteresis model: {}", name, join(names, ", ")));
  }
  Model out{name, parameters_from_node(block, type->parameters, {"type", "free"})};
  try {
    type->check(out.parameters);
  } catch (const DesignError& error) {
    block.fail(error.what());
  }
  return out;
}

Model checked_model(std::string_view name, const Parameters& values) {
  const ModelType& type = model_type(name);
  Model out{type.name, checked(values, type.parameters, type.name)};
  type.check(out.parameters);
  return out;
}

std::string to_toml(const Model& model) {
  return fmt::format("type = \"{}\"\n{}", model.type,
                     to_toml(model.parameters, model_type(model.type).parameters));
}

std::unique_ptr<Operator> make_operator(const Model& model) {
  return model_type(model.type).make_operator(model.parameters);
}

std::unique_ptr<Inverse> make_inverse(const Model& model) {
  return model_type(model.type).make_inverse(model.parameters);
}

}  // namespace bodesmith::hysteresis
