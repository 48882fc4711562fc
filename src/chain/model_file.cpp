#include "chain/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "chain/registry.hpp"

namespace bodesmith::chain {
namespace {

std::string names_of_types() {
  std::vector<std::string> names;
  for (const BlockType* type : block_types()) names.emplace_back(type->name());
  return join(names, ", ");
}

std::string names_of(const std::vector<ParameterSpec>& specs) {
  std::vector<std::string> names;
  for (const ParameterSpec& spec : specs) names.push_back(spec.name);
  return join(names, ", ");
}

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
      if (std::find(spec.words.begin(), spec.words.end(), word) == spec.words.end()) {
        node.fail(fmt::format("is '{}', expected one of {}", word, join(spec.words, ", ")));
      }
      block.set_word(spec.name, word);
      break;
    }
  }
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
  std::string out = "[";
  size_t column = 0;
  bool first = true;
  for (const double value : block.list(spec.name)) {
    const std::string text = number_text(value);
    if (!first) out += ", ";
    if (!first && column + text.size() > 100) {
      out += "\n  ";
      column = 0;
    }
    out += text;
    column += text.size() + 2;
    first = false;
  }
  return out + "]";
}

/// Whole keys where every entry is free, single entries otherwise.
std::vector<std::string> free_names(const Block& block) {
  std::vector<std::string> out;
  const auto& all = block.parameters();
  for (size_t i = 0; i < all.size();) {
    size_t end = i;
    while (end < all.size() && all[end].key == all[i].key) ++end;
    const bool whole = std::all_of(all.begin() + static_cast<std::ptrdiff_t>(i),
                                   all.begin() + static_cast<std::ptrdiff_t>(end),
                                   [](const Parameter& p) { return p.free; });
    for (size_t j = i; j < end; ++j) {
      if (whole) {
        if (j == i) out.push_back(all[j].key);
      } else if (all[j].free) {
        out.push_back(all[j].name());
      }
    }
    i = end;
  }
  return out;
}

bool stands_in_file(const Block& block, const ParameterSpec& spec) {
  return !(spec.optional_list && block.list(spec.name).empty());
}

}  // namespace

Block block_from_node(const Node& node) {
  const Node type_node = node.at("type");
  const BlockType* type = find_block_type(type_node.string());
  if (type == nullptr)
    type_node.fail(fmt::format("is '{}', expected one of {}", type_node.string(), names_of_types()));
  Block block(*type);
  block.line = node.line();
  const auto& specs = type->specs();
  for (const auto& [key, value] : node.members()) {
    if (key == "type" || key == "free") continue;
    const auto spec =
        std::find_if(specs.begin(), specs.end(), [&](const ParameterSpec& s) { return s.name == key; });
    if (spec == specs.end()) {
      value.fail(
          fmt::format("is not a parameter of '{}', expected one of {}", type->name(), names_of(specs)));
    }
    read_parameter(block, *spec, value);
  }
  for (const ParameterSpec& spec : specs) {
    const bool may_be_absent =
        spec.standard || spec.optional_list || spec.shape == ParameterSpec::Shape::word;
    if (!may_be_absent) node.at(spec.name);
  }
  if (node.has("free")) {
    const Node free = node.at("free");
    if (free.kind() == Node::Kind::string) free.fail("is one word, expected a list of parameter names");
    for (const Node& item : free.items()) {
      const std::string name = item.string();
      if (!block.free(name)) {
        item.fail(fmt::format("'{}' is not a numeric parameter of this '{}' block, expected one of {}", name,
                              type->name(), names_of(specs)));
      }
    }
  }
  if (const std::string complaint = block.complaint(); !complaint.empty()) {
    // The parameter's own line where the complaint is about one.
    for (const Parameter& p : block.parameters()) {
      if (node.has(p.key) && complaint.starts_with(p.name() + " ")) {
        const Node at = node.at(p.key);
        (p.element >= 0 ? at[static_cast<size_t>(p.element)] : at)
            .fail(complaint.substr(p.name().size() + 1));
      }
    }
    node.fail(fmt::format("block '{}': {}", type->name(), complaint));
  }
  return block;
}

Chain model_from_node(const Node& node) {
  node.expect_schema("model");
  node.allow_only({"schema", "block", "name", "about"});
  Chain chain;
  for (const Node& item : node.at("block").items()) chain.blocks.push_back(block_from_node(item));
  return chain;
}

Chain read_model(const std::filesystem::path& path, Provenance& from) {
  return model_from_node(read_document(path, from));
}

std::string model_text(const Chain& chain, const std::string& comment) {
  Json data;
  data["comment"] = Json::array();
  if (!comment.empty()) {
    for (const std::string_view line : split(comment, '\n'))
      data["comment"].push_back({{"line", std::string(line)}});
  }
  data["blocks"] = Json::array();
  for (const Block& block : chain.blocks) {
    Json out;
    out["type"] = std::string(block.type_name());
    out["parameters"] = Json::array();
    for (const ParameterSpec& spec : block.type().specs()) {
      if (stands_in_file(block, spec))
        out["parameters"].push_back({{"key", spec.name}, {"value", toml_value(block, spec)}});
    }
    const auto names = free_names(block);
    out["has_free"] = !names.empty();
    std::vector<std::string> quoted;
    for (const std::string& name : names) quoted.push_back("\"" + name + "\"");
    out["free"] = join(quoted, ", ");
    data["blocks"].push_back(std::move(out));
  }
  return render_template("model.toml", data);
}

Json model_json(const Chain& chain) {
  Json out;
  out["blocks"] = Json::array();
  for (const Block& block : chain.blocks) {
    Json item;
    item["type"] = std::string(block.type_name());
    for (const ParameterSpec& spec : block.type().specs()) {
      if (!stands_in_file(block, spec)) continue;
      switch (spec.shape) {
        case ParameterSpec::Shape::number:
          item[spec.name] = block.get(spec.name);
          break;
        case ParameterSpec::Shape::flag:
          item[spec.name] = block.flag(spec.name);
          break;
        case ParameterSpec::Shape::list:
          item[spec.name] = block.list(spec.name);
          break;
        case ParameterSpec::Shape::word:
          item[spec.name] = block.word(spec.name);
          break;
      }
    }
    if (const auto names = free_names(block); !names.empty()) item["free"] = names;
    out["blocks"].push_back(std::move(item));
  }
  return out;
}

}  // namespace bodesmith::chain
