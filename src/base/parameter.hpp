#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith {

/// One parameter of a block type or a hysteresis model: its key in model.toml, its unit, what it is, and which
/// values are legal.
struct ParameterSpec {
  enum class Shape { number, list, flag, word };

  std::string name;  ///< key in model.toml
  Shape shape = Shape::number;
  /// "Hz", "s", "V", …; "u" and "y" are the units of the block's input and output, "1" is none.
  std::string unit;
  std::string what;                                       ///< one line for a person
  double min = -std::numeric_limits<double>::infinity();  ///< of every number in it
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;  ///< the value must be above `min`, not at it
  /// The numbers of a key that is left out (of a list: none). Nothing: the key is needed.
  std::optional<std::vector<double>> default_value = std::nullopt;
  std::vector<std::string> words = {};  ///< legal words of a Shape::word, the default first

  /// True when the key may be left out.
  bool optional() const { return shape == Shape::word || default_value.has_value(); }
  bool is_frequency() const { return unit == "Hz"; }

  /// What is wrong with a value ("is 3, expected at most 1"); empty when it is legal.
  std::string validate(double value) const;
  std::string validate(std::string_view word) const;

  /// The same parameter, but the key may be left out.
  ParameterSpec with_default(double value) const;
};

/// The shorthands with which types describe their parameters.
ParameterSpec any_number(std::string name, std::string unit, std::string what);
ParameterSpec above_zero(std::string name, std::string unit, std::string what);
ParameterSpec not_negative(std::string name, std::string unit, std::string what);
ParameterSpec at_least(std::string name, std::string unit, std::string what, double min);
/// min and max are legal too.
ParameterSpec between(std::string name, std::string unit, std::string what, double min, double max);
/// false when it is left out.
ParameterSpec flag(std::string name, std::string what);
/// The first of `words` when it is left out.
ParameterSpec one_word_of(std::string name, std::string what, std::vector<std::string> words);
/// A list of such numbers.
ParameterSpec list_of(ParameterSpec entry);
/// A list that may be left out, which is the same as an empty one.
ParameterSpec optional_list_of(ParameterSpec entry);

/// Null when there is none of that name.
const ParameterSpec* find_parameter(const std::vector<ParameterSpec>& specs, std::string_view name);
/// "a, b, c".
std::string names_of(const std::vector<ParameterSpec>& specs);

}  // namespace bodesmith
