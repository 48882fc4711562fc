#include "chain/model_file.hpp"

#include <cmath>

#include "base/documents/json.hpp"
#include "chain/chain.hpp"
#include "chain/registry.hpp"

namespace bodesmith::chain {
namespace {

/// A number, or one as people write it ("4k7", base/text.hpp).
Json quantity_definition() {
  return {{"description", "a number, or a text such as \"4k7\", \"10n\" or \"13.2 kHz\""},
          {"anyOf", {{{"type", "number"}}, {{"type", "string"}, {"pattern", "^[-+0-9.].*[^-+0-9.].*$"}}}}};
}

Json number_schema(const ParameterSpec& spec) {
  Json out = {{"$ref", "#/$defs/quantity"}};
  if (std::isfinite(spec.min)) out[spec.min_excluded ? "exclusiveMinimum" : "minimum"] = spec.min;
  if (std::isfinite(spec.max)) out["maximum"] = spec.max;
  return out;
}

std::string description_of(const ParameterSpec& spec) {
  return spec.unit.empty() || spec.unit == "1" ? spec.what : spec.what + " [" + spec.unit + "]";
}

Json parameter_schema(const ParameterSpec& spec) {
  Json out;
  switch (spec.shape) {
    case ParameterSpec::Shape::number:
      out = number_schema(spec);
      break;
    case ParameterSpec::Shape::flag:
      out = {{"enum", {false, true, 0, 1}}};
      break;
    case ParameterSpec::Shape::list:
      out = {{"type", "array"}, {"items", number_schema(spec)}};
      break;
    case ParameterSpec::Shape::word:
      out = {{"enum", spec.words}};
      break;
  }
  out["description"] = description_of(spec);
  if (spec.shape == ParameterSpec::Shape::number && spec.default_value)
    out["default"] = spec.default_value->front();
  return out;
}

Json block_schema(const BlockType& type) {
  Json properties = {{"type", {{"const", type.name()}}}};
  Json required = {"type"};
  for (const ParameterSpec& spec : type.specs()) {
    properties[spec.name] = parameter_schema(spec);
    if (!spec.optional()) required.push_back(spec.name);
  }
  properties["free"] = {{"$ref", "#/$defs/free"}};
  properties["parts"] = {{"$ref", "#/$defs/parts"}};
  properties["name"] = {{"type", "string"}, {"description", "of the part that the block stands for"}};
  return {{"title", type.name()},     {"description", type.what()}, {"type", "object"},
          {"properties", properties}, {"required", required},       {"additionalProperties", false}};
}

Json trained_schema() {
  Json properties = Json::object();
  Json required = Json::array();
  for (const std::string& key : needed_trained_keys()) {
    properties[key] = {{"type", "number"}};
    required.push_back(key);
  }
  for (const char* key : {"holdout_rms", "holdout_percent_of_range"})
    properties[key] = {{"type", "number"}, {"minimum", 0}};
  return {{"description", "what the model was fitted to; beyond it nothing was compared"},
          {"type", "object"},
          {"properties", properties},
          {"required", required},
          {"additionalProperties", false}};
}

Json parts_schema() {
  const Json pair = {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 2}, {"maxItems", 2}};
  const Json part = {
      {"type", "object"},
      {"properties",
       {{"unit", {{"enum", {"percent", "v"}}, {"description", "of t"}}},
        {"tolerance", {{"type", "number"}, {"minimum", 0}, {"description", "of a good part"}}}}},
      {"required", {"unit", "tolerance"}},
      {"additionalProperties", pair}};
  const auto three = [](const char* what) {
    return Json{{"type", "array"},
                {"items", {{"type", "number"}}},
                {"minItems", 3},
                {"maxItems", 3},
                {"description", what}};
  };
  const Json opamp = {
      {"type", "object"},
      {"properties",
       {{"gain_bandwidth_hz",
         {{"type", "number"}, {"exclusiveMinimum", 0}, {"description", "that the block's parameters hold"}}},
        {"noise_gain",
         three("[d0, d1, d2]: 1/beta = (d0 + d1 s/w + d2 (s/w)^2) over the section's denominator")},
        {"feedthrough",
         three(
             "[f0, f1, f2]: of the response without the op-amp, over d0 + d1 s/w + d2 (s/w)^2; of a biquad")}}},
      {"required", {"gain_bandwidth_hz", "noise_gain"}},
      {"additionalProperties", false}};
  return {
      {"description",
       "what each part that is t off does to the block's parameters p: [slope, bend] of p + slope t/(1 + bend t)"},
      {"type", "object"},
      {"additionalProperties", {{"anyOf", {part, opamp}}}}};
}

}  // namespace

Json model_schema() {
  Json blocks = Json::array();
  for (const BlockType* type : block_type_registry().all()) blocks.push_back(block_schema(*type));
  Json out;
  out["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  out["$id"] = "model.schema.json";
  out["title"] = "bodesmith.model/1";
  out["description"] = "A model: blocks in series, input first (model.toml).";
  out["type"] = "object";
  out["properties"] = {
      {"$schema", {{"type", "string"}}},
      {"schema", {{"const", "bodesmith.model/1"}}},
      {"name", {{"description", "for people"}}},
      {"about", {{"description", "for people"}}},
      {"start",
       {{"enum", {"zero", "equilibrium"}},
        {"description", "before the first sample: every state zero, or at rest under the first input"},
        {"default", "zero"}}},
      {"trained", trained_schema()},
      {"block", {{"type", "array"}, {"items", {{"$ref", "#/$defs/block"}}}}}};
  out["required"] = {"schema", "block"};
  out["additionalProperties"] = false;
  out["$defs"] = {
      {"quantity", quantity_definition()},
      {"free",
       {{"description",
         "parameters that identify and diagnose may refit: \"gain\", or one of a list \"gains[2]\""},
        {"type", "array"},
        {"items", {{"type", "string"}}}}},
      {"parts", parts_schema()},
      {"block", {{"oneOf", blocks}}}};
  return out;
}

}  // namespace bodesmith::chain
