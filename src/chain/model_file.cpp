#include "chain/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"

namespace bodesmith::chain {
namespace {

void read_parameter(Block& block, const ParameterSpec& spec, const Node& node) {
  switch (spec.shape) {
    case ParameterSpec::Shape::number:
      block.set(spec.name, node.number());
      break;
    case ParameterSpec::Shape::flag:
      block.set(spec.name, node.kind() == Node::Kind::number ? static_cast<double>(node.integer(0, 1))
                           : node.boolean()                  ? 1.0
                                                             : 0.0);
      break;
    case ParameterSpec::Shape::list:
      block.set(spec.name, node.numbers());
      break;
    case ParameterSpec::Shape::word: {
      const std::string word = node.string();
      if (const std::string error = spec.validate(word); !error.empty()) node.fail(error);
      block.set_word(spec.name, word);
      break;
    }
  }
}

std::vector<std::string> list_of_names(const std::vector<ParameterSpec>& specs) {
  std::vector<std::string> out;
  for (const ParameterSpec& spec : specs) out.push_back(spec.name);
  return out;
}

void read_free(Block& block, const Node& free) {
  if (free.kind() == Node::Kind::string) free.fail("is one word, expected a list of parameter names");
  for (const Node& item : free.items()) {
    const std::string name = item.string();
    if (!block.free(name)) {
      item.fail(fmt::format("'{}' is not a numeric parameter of this '{}' block{}, expected one of {}", name,
                            block.type_name(), did_you_mean(name, list_of_names(block.type().specs())),
                            names_of(block.type().specs())));
    }
  }
}

std::vector<double> quadratic_from(const Node& node) {
  std::vector<double> out = node.numbers();
  if (out.size() != 3) node.fail("has not three numbers, expected those of 1, s/w and (s/w)^2");
  return out;
}

/// `parts`: a table a part, {unit, tolerance, "parameter" = [slope, bend], …}; of an op-amp {gain_bandwidth_hz,
/// noise_gain = [d0, d1, d2]}, and feedthrough = [f0, f1, f2] where something passes without it.
std::shared_ptr<const std::vector<PartChange>> parts_from_node(const Block& block, const Node& node) {
  auto out = std::make_shared<std::vector<PartChange>>();
  for (const auto& [part, table] : node.members()) {
    if (table.has("noise_gain")) {
      table.allow_only({"noise_gain", "feedthrough", "gain_bandwidth_hz"});
      PartChange opamp{.part = part};
      opamp.noise_gain = quadratic_from(table.at("noise_gain"));
      if (table.has("feedthrough")) {
        opamp.feedthrough = quadratic_from(table.at("feedthrough"));
        if (block.type_name() != "biquad") table.at("feedthrough").fail("stands at no biquad, expected one");
      }
      opamp.gain_bandwidth_hz = table.at("gain_bandwidth_hz").positive();
      out->push_back(std::move(opamp));
      continue;
    }
    PartChange one{part, table.at("unit").one_of({"percent", "v"}), table.at("tolerance").non_negative()};
    for (const auto& [name, value] : table.members()) {
      if (name == "unit" || name == "tolerance") continue;
      const auto& all = block.parameters();
      if (std::ranges::none_of(all, [&, &key = name](const Parameter& p) { return p.name() == key; }))
        value.fail(fmt::format("is no parameter of this '{}' block", block.type_name()));
      const std::vector<double> numbers = value.numbers();
      if (numbers.size() != 2) value.fail("is no pair, expected [slope, bend]");
      one.entries.push_back({name, numbers[0], numbers[1]});
    }
    out->push_back(std::move(one));
  }
  return out;
}

/// At the parameter's own line where the error is about one.
[[noreturn]] void fail_at(const Node& node, const std::string& type, const ValidationError& error) {
  if (error.parameter != nullptr && node.has(error.parameter->key())) {
    const Node at = node.at(error.parameter->key());
    (error.parameter->element >= 0 ? at[static_cast<std::size_t>(error.parameter->element)] : at)
        .fail(error.message);
  }
  node.fail(fmt::format("block '{}': {}", type, error.text()));
}

constexpr std::size_t kMaxLine = 118;

/// `key = [a, b, …]`, broken over lines; without the key.
std::string toml_list(const std::string& key, const std::vector<double>& values) {
  std::string out;
  std::string line = key + " = [";
  const std::size_t start = key.size() + 3;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string piece = number_text(values[i]) + (i + 1 < values.size() ? ", " : "");
    if (line.size() + piece.size() > kMaxLine) {
      out += std::string(trim(line)) + "\n";
      line = "  ";
    }
    line += piece;
  }
  return (out + line + "]").substr(start);
}

/// The values of one key as they stand in a TOML file.
std::string toml_value(const Block& block, const ParameterSpec& spec) {
  switch (spec.shape) {
    case ParameterSpec::Shape::number:
      return number_text(block.get(spec.name));
    case ParameterSpec::Shape::flag:
      return block.flag(spec.name) ? "true" : "false";
    case ParameterSpec::Shape::word:
      return "\"" + block.word(spec.name) + "\"";
    case ParameterSpec::Shape::list:
      break;
  }
  return toml_list(spec.name, block.list(spec.name));
}

/// Whole keys where every entry is free, single entries otherwise.
std::vector<std::string> free_names(const Block& block) {
  std::vector<std::string> out;
  const auto& all = block.parameters();
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    while (end < all.size() && all[end].key() == all[i].key()) ++end;
    const bool whole = std::all_of(all.begin() + static_cast<std::ptrdiff_t>(i),
                                   all.begin() + static_cast<std::ptrdiff_t>(end),
                                   [](const Parameter& p) { return p.free; });
    for (std::size_t j = i; j < end; ++j) {
      if (whole) {
        if (j == i) out.push_back(all[j].key());
      } else if (all[j].free) {
        out.push_back(all[j].name());
      }
    }
    i = end;
  }
  return out;
}

