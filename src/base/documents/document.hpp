#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/provenance.hpp"

namespace bodesmith {

/// One value of a JSON or TOML document, knowing the file and line it stands in, so that every error
/// about it can name both. Copies share the tree. Every accessor throws InputError with file and line when
/// the value is not what the caller needs; the message says where in the document ("terms[2].beta") and what
/// was expected.
class Node {
 public:
  enum class Kind { null, boolean, number, string, array, object };

  Kind kind() const;
  int line() const;
  /// Path of the file as the user gave it.
  const std::string& file() const;
  /// Place in the document, e.g. "terms[2].beta"; empty at the top.
  const std::string& place() const { return place_; }

  bool has(std::string_view key) const;
  /// The member, or an error that names the missing key.
  Node at(std::string_view key) const;
  /// Number of array items or object members.
  std::size_t size() const;
  Node operator[](std::size_t index) const;
  /// Members in the order of the file.
  std::vector<std::pair<std::string, Node>> members() const;
  std::vector<Node> items() const;

  bool boolean() const;
  /// One line without control characters.
  std::string string() const;
  /// Any text.
  std::string text() const;
  /// A finite number.
  double number() const;
  double positive() const;
  double non_negative() const;
  /// A whole number in [min, max].
  long integer(long min, long max) const;
  std::vector<double> numbers() const;

  double number_or(std::string_view key, double default_value) const;
  std::string string_or(std::string_view key, std::string default_value) const;
  bool boolean_or(std::string_view key, bool default_value) const;

  /// One of the given words, or an error that lists them.
  std::string one_of(std::initializer_list<std::string_view> words) const;
  /// Refuses members that are not in the list (a misspelt key would otherwise do nothing).
  void allow_only(std::initializer_list<std::string_view> keys) const;
  /// A copy in which `value` stands under the dotted `key` ("hardware.circuit.resistors"), in tables that are made where
  /// they are missing. Errors about it name the file and line that it came from.
  Node with(std::string_view key, const Node& value) const;
  /// A copy without that member; what is not there is an error at `blame`.
  Node without(std::string_view key, const Node& blame) const;

  /// Refuses a document whose "schema" is not `bodesmith.NAME/1`.
  void expect_schema(std::string_view name) const;

  /// Throws InputError at this node's file and line.
  [[noreturn]] void fail(std::string_view message) const;

  struct Data;  // the shared tree, private to document_node.cpp
  Node(std::shared_ptr<const Data> data, std::string place)
      : data_(std::move(data)), place_(std::move(place)) {}

 private:
  std::shared_ptr<const Data> data_;
  std::string place_;
};

/// Parse errors are InputErrors with file and line. `file` is the name to show.
Node parse_json(std::string_view text, const std::string& file);
Node parse_toml(std::string_view text, const std::string& file);

/// Reads by extension (.toml, .json; another: JSON where it begins with a brace) and remembers the file in `from`.
Node read_document(const std::filesystem::path& path, Provenance& from);

/// The one of these values whose to_string() the node holds, or an error that lists them.
template <class Enum, class... Enums>
Enum one_of(const Node& node, Enum first, Enums... others) {
  const std::string word = node.one_of({to_string(first), to_string(others)...});
  Enum found = first;
  ((to_string(others) == word ? void(found = others) : void()), ...);
  return found;
}

}  // namespace bodesmith
