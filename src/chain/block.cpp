#include "chain/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "base/text.hpp"

namespace bodesmith::chain {
namespace {

[[noreturn]] void unknown(std::string_view type, std::string_view key) {
  throw std::logic_error(fmt::format("block '{}' has no parameter '{}'", type, key));
}

/// "gains[2]" -> {"gains", 2}; {name, -1} without an index.
std::pair<std::string_view, int> split_name(std::string_view name) {
  const size_t bracket = name.find('[');
  double index = 0.0;
  if (bracket == std::string_view::npos || name.back() != ']' ||
      !parse_number(name.substr(bracket + 1, name.size() - bracket - 2), index) || !(index >= 0.0)) {
    return {name, -1};
  }
  return {name.substr(0, bracket), static_cast<int>(index)};
}

Parameter parameter_of(const ParameterSpec& spec, int element, double value) {
  Parameter out;
  out.key = spec.name;
  out.element = element;
  out.value = value;
  out.low = spec.low;
  out.high = spec.high;
  out.low_excluded = spec.low_excluded;
  return out;
}

}  // namespace

std::string Parameter::name() const {
  return element < 0 ? key : fmt::format("{}[{}]", key, element);
}

std::string Parameter::unit() const {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kUnits = {
      {{"_per_s", "1/s"},
       {"_rad_s", "rad/s"},
       {"_hz", "Hz"},
       {"_s", "s"},
       {"_v", "V"},
       {"_db", "dB"},
       {"_deg", "deg"},
       {"_ohm", "ohm"}}};
  for (const auto& [ending, unit] : kUnits) {
    if (key.ends_with(ending)) return std::string(unit);
  }
  return {};
}

Block::Block(const BlockType& type) : type_(&type) {
  for (const ParameterSpec& spec : type.specs()) {
    if (spec.shape == ParameterSpec::Shape::word) {
      words_.emplace_back(spec.name, spec.words.empty() ? std::string() : spec.words.front());
    } else if (spec.shape != ParameterSpec::Shape::list) {
      parameters_.push_back(parameter_of(spec, -1, spec.standard.value_or(0.0)));
    }
  }
}

const ParameterSpec* Block::spec(std::string_view key) const {
  for (const ParameterSpec& spec : type_->specs()) {
    if (spec.name == key) return &spec;
  }
  return nullptr;
}

double Block::get(std::string_view key) const {
  for (const Parameter& p : parameters_) {
    if (p.element < 0 && p.key == key) return p.value;
  }
  unknown(type_name(), key);
}

bool Block::has(std::string_view key) const {
  return spec(key) != nullptr;
}

std::vector<double> Block::list(std::string_view key) const {
  if (spec(key) == nullptr) unknown(type_name(), key);
  std::vector<double> out;
  for (const Parameter& p : parameters_) {
    if (p.element >= 0 && p.key == key) out.push_back(p.value);
  }
  return out;
}

Block& Block::set(std::string_view name, double value) {
  const auto [key, element] = split_name(name);
  for (Parameter& p : parameters_) {
    if (p.key == key && p.element == element) {
      p.value = value;
      return *this;
    }
  }
  unknown(type_name(), name);
}

Block& Block::set(std::string_view key, const std::vector<double>& values) {
  const ParameterSpec* wanted = spec(key);
  if (wanted == nullptr || wanted->shape != ParameterSpec::Shape::list) unknown(type_name(), key);
  std::erase_if(parameters_, [&](const Parameter& p) { return p.key == key; });
  // Lists keep the order of the specs, so that free parameters do not depend on the order of the file.
  size_t at = 0;
  for (const ParameterSpec& s : type_->specs()) {
    if (&s == wanted) break;
    while (at < parameters_.size() && parameters_[at].key == s.name) ++at;
  }
  std::vector<Parameter> entries;
  for (size_t i = 0; i < values.size(); ++i)
    entries.push_back(parameter_of(*wanted, static_cast<int>(i), values[i]));
  parameters_.insert(parameters_.begin() + static_cast<std::ptrdiff_t>(at), entries.begin(), entries.end());
  return *this;
}

const std::string& Block::word(std::string_view key) const {
  for (const auto& [name, value] : words_) {
    if (name == key) return value;
  }
  unknown(type_name(), key);
}

Block& Block::set_word(std::string_view key, std::string value) {
  for (auto& [name, old] : words_) {
    if (name == key) {
      old = std::move(value);
      return *this;
    }
  }
  unknown(type_name(), key);
}

bool Block::free(std::string_view name) {
  const auto [key, element] = split_name(name);
  bool found = false;
  for (Parameter& p : parameters_) {
    if (p.key == key && (element < 0 || p.element == element)) p.free = found = true;
  }
  return found;
}

std::string Block::complaint() const {
  for (const Parameter& p : parameters_) {
    if (!std::isfinite(p.value)) return fmt::format("{} is not a finite number", p.name());
    const bool too_low = p.low_excluded ? !(p.value > p.low) : p.value < p.low;
    if (!too_low && p.value <= p.high) continue;
    const std::string above =
        std::isfinite(p.low)
            ? fmt::format("{} {}", p.low_excluded ? "above" : "at least", rounded_text(p.low))
            : "";
    const std::string below = std::isfinite(p.high) ? fmt::format("at most {}", rounded_text(p.high)) : "";
    return fmt::format("{} is {}, expected {}{}{}", p.name(), rounded_text(p.value), above,
                       above.empty() || below.empty() ? "" : " and ", below);
  }
  return type_->complaint(*this);
}

}  // namespace bodesmith::chain
