#include "hysteresis/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::hysteresis {
namespace {

using Shape = ParameterInfo::Shape;

std::string bounds_text(const ParameterInfo& info) {
  if (std::isinf(info.lower)) return fmt::format("at most {}", number_text(info.upper));
  if (std::isinf(info.upper)) return fmt::format("at least {}", number_text(info.lower));
  return fmt::format("in [{}, {}]", number_text(info.lower), number_text(info.upper));
}

const ParameterInfo* find(const std::vector<ParameterInfo>& infos, std::string_view name) {
  const auto found =
      std::find_if(infos.begin(), infos.end(), [&](const ParameterInfo& info) { return info.name == name; });
  return found == infos.end() ? nullptr : &*found;
}

/// Empty when all is well.
std::string complaint(const ParameterInfo& info, double value) {
  if (value >= info.lower && value <= info.upper && std::isfinite(value)) return {};
  return fmt::format("is {}, expected a number {}", number_text(value), bounds_text(info));
}

void set_default(Parameters& out, const ParameterInfo& info) {
  if (info.shape == Shape::word) {
    out.set(info.name, std::string_view(info.words.front()));
  } else if (info.shape == Shape::scalar) {
    out.set(info.name, info.otherwise.at(0));
  } else {
    out.set(info.name, info.otherwise);
  }
}

}  // namespace

ParameterInfo scalar(std::string name, std::string unit, std::string what, double lower, double upper) {
  ParameterInfo info;
  info.name = std::move(name);
  info.unit = std::move(unit);
  info.what = std::move(what);
  info.lower = lower;
  info.upper = upper;
  return info;
}

ParameterInfo array(std::string name, std::string unit, std::string what, double lower, double upper) {
  ParameterInfo info = scalar(std::move(name), std::move(unit), std::move(what), lower, upper);
  info.shape = Shape::array;
  return info;
}

ParameterInfo word(std::string name, std::string what, std::vector<std::string> words) {
  ParameterInfo info;
  info.name = std::move(name);
  info.shape = Shape::word;
  info.what = std::move(what);
  info.required = false;
  info.words = std::move(words);
  return info;
}

ParameterInfo optional(ParameterInfo info, std::vector<double> otherwise) {
  info.required = false;
  info.otherwise = std::move(otherwise);
  return info;
}

Parameters::Value& Parameters::value(std::string_view name) {
  for (Value& candidate : values_) {
    if (candidate.name == name) return candidate;
  }
  values_.push_back({std::string(name), {}, {}});
  return values_.back();
}

const Parameters::Value& Parameters::value(std::string_view name) const {
  for (const Value& candidate : values_) {
    if (candidate.name == name) return candidate;
  }
  throw std::logic_error(fmt::format("hysteresis parameter '{}' is not set", name));
}

Parameters& Parameters::set(std::string_view name, double number) {
  value(name).numbers = {number};
  return *this;
}

Parameters& Parameters::set(std::string_view name, std::vector<double> numbers) {
  value(name).numbers = std::move(numbers);
  return *this;
}

Parameters& Parameters::set(std::string_view name, std::string_view text) {
  value(name).word = std::string(text);
  return *this;
}

bool Parameters::has(std::string_view name) const {
  return std::any_of(values_.begin(), values_.end(), [&](const Value& v) { return v.name == name; });
}

double Parameters::scalar(std::string_view name) const {
  const Value& found = value(name);
  if (found.numbers.size() != 1)
    throw std::logic_error(fmt::format("hysteresis parameter '{}' is no scalar", name));
  return found.numbers[0];
}

const std::vector<double>& Parameters::array(std::string_view name) const {
  return value(name).numbers;
}

const std::string& Parameters::word(std::string_view name) const {
  return value(name).word;
}

Parameters parameters_from_node(const Node& node, const std::vector<ParameterInfo>& infos,
                                const std::vector<std::string>& also_allowed) {
  for (const auto& [key, member] : node.members()) {
    if (find(infos, key) == nullptr &&
        std::find(also_allowed.begin(), also_allowed.end(), key) == also_allowed.end()) {
      std::vector<std::string> names;
      for (const ParameterInfo& info : infos) names.push_back(info.name);
      member.fail(fmt::format("is not a parameter of this block, expected {}", join(names, ", ")));
    }
  }
  Parameters out;
  for (const ParameterInfo& info : infos) {
    if (!info.required && !node.has(info.name)) {
      set_default(out, info);
      continue;
    }
    const Node given = node.at(info.name);
    if (info.shape == Shape::word) {
      const std::string text = given.string();
      if (std::find(info.words.begin(), info.words.end(), text) == info.words.end()) {
        given.fail(fmt::format("is \"{}\", expected one of {}", text, join(info.words, ", ")));
      }
      out.set(info.name, std::string_view(text));
    } else if (info.shape == Shape::scalar) {
      const std::string bad = complaint(info, given.number());
      if (!bad.empty()) given.fail(bad);
      out.set(info.name, given.number());
    } else {
      const std::vector<double> numbers = given.numbers();
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::string bad = complaint(info, numbers[i]);
        if (!bad.empty()) given[i].fail(bad);
      }
      out.set(info.name, numbers);
    }
  }
  return out;
}

Parameters checked(const Parameters& given, const std::vector<ParameterInfo>& infos, std::string_view where) {
  for (const Parameters::Value& value : given.values()) {
    if (find(infos, value.name) == nullptr)
      throw DesignError(fmt::format("{}: there is no parameter '{}'", where, value.name));
  }
  Parameters out;
  for (const ParameterInfo& info : infos) {
    if (!given.has(info.name)) {
      if (info.required) throw DesignError(fmt::format("{}: parameter '{}' is missing", where, info.name));
      set_default(out, info);
      continue;
    }
    if (info.shape == Shape::word) {
      const std::string& text = given.word(info.name);
      if (std::find(info.words.begin(), info.words.end(), text) == info.words.end()) {
        throw DesignError(fmt::format("{}: {} is \"{}\", expected one of {}", where, info.name, text,
                                      join(info.words, ", ")));
      }
      out.set(info.name, std::string_view(text));
      continue;
    }
    const std::vector<double>& numbers = given.array(info.name);
    if (info.shape == Shape::scalar && numbers.size() != 1)
      throw DesignError(fmt::format("{}: {} has {} numbers, expected one", where, info.name, numbers.size()));
    for (const double number : numbers) {
      const std::string bad = complaint(info, number);
      if (!bad.empty()) throw DesignError(fmt::format("{}: {} {}", where, info.name, bad));
    }
    out.set(info.name, numbers);
  }
  return out;
}

std::string to_toml(const Parameters& parameters, const std::vector<ParameterInfo>& infos) {
  std::string out;
  for (const ParameterInfo& info : infos) {
    if (!parameters.has(info.name)) continue;
    if (info.shape == Shape::word) {
      out += fmt::format("{} = \"{}\"\n", info.name, parameters.word(info.name));
    } else if (info.shape == Shape::scalar) {
      out += fmt::format("{} = {}\n", info.name, number_text(parameters.scalar(info.name)));
    } else {
      std::string line = info.name + " = [";
      const std::vector<double>& numbers = parameters.array(info.name);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::string piece = number_text(numbers[i]) + (i + 1 < numbers.size() ? ", " : "");
        if (line.size() + piece.size() > 118) {
          out += std::string(trim(line)) + "\n";
          line = "  ";
        }
        line += piece;
      }
      out += line + "]\n";
    }
  }
  return out;
}

}  // namespace bodesmith::hysteresis
