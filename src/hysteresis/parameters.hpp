#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/parameter.hpp"

namespace bodesmith::hysteresis {

/// Values of the parameters of one model, by name.
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
  /// These throw std::logic_error when the parameter is absent or of another shape: completed() comes first.
  double number(std::string_view name) const;
  const std::vector<double>& list(std::string_view name) const;
  const std::string& word(std::string_view name) const;

  const std::vector<Value>& values() const { return values_; }

 private:
  Value& value(std::string_view name);
  const Value& value(std::string_view name) const;
  std::vector<Value> values_;
};

/// All parameters of `specs` in their order, with the defaults of those that are not given. Throws DesignError
/// `WHERE: …` for a missing or an unknown name, another shape and a value that is not legal.
Parameters completed(const Parameters& given, const std::vector<ParameterSpec>& specs,
                     std::string_view where);

}  // namespace bodesmith::hysteresis
