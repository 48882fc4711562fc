#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/document.hpp"
#include "hysteresis/identification.hpp"
#include "hysteresis/inverse.hpp"
#include "hysteresis/model.hpp"
#include "hysteresis/operator.hpp"
#include "hysteresis/parameters.hpp"

namespace bodesmith::hysteresis {

/// One kind of model: everything the program needs to know of it. A new one is a file of its own and one line
/// in registry.cpp.
struct ModelType {
  std::string name;    ///< `type` of the block in model.toml
  std::string what;    ///< one line for a person
  std::string source;  ///< paper and equations
  std::vector<ParameterInfo> parameters;
  /// Throws DesignError when the values do not go together (lengths of arrays, order of tables).
  void (*check)(const Parameters& values);
  std::unique_ptr<Operator> (*make_operator)(const Parameters& values);
  /// Throws DesignError when the model with these values has no inverse (not monotone).
  std::unique_ptr<Inverse> (*make_inverse)(const Parameters& values);
  Identified (*identify)(std::span<const TimeRecord> records, const IdentifyOptions& options);
};

/// All types, in the order of the contract.
const std::vector<ModelType>& model_types();
/// Null when there is none of that name.
const ModelType* find_model_type(std::string_view name);
/// Throws InputError that lists the names.
const ModelType& model_type(std::string_view name);

/// Reads a block table of model.toml; `type` names a registered model. Keys `type` and `free` are the chain's
/// own. All complaints carry file and line.
Model model_from_node(const Node& block);
/// Fills in optional parameters and checks everything; throws DesignError.
Model checked_model(std::string_view type, const Parameters& values);
/// The block's lines, `type = "…"` first, without the [[block]] header.
std::string to_toml(const Model& model);

std::unique_ptr<Operator> make_operator(const Model& model);
std::unique_ptr<Inverse> make_inverse(const Model& model);

}  // namespace bodesmith::hysteresis
