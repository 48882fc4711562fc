#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/documents/json_fwd.hpp"

namespace bodesmith {
class Node;
}

namespace bodesmith::fpaa {

/// The values of a CAM's parameters as its dialog has them: what is typed in, or what the capacitors make of
/// it. In the dialog's order; a key ends in its unit ("pole_hz", "scale_per_v"; gains have none). The CAMs
/// themselves work with types of their own (PoleZeroSpec, …) and turn them into this and back; everybody else
/// only lists them.
class CamValues {
 public:
  struct Entry {
    std::string key;
    std::variant<double, std::string> value;  ///< a number, or a word ("low Q")

    /// Nothing for a word.
    std::optional<double> number() const;
  };

  CamValues() = default;
  CamValues(std::initializer_list<Entry> entries) : entries_(entries) {}

  /// Replaces the value of a key that is there, otherwise appends.
  void set(std::string key, std::variant<double, std::string> value);

  const std::vector<Entry>& entries() const { return entries_; }
  /// Nothing when the key is absent or its value is a word.
  std::optional<double> number(std::string_view key) const;
  /// Throws InputError that names the key when it is absent or a word.
  double required_number(std::string_view key) const;
  /// Empty when the key is absent or its value is a number.
  std::string_view text(std::string_view key) const;

  /// The object of a file: key -> value.
  Json to_json() const;
  static CamValues from_node(const Node& node);

 private:
  const Entry* find(std::string_view key) const;
  std::vector<Entry> entries_;
};

}  // namespace bodesmith::fpaa