Json parts_json(const std::vector<PartChange>& parts) {
  Json values = Json::array();
  for (const PartChange& one : parts) {
    std::string text =
        one.noise_gain.empty()
            ? fmt::format("{{unit = \"{}\", tolerance = {}", one.unit, number_text(one.tolerance))
            : fmt::format("{{gain_bandwidth_hz = {}, noise_gain = {}", number_text(one.gain_bandwidth_hz),
                          toml_list("noise_gain", one.noise_gain));
    if (!one.feedthrough.empty()) text += ", feedthrough = " + toml_list("feedthrough", one.feedthrough);
    for (const PartChange::Entry& entry : one.entries)
      text += fmt::format(", \"{}\" = [{}, {}]", entry.parameter, number_text(entry.slope),
                          number_text(entry.bend));
    values.push_back({{"part", "\"" + one.part + "\""}, {"change", text + "}"}});
  }
  const bool opamps = std::ranges::any_of(parts, [](const auto& p) { return !p.noise_gain.empty(); });
  return {{"values", values}, {"opamps", opamps}};
}

struct TrainedKey {
  const char* key;
  double SignalExtent::*of_input;
  double Trained::*direct;
};
constexpr TrainedKey kTrainedKeys[] = {
    {"input_lower", &SignalExtent::lower, nullptr},
    {"input_upper", &SignalExtent::upper, nullptr},
    {"input_max_rate_per_s", &SignalExtent::max_rate_per_s, nullptr},
    {"input_from_hz", &SignalExtent::from_hz, nullptr},
    {"input_to_hz", &SignalExtent::to_hz, nullptr},
    {"output_lower", nullptr, &Trained::output_lower},
    {"output_upper", nullptr, &Trained::output_upper},
    {"training_rms", nullptr, &Trained::training_rms},
    {"training_percent_of_range", nullptr, &Trained::training_percent},
};

Trained trained_from_node(const Node& node) {
  node.allow_only({"input_lower", "input_upper", "input_max_rate_per_s", "input_from_hz", "input_to_hz",
                   "output_lower", "output_upper", "training_rms", "training_percent_of_range", "holdout_rms",
                   "holdout_percent_of_range"});
  Trained out;
  for (const TrainedKey& one : kTrainedKeys)
    (one.direct == nullptr ? out.input.*one.of_input : out.*one.direct) = node.at(one.key).number();
  if (node.has("holdout_rms")) out.holdout_rms = node.at("holdout_rms").non_negative();
  if (node.has("holdout_percent_of_range"))
    out.holdout_percent = node.at("holdout_percent_of_range").non_negative();
  return out;
}

Json trained_json(const Trained& trained) {
  Json values = Json::array();
  const auto add = [&](const char* key, double value) {
    values.push_back({{"key", key}, {"value", number_text(value)}});
  };
  for (const TrainedKey& one : kTrainedKeys)
    add(one.key, one.direct == nullptr ? trained.input.*one.of_input : trained.*one.direct);
  if (trained.holdout_rms) add("holdout_rms", *trained.holdout_rms);
  if (trained.holdout_percent) add("holdout_percent_of_range", *trained.holdout_percent);
  return {{"values", values}};
}

}  // namespace

