#include "hysteresis/model_type.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::hysteresis {

ModelType::ModelType(std::string name, std::string what, std::string source,
                     std::vector<ParameterSpec> parameters)
    : name_(std::move(name)),
      what_(std::move(what)),
      source_(std::move(source)),
      parameters_(std::move(parameters)) {}

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

}  // namespace bodesmith::hysteresis
