#include "chain/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/text.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

[[noreturn]] void unknown(std::string_view type, std::string_view key) {
  throw std::logic_error(fmt::format("block '{}' has no parameter '{}'", type, key));
}

/// "gains[2]" -> {"gains", 2}; {name, -1} without an index.
std::pair<std::string_view, int> split_name(std::string_view name) {
  const std::size_t bracket = name.find('[');
  double index = 0.0;
  if (bracket == std::string_view::npos || name.back() != ']' ||
      !parse_number(name.substr(bracket + 1, name.size() - bracket - 2), index) || !(index >= 0.0)) {
    return {name, -1};
  }
  return {name.substr(0, bracket), static_cast<int>(index)};
}

}  // namespace

std::string Parameter::name() const {
  return element < 0 ? key() : fmt::format("{}[{}]", key(), element);
}

std::optional<FoundInput> BlockType::inverse(const Block& block, const WantedOutput& wanted) const {
  Kernel kernel = block.kernel();
  if (const auto* linear = std::get_if<LinearKernel>(&kernel)) {
    if (linear->order() == 0 && linear->d == 0.0) return std::nullopt;
    return inverse_of(*linear, wanted);
  }
  if (const auto* source = std::get_if<std::unique_ptr<SourceKernel>>(&kernel))
    return inverse_of(**source, wanted);
  if (const auto* sampled = std::get_if<std::unique_ptr<SampledKernel>>(&kernel))
    return inverse_of(**sampled, wanted);
  return std::nullopt;
}

std::optional<FoundInput> Block::inverse(const WantedOutput& wanted) const {
  return type_->inverse(*this, wanted);
}

Block::Block(const BlockType& type) : type_(&type) {
  for (const ParameterSpec& spec : type.specs()) {
    if (spec.shape == ParameterSpec::Shape::word) {
      words_.emplace_back(spec.name, spec.words.front());
    } else if (spec.shape != ParameterSpec::Shape::list) {
      parameters_.push_back({&spec, -1, spec.default_value ? spec.default_value->front() : 0.0});
    }
  }
}

double Block::get(std::string_view key) const {
  for (const Parameter& p : parameters_) {
    if (p.element < 0 && p.key() == key) return p.value;
  }
  unknown(type_name(), key);
}

bool Block::has(std::string_view key) const {
  return find_parameter(type_->specs(), key) != nullptr;
}

std::vector<double> Block::list(std::string_view key) const {
  if (!has(key)) unknown(type_name(), key);
  std::vector<double> out;
  for (const Parameter& p : parameters_) {
    if (p.element >= 0 && p.key() == key) out.push_back(p.value);
  }
  return out;
}

Block& Block::set(std::string_view name, double value) {
  const auto [key, element] = split_name(name);
  for (Parameter& p : parameters_) {
    if (p.key() == key && p.element == element) {
      p.value = value;
      return *this;
    }
  }
  unknown(type_name(), name);
}

Block& Block::set(std::string_view key, const std::vector<double>& values) {
  const ParameterSpec* list_spec = find_parameter(type_->specs(), key);
  if (list_spec == nullptr || list_spec->shape != ParameterSpec::Shape::list) unknown(type_name(), key);
  std::erase_if(parameters_, [&](const Parameter& p) { return p.key() == key; });
  // Lists keep the order of the specs, so that free parameters do not depend on the order of the file.
  std::size_t at = 0;
  for (const ParameterSpec& s : type_->specs()) {
    if (&s == list_spec) break;
    while (at < parameters_.size() && parameters_[at].key() == s.name) ++at;
  }
  std::vector<Parameter> entries;
  for (std::size_t i = 0; i < values.size(); ++i)
    entries.push_back({list_spec, static_cast<int>(i), values[i]});
  parameters_.insert(parameters_.begin() + static_cast<std::ptrdiff_t>(at), entries.begin(), entries.end());
  return *this;
}

Block Block::with(const PartChange& change, double departure) const {
  Block out = *this;
  for (const PartChange::Entry& entry : change.entries) {
    for (Parameter& p : out.parameters_) {
      if (p.name() == entry.parameter) p.value += entry.of(departure);
    }
  }
  return out;
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
    if (p.key() == key && (element < 0 || p.element == element)) p.free = found = true;
  }
  return found;
}

std::optional<ValidationError> Block::validate() const {
  for (const Parameter& p : parameters_) {
    if (std::string error = p.spec->validate(p.value); !error.empty())
      return ValidationError{&p, std::move(error)};
  }
  std::string error = type_->validate(*this);
  if (error.empty()) return std::nullopt;
  for (const Parameter& p : parameters_) {
    const std::string start = p.name() + " ";
    if (error.starts_with(start)) return ValidationError{&p, error.substr(start.size())};
  }
  return ValidationError{nullptr, std::move(error)};
}

namespace {

/// Departures of opposite signs that move a parameter to one side by more than this share of the rest: no bilinear form.
constexpr double kOneSided = 0.5;

}  // namespace

void PartChange::add(std::string parameter, double departure, double above, double below) {
  Entry out{std::move(parameter), (above - below) / (2.0 * departure), 0.0};
  if (out.slope == 0.0) return;
  if (std::abs(above + below) < kOneSided * std::abs(above - below)) {
    out.slope = 2.0 / (departure * (1.0 / above - 1.0 / below));
    out.bend = 0.5 * out.slope * (1.0 / above + 1.0 / below);
  }
  entries.push_back(std::move(out));
}

void PartChange::add_differences(const Block& block, double departure, const Block& above,
                                 const Block& below) {
  constexpr double kRounding = 1e-9;  // of the parameter
  for (std::size_t k = 0; k < block.parameters().size(); ++k) {
    const Parameter& at = block.parameters()[k];
    const double up = above.parameters()[k].value - at.value;
    const double down = below.parameters()[k].value - at.value;
    if (std::max(std::abs(up), std::abs(down)) > kRounding * (1.0 + std::abs(at.value)))
      add(at.name(), departure, up, down);
  }
}

}  // namespace bodesmith::chain