Block block_from_node(const Node& node) {
  const Node type_node = node.at("type");
  const BlockType* type = block_type_registry().find(type_node.string());
  if (type == nullptr)
    type_node.fail(fmt::format("is '{}'{}, expected one of {}", type_node.string(),
                               did_you_mean(type_node.string(), block_type_registry().name_list()),
                               block_type_registry().names()));
  Block block(*type);
  block.line = node.line();
  const auto& specs = type->specs();
  for (const auto& [key, value] : node.members()) {
    if (key == "type" || key == "free" || key == "parts") continue;
    if (key == "name") {
      block.part = value.string();
      if (block.part.find_first_of("\"\\\n\r\t") != std::string::npos)
        value.fail("has a quotation mark, backslash or line break, expected a plain name");
      continue;
    }
    const ParameterSpec* spec = find_parameter(specs, key);
    if (spec == nullptr)
      value.fail(fmt::format("is not a parameter of '{}'{}, expected one of {}", type->name(),
                             did_you_mean(key, list_of_names(specs)), names_of(specs)));
    read_parameter(block, *spec, value);
  }
  for (const ParameterSpec& spec : specs) {
    if (!spec.optional()) node.at(spec.name);
  }
  if (node.has("free")) read_free(block, node.at("free"));
  if (node.has("parts")) block.parts = parts_from_node(block, node.at("parts"));
  if (const auto error = block.validate()) fail_at(node, type->name(), *error);
  return block;
}

Chain model_from_node(const Node& node) {
  node.expect_schema("model");
  node.allow_only({"schema", "block", "name", "about", "start", "trained"});
  Chain chain;
  if (node.has("start")) chain.start = one_of(node.at("start"), Start::zero, Start::equilibrium);
  if (node.has("trained")) chain.trained = trained_from_node(node.at("trained"));
  for (const Node& item : node.at("block").items()) chain.blocks.push_back(block_from_node(item));
  return chain;
}

Chain read_model(const std::filesystem::path& path, Provenance& from) {
  const Node node = read_document(path, from);
  if (node.kind() == Node::Kind::object && node.string_or("schema", "") == "bodesmith.sections/1")
    return chain_of(Sections::from_node(node));
  return model_from_node(node);
}

namespace {
/// What is not finite does not read back.
void check_finite(const Chain& chain) {
  for (std::size_t i = 0; i < chain.blocks.size(); ++i) {
    for (const Parameter& p : chain.blocks[i].parameters()) {
      if (!std::isfinite(p.value))
        throw InputError(fmt::format(
            "{} is not a finite number: records whose numbers double precision cannot hold", chain.label(p)));
    }
  }
}
}  // namespace

std::vector<std::string> needed_trained_keys() {
  std::vector<std::string> out;
  for (const TrainedKey& one : kTrainedKeys) out.emplace_back(one.key);
  return out;
}

std::string model_text(const Chain& chain, const std::string& comment) {
  check_finite(chain);
  Json data;
  data["comment"] = Json::array();
  if (!comment.empty()) {
    for (const std::string_view line : split(comment, '\n'))
      data["comment"].push_back({{"line", std::string(line)}});
  }
  data["start"] = Json::array();
  if (chain.start) data["start"].push_back({{"word", std::string(to_string(*chain.start))}});
  data["trained"] = Json::array();
  if (chain.trained) data["trained"].push_back(trained_json(*chain.trained));
  data["blocks"] = Json::array();
  for (const Block& block : chain.blocks) {
    Json out = {{"type", block.type_name()}, {"parameters", Json::array()}};
    if (!block.part.empty())
      out["parameters"].push_back({{"key", "name"}, {"value", "\"" + block.part + "\""}});
    for (const ParameterSpec& spec : block.type().specs()) {
      out["parameters"].push_back({{"key", spec.name}, {"value", toml_value(block, spec)}});
    }
    std::vector<std::string> quoted;
    for (const std::string& name : free_names(block)) quoted.push_back("\"" + name + "\"");
    if (!quoted.empty())
      out["parameters"].push_back({{"key", "free"}, {"value", "[" + join(quoted, ", ") + "]"}});
    out["parts"] = Json::array();
    if (block.parts) out["parts"].push_back(parts_json(*block.parts));
    data["blocks"].push_back(std::move(out));
  }
  return render_template("model.toml", data);
}

}  // namespace bodesmith::chain
