#include "project/sweep/variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/text.hpp"

namespace bodesmith::project {
namespace {

constexpr std::size_t kMostVariants = 10000;
constexpr std::size_t kLongestName = 100;
constexpr std::size_t kLongestKey = 200;  ///< longer than any of a project

std::string value_text(const Node& node) {
  switch (node.kind()) {
    case Node::Kind::boolean:
      return node.boolean() ? "true" : "false";
    case Node::Kind::number:
      return rounded_text(node.number(), 12);
    case Node::Kind::string:
      return node.string();
    case Node::Kind::array: {
      std::vector<std::string> items;
      for (const Node& item : node.items()) items.push_back(value_text(item));
      return "[" + join(items, ", ") + "]";
    }
    default:
      return "";
  }
}

/// The leaves of a table, with dotted keys: a table in the project is changed member by member.
void flatten(const Node& table, const std::string& below, std::vector<std::pair<std::string, Node>>& out) {
  for (const auto& [key, value] : table.members()) {
    const std::string place = below.empty() ? key : below + "." + key;
    if (value.kind() == Node::Kind::object) {
      flatten(value, place, out);
    } else {
      out.emplace_back(place, value);
    }
  }
}

[[noreturn]] void refuse_name(const Variant& variant) {
  variant.at.fail(fmt::format(
      "has the name '{}', expected letters, digits, spaces and -_.=+% ({} at most), as its folder is called so",
      variant.name, kLongestName));
}

/// A folder of this name stands in the output folder and nowhere else.
void check_name(const Variant& variant) {
  const auto fits = [](char c) {
    return is_letter_or_digit(c) || c == '-' || c == '_' || c == '.' || c == '=' || c == '+' || c == '%' ||
           c == ' ';
  };
  const std::string& name = variant.name;
  if (name.empty() || name.size() > kLongestName || name.front() == '.' || name.front() == ' ' ||
      name.back() == ' ' || !std::ranges::all_of(name, fits)) {
    refuse_name(variant);
  }
}

Variant read_variant(const Node& node) {
  node.allow_only({"name", "set", "remove"});
  Variant out(node.at("name").string(), node);
  if (node.has("set")) flatten(node.at("set"), "", out.set);
  if (node.has("remove")) {
    for (const Node& key : node.at("remove").items()) out.removed.emplace_back(key.string(), key);
  }
  return out;
}

/// A value as part of a folder's name.
std::string name_part(const Node& value) {
  std::string text = value_text(value);
  std::erase_if(text, [](unsigned char c) { return c == '[' || c == ']'; });
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c == ',' || c == '/' || c == ' '; }, '_');
  return text;
}

/// All combinations: the last key changes fastest.
std::vector<Variant> read_grid(const Node& grid) {
  std::vector<Variant> out = {Variant("", grid)};
  for (const auto& [key, values] : grid.members()) {
    if (values.kind() != Node::Kind::array || values.size() == 0)
      values.fail("is no list of values, expected [first, second, …]; keys with dots stand in quotes here");
    if (key.size() > kLongestKey)
      grid.fail(fmt::format("has a key of {} letters, longer than any of a project", key.size()));
    if (out.size() * values.size() > kMostVariants)
      grid.fail(fmt::format("makes more than {} designs", kMostVariants));
    std::vector<Variant> wider;
    for (const Variant& one : out) {
      for (const Node& value : values.items()) {
        Variant next = one;
        next.set.emplace_back(key, value);
        next.name += (next.name.empty() ? "" : "+") + key.substr(key.rfind('.') + 1) + "=" + name_part(value);
        // At once: ten thousand endless names are more than a machine holds.
        if (next.name.size() > kLongestName) refuse_name(next);
        wider.push_back(std::move(next));
      }
    }
    out = std::move(wider);
  }
  return out;
}

}  // namespace

std::string Variant::what() const {
  std::vector<std::string> parts;
  for (const auto& [key, value] : set) parts.push_back(key + " = " + value_text(value));
  for (const auto& [key, value] : removed) parts.push_back(key + " removed");
  return parts.empty() ? "the project as it is" : join(parts, ", ");
}

std::string Variant::value_of(const std::string& key) const {
  for (const auto& [changed, value] : set) {
    if (changed == key) return value_text(value);
  }
  for (const auto& [changed, value] : removed) {
    if (changed == key) return "removed";
  }
  return "";
}

std::vector<Variant> read_variants(const std::filesystem::path& file, Provenance& from) {
  const Node document = read_document(file, from);
  document.expect_schema("variants");
  document.allow_only({"schema", "variant", "grid"});
  std::vector<Variant> out;
  if (document.has("variant")) {
    for (const Node& node : document.at("variant").items()) out.push_back(read_variant(node));
  }
  if (document.has("grid")) {
    for (Variant& one : read_grid(document.at("grid"))) out.push_back(std::move(one));
  }
  if (out.empty()) document.fail("has no design, expected [[variant]] tables or a [grid]");
  std::set<std::string> names;
  for (const Variant& variant : out) {
    check_name(variant);
    if (!names.insert(variant.name).second)
      variant.at.fail(fmt::format("has the name '{}' of an earlier one", variant.name));
  }
  return out;
}

ProjectSource with_variant(const ProjectSource& project, const Variant& variant) {
  ProjectSource out = project;
  for (const auto& [key, at] : variant.removed) out.document = out.document.without(key, at);
  for (const auto& [key, value] : variant.set) out.document = out.document.with(key, value);
  return out;
}

}  // namespace bodesmith::project
