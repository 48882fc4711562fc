#pragma once

#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "base/document.hpp"

namespace bodesmith::hysteresis {

/// What a model type says about one of its parameters: the key in model.toml, its unit and legal values.
struct ParameterInfo {
  enum class Shape { scalar, array, word };

  std::string name;  ///< the paper's symbol; the key of the block
  Shape shape = Shape::scalar;
  std::string
      unit;  ///< "u", "y", "y/u", "1", "s", "Hz", …: u and y are the units of the block's input and output
  std::string what;
  double lower = -std::numeric_limits<double>::infinity();  ///< of every number in it
  double upper = std::numeric_limits<double>::infinity();
  bool required = true;
  std::vector<double> otherwise;   ///< numbers of an optional parameter that is not given
  std::vector<std::string> words;  ///< legal words; the first one is the default
};

/// Shorthands for the lists in the model files.
ParameterInfo scalar(std::string name, std::string unit, std::string what,
                     double lower = -std::numeric_limits<double>::infinity(),
                     double upper = std::numeric_limits<double>::infinity());
ParameterInfo array(std::string name, std::string unit, std::string what,
                    double lower = -std::numeric_limits<double>::infinity(),
                    double upper = std::numeric_limits<double>::infinity());
ParameterInfo word(std::string name, std::string what, std::vector<std::string> words);
/// The same parameter, but it may be left out.
ParameterInfo optional(ParameterInfo info, std::vector<double> otherwise);

/// Values of the parameters of one model, in the order of its ParameterInfo list.
class Parameters {
 public:
  struct Value {
    std::string name;
    std::vector<double> numbers;
    std::string word;
  };

  Parameters() = default;
  /// Sets or replaces.
  Parameters& set(std::string_view name, double value);
  Parameters& set(std::string_view name, std::vector<double> values);
  Parameters& set(std::string_view name, std::string_view word);
  Parameters& set(std::string_view name, const char* word) { return set(name, std::string_view(word)); }

  bool has(std::string_view name) const;
  /// These throw std::logic_error when the parameter is absent or of another shape: checked() comes first.
  double scalar(std::string_view name) const;
  const std::vector<double>& array(std::string_view name) const;
  const std::string& word(std::string_view name) const;

  const std::vector<Value>& values() const { return values_; }

 private:
  Value& value(std::string_view name);
  const Value& value(std::string_view name) const;
  std::vector<Value> values_;
};

/// Reads a table, refusing unknown keys except `also_allowed`, missing ones, wrong shapes and bounds, with
/// file and line.
Parameters parameters_from_node(const Node& node, const std::vector<ParameterInfo>& infos,
                                const std::vector<std::string>& also_allowed);
/// Fills in what is optional and checks bounds; throws DesignError `WHERE: …`.
Parameters checked(const Parameters& given, const std::vector<ParameterInfo>& infos, std::string_view where);
/// `name = value` lines; long arrays are broken over lines.
std::string to_toml(const Parameters& parameters, const std::vector<ParameterInfo>& infos);

}  // namespace bodesmith::hysteresis
