#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/documents/document.hpp"
#include "base/documents/document_tree.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"

namespace bodesmith {
namespace {

std::string_view kind_name(Node::Kind kind) {
  constexpr std::array kWords = {"null", "a boolean", "a number", "a string", "an array", "an object"};
  return kWords.at(static_cast<std::size_t>(kind));
}

void expect(const Node& node, Node::Kind kind) {
  if (node.kind() == kind) return;
  node.fail(fmt::format("is {}, expected {}", kind_name(node.kind()), kind_name(kind)));
}

std::vector<std::string> words_of(std::initializer_list<std::string_view> words) {
  return {words.begin(), words.end()};
}

/// "$schema" at the top names the JSON Schema for editors (schemas/); it says nothing to this program.
bool names_schema(const std::string& place, std::string_view key) {
  return place.empty() && key == "$schema";
}

std::string member_place(const std::string& place, std::string_view key) {
  return place.empty() ? std::string(key) : place + "." + std::string(key);
}

}  // namespace

Node::Kind Node::kind() const {
  return data_->kind;
}
int Node::line() const {
  return data_->line;
}
const std::string& Node::file() const {
  return *data_->file;
}

void Node::fail(std::string_view message) const {
  throw InputError(file(), line(),
                   place_.empty() ? std::string(message) : fmt::format("'{}' {}", place_, message));
}

bool Node::has(std::string_view key) const {
  expect(*this, Kind::object);
  for (const auto& [name, value] : data_->members) {
    if (name == key) return true;
  }
  return false;
}

Node Node::at(std::string_view key) const {
  expect(*this, Kind::object);
  for (const auto& [name, value] : data_->members) {
    if (name == key) return Node(value, member_place(place_, key));
  }
  // A key that differs in one letter is likely the missing one.
  for (const auto& [name, value] : data_->members) {
    if (key.size() > 3 && edit_distance(name, key) == 1)
      throw InputError(
          file(), value->line,
          fmt::format("'{}' is missing (did you mean it by '{}'?)", member_place(place_, key), name));
  }
  throw InputError(file(), line(), fmt::format("'{}' is missing", member_place(place_, key)));
}

std::size_t Node::size() const {
  if (data_->kind == Kind::object) return data_->members.size();
  expect(*this, Kind::array);
  return data_->items.size();
}

Node Node::operator[](std::size_t index) const {
  expect(*this, Kind::array);
  if (index >= data_->items.size())
    fail(fmt::format("has {} items, expected at least {}", size(), index + 1));
  return Node(data_->items[index], fmt::format("{}[{}]", place_, index));
}

std::vector<std::pair<std::string, Node>> Node::members() const {
  expect(*this, Kind::object);
  std::vector<std::pair<std::string, Node>> out;
  for (const auto& [name, value] : data_->members)
    out.emplace_back(name, Node(value, member_place(place_, name)));
  return out;
}

std::vector<Node> Node::items() const {
  expect(*this, Kind::array);
  std::vector<Node> out;
  for (std::size_t i = 0; i < data_->items.size(); ++i) out.push_back((*this)[i]);
  return out;
}

bool Node::boolean() const {
  expect(*this, Kind::boolean);
  return data_->boolean;
}

std::string Node::text() const {
  expect(*this, Kind::string);
  return data_->string;
}

std::string Node::string() const {
  expect(*this, Kind::string);
  // Names and words end up in netlists, C sources and pages, where a second line would be a statement of its own.
  const auto control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  if (std::ranges::any_of(data_->string, control))
    fail("holds a line break or another control character, expected one line of text");
  return data_->string;
}

double Node::number() const {
  // "4k7" is a number that a person typed; "12" in quotes is a slip.
  double typed = 0.0;
  double plain = 0.0;
  if (kind() == Kind::string && !parse_number(data_->string, plain) && parse_quantity(data_->string, typed))
    return typed;
  expect(*this, Kind::number);
  if (!std::isfinite(data_->number)) fail("is not finite, expected a finite number");
  return data_->number;
}

double Node::positive() const {
  const double value = number();
  if (!above_zero(value))
    fail(fmt::format("is {}, expected a number above {}", rounded_text(value, 6),
                     value > 0.0 ? "2.3e-308" : "0"));
  return value;
}

double Node::non_negative() const {
  const double value = number();
  if (value < 0.0) fail(fmt::format("is {}, expected a number of at least 0", rounded_text(value, 6)));
  return value;
}

long Node::integer(long min, long max) const {
  const double value = number();
  if (value != std::floor(value) || value < static_cast<double>(min) || value > static_cast<double>(max)) {
    fail(fmt::format("is {}, expected a whole number from {} to {}", rounded_text(value, 6), min, max));
  }
  return static_cast<long>(value);
}

std::vector<double> Node::numbers() const {
  std::vector<double> out;
  for (const Node& item : items()) out.push_back(item.number());
  return out;
}

double Node::number_or(std::string_view key, double default_value) const {
  return has(key) ? at(key).number() : default_value;
}
std::string Node::string_or(std::string_view key, std::string default_value) const {
  return has(key) ? at(key).string() : default_value;
}
bool Node::boolean_or(std::string_view key, bool default_value) const {
  return has(key) ? at(key).boolean() : default_value;
}

std::string Node::one_of(std::initializer_list<std::string_view> words) const {
  const std::string value = string();
  for (const std::string_view word : words) {
    if (value == word) return value;
  }
  fail(fmt::format("is \"{}\"{}, expected one of: {}", value, did_you_mean(value, words_of(words)),
                   fmt::join(words, ", ")));
}

void Node::allow_only(std::initializer_list<std::string_view> keys) const {
  for (const auto& [name, value] : members()) {
    bool known = false;
    for (const std::string_view key : keys) known = known || key == name;
    if (known || names_schema(place_, name)) continue;
    value.fail(fmt::format("is not known here{}, expected one of: {}", did_you_mean(name, words_of(keys)),
                           fmt::join(keys, ", ")));
  }
}

void Node::expect_schema(std::string_view name) const {
  if (kind() != Kind::object) {
    fail(fmt::format("the document is {}, expected a bodesmith.{}/1 object", kind_name(kind()), name));
  }
  const std::string wanted = fmt::format("bodesmith.{}/1", name);
  if (!has("schema")) fail(fmt::format("'schema' is missing, expected \"{}\"", wanted));
  const Node schema = at("schema");
  if (schema.string() != wanted)
    schema.fail(fmt::format("is \"{}\", expected \"{}\"", schema.string(), wanted));
}

void require_utf8(std::string_view text, const std::string& file) {
  const auto begins = [&](std::string_view mark) { return text.substr(0, mark.size()) == mark; };
  using namespace std::string_view_literals;
  std::string_view found;
  if (begins("\xFF\xFE\0\0"sv) || begins("\0\0\xFE\xFF"sv)) {
    found = "UTF-32";
  } else if (begins("\xFF\xFE"sv) || begins("\xFE\xFF"sv)) {
    found = "UTF-16";
  } else if (text.size() >= 4 && (text[0] == 0) != (text[1] == 0) && (text[2] == 0) != (text[3] == 0)) {
    found = "UTF-16";  // without a mark: Latin letters have one byte that is 0
  }
  if (!found.empty()) throw InputError(file, 0, fmt::format("is {}, expected UTF-8", found));
}

Node read_document(const std::filesystem::path& path, Provenance& from) {
  const std::string text = from.read(path);
  const bool other = path.extension() != ".json" && path.extension() != ".toml";
  const bool toml = path.extension() == ".toml" || (other && !trim(text).starts_with('{'));
  return toml ? parse_toml(text, path.string()) : parse_json(text, path.string());
}

namespace {

using Branch = std::shared_ptr<const Node::Data>;

/// `at` with `value` under the dotted `key`; without that member when `value` is null. `blame` is where the change
/// stands, which new tables are said to stand in.
Branch changed(const Branch& at, std::string_view key, const Branch& value, const Branch& blame) {
  const auto copy = at ? std::make_shared<Node::Data>(*at) : std::make_shared<Node::Data>();
  if (!at) {
    copy->kind = Node::Kind::object;
    copy->line = blame->line;
    copy->file = blame->file;
  }
  const std::size_t dot = key.find('.');
  const std::string head(key.substr(0, dot));
  if (copy->kind != Node::Kind::object || head.empty())
    throw InputError(
        *blame->file, blame->line,
        "'" + std::string(key) + "' is no place in the document, expected a key of a table in it");
  auto member = copy->members.begin();
  while (member != copy->members.end() && member->first != head) ++member;
  const Branch old = member == copy->members.end() ? nullptr : member->second;
  if (!old && !value)
    throw InputError(*blame->file, blame->line,
                     "'" + head + "' is not in the document, so cannot be removed");
  const Branch put = dot == std::string_view::npos ? value : changed(old, key.substr(dot + 1), value, blame);
  if (!put) {
    copy->members.erase(member);
  } else if (old) {
    member->second = put;
  } else {
    copy->members.emplace_back(head, put);
  }
  return copy;
}

}  // namespace

Node Node::with(std::string_view key, const Node& value) const {
  return Node(changed(data_, key, value.data_, value.data_), place_);
}

Node Node::without(std::string_view key, const Node& blame) const {
  return Node(changed(data_, key, nullptr, blame.data_), place_);
}

}  // namespace bodesmith
