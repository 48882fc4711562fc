#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>

#include <string>

#include "base/documents/document_tree.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith {
namespace {

using Data = Node::Data;

std::shared_ptr<Data> convert(const toml::node& node, const std::shared_ptr<const std::string>& file) {
  auto data = std::make_shared<Data>();
  data->file = file;
  data->line = static_cast<int>(node.source().begin.line);
  if (const auto* table = node.as_table()) {
    data->kind = Node::Kind::object;
    for (const auto& [key, value] : *table)
      data->members.emplace_back(std::string(key.str()), convert(value, file));
    // toml++ sorts by name; a person wrote them by line.
    std::ranges::stable_sort(data->members,
                             [](const auto& a, const auto& b) { return a.second->line < b.second->line; });
  } else if (const auto* array = node.as_array()) {
    data->kind = Node::Kind::array;
    for (const auto& value : *array) data->items.push_back(convert(value, file));
  } else if (const auto* text = node.as_string()) {
    data->kind = Node::Kind::string;
    data->string = text->get();
  } else if (const auto* real = node.as_floating_point()) {
    data->kind = Node::Kind::number;
    data->number = real->get();
  } else if (const auto* whole = node.as_integer()) {
    data->kind = Node::Kind::number;
    data->number = static_cast<double>(whole->get());
  } else if (const auto* flag = node.as_boolean()) {
    data->kind = Node::Kind::boolean;
    data->boolean = flag->get();
  } else {
    throw InputError(*file, data->line,
                     "dates and times are not used here, expected a number, string or table");
  }
  return data;
}

/// Keys with very many dots would nest as deep; the parser and its trees go down one call a level.
void require_shallow_keys(std::string_view text, const std::string& file) {
  constexpr int kDeepest = 200;
  int line = 1;
  int dots = 0;  // since the key can have begun
  char quote = 0;
  bool tripled = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    const bool three = (c == '"' || c == '\'') && text.substr(i, 3) == std::string(3, c);
    if (quote != 0) {
      if (c == '\\' && quote == '"') {
        ++i;
      } else if (c == quote && (!tripled || three)) {
        if (tripled) i += 2;
        quote = 0;
      } else if (c == '\n' && !tripled) {
        quote = 0;  // broken: the parser says so
      }
    } else if (c == '"' || c == '\'') {
      quote = c;
      tripled = three;
      if (three) i += 2;
    } else if (c == '#') {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (c == '.') {
      if (++dots >= kDeepest)
        throw InputError(file, line, fmt::format("has a key of more than {} parts", kDeepest));
    } else if (!is_letter_or_digit(c) && c != '_' && c != '-' && c != ' ' && c != '\t') {
      dots = 0;
    }
  }
}

}  // namespace

Node parse_toml(std::string_view text, const std::string& file) {
  require_utf8(text, file);
  require_shallow_keys(text, file);
  const auto name = std::make_shared<const std::string>(file);
  try {
    const toml::table table = toml::parse(text, std::string_view(file));
    auto root = convert(table, name);
    root->line = 0;
    return Node(root, "");
  } catch (const toml::parse_error& error) {
    throw InputError(file, static_cast<int>(error.source().begin.line),
                     fmt::format("not valid TOML: {}", error.description()));
  }
}

}  // namespace bodesmith
