#include "base/parameter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "base/whole_number.hpp"

namespace bodesmith {
namespace {

std::string bounds_text(const ParameterSpec& spec) {
  std::vector<std::string> parts;
  if (std::isfinite(spec.min))
    parts.push_back(fmt::format("{} {}", spec.min_excluded ? "above" : "at least", rounded_text(spec.min)));
  if (std::isfinite(spec.max)) parts.push_back(fmt::format("at most {}", rounded_text(spec.max)));
  return join(parts, " and ");
}

}  // namespace

std::string ParameterSpec::validate(double value) const {
  if (!std::isfinite(value)) return "is not a finite number";
  const bool too_low = min_excluded ? !(value > min) : value < min;
  if (!too_low && value <= max) {
    // Above 0 means that it may stand below a fraction line.
    if (min_excluded && min == 0.0 && !above_zero(value))
      return fmt::format("is {}, expected a number above 2.3e-308", rounded_text(value));
    return {};
  }
  return fmt::format("is {}, expected {}", rounded_text(value), bounds_text(*this));
}

std::string ParameterSpec::validate(std::string_view word) const {
  if (std::ranges::find(words, word) != words.end()) return {};
  return fmt::format("is '{}'{}, expected one of {}", word, did_you_mean(word, words), join(words, ", "));
}

ParameterSpec ParameterSpec::with_default(double value) const {
  ParameterSpec out = *this;
  out.default_value = {value};
  return out;
}

ParameterSpec any_number(std::string name, std::string unit, std::string what) {
  return {.name = std::move(name), .unit = std::move(unit), .what = std::move(what)};
}

ParameterSpec above_zero(std::string name, std::string unit, std::string what) {
  ParameterSpec out = not_negative(std::move(name), std::move(unit), std::move(what));
  out.min_excluded = true;
  return out;
}

ParameterSpec not_negative(std::string name, std::string unit, std::string what) {
  return at_least(std::move(name), std::move(unit), std::move(what), 0.0);
}

ParameterSpec at_least(std::string name, std::string unit, std::string what, double min) {
  ParameterSpec out = any_number(std::move(name), std::move(unit), std::move(what));
  out.min = min;
  return out;
}

ParameterSpec between(std::string name, std::string unit, std::string what, double min, double max) {
  ParameterSpec out = any_number(std::move(name), std::move(unit), std::move(what));
  out.min = min;
  out.max = max;
  return out;
}

ParameterSpec flag(std::string name, std::string what) {
  ParameterSpec out = between(std::move(name), "1", std::move(what), 0.0, 1.0).with_default(0.0);
  out.shape = ParameterSpec::Shape::flag;
  return out;
}

ParameterSpec one_word_of(std::string name, std::string what, std::vector<std::string> words) {
  ParameterSpec out = any_number(std::move(name), "1", std::move(what));
  out.shape = ParameterSpec::Shape::word;
  out.words = std::move(words);
  return out;
}

ParameterSpec list_of(ParameterSpec entry) {
  entry.shape = ParameterSpec::Shape::list;
  return entry;
}

ParameterSpec optional_list_of(ParameterSpec entry) {
  entry.shape = ParameterSpec::Shape::list;
  entry.default_value.emplace();
  return entry;
}

const ParameterSpec* find_parameter(const std::vector<ParameterSpec>& specs, std::string_view name) {
  const auto found = std::ranges::find(specs, name, &ParameterSpec::name);
  return found == specs.end() ? nullptr : &*found;
}

std::string names_of(const std::vector<ParameterSpec>& specs) {
  std::vector<std::string> names;
  for (const ParameterSpec& spec : specs) names.push_back(spec.name);
  return join(names, ", ");
}

}  // namespace bodesmith
