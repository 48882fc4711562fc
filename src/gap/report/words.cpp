#include "gap/report/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/text.hpp"
#include "gap/report/figures.hpp"

namespace bodesmith::gap {
namespace {

/// Names of banks of parameters, numbered in brackets.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kBanks = {
    {{"w[", "weight "},
     {"v[", "slope weight "},
     {"gains[", "creep gain "},
     {"time_constants_s[", "time constant "}}};

/// Ends of names that are units; the longer ones first.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kUnits = {
    {{"_per_s", "1/s"}, {"_rad_s", "rad/s"}, {"_deg", "degrees"}, {"_hz", "Hz"}, {"_s", "s"}, {"_v", "V"}}};

bool is_of_bank(const std::string& name) {
  return name.ends_with(']');
}

/// The name without its number in brackets, and its unit.
std::pair<std::string, std::string_view> name_and_unit(const std::string& name) {
  const std::string stem = name.substr(0, name.find('['));
  for (const auto& [end, unit] : kUnits) {
    if (stem.ends_with(end)) return {stem.substr(0, stem.size() - end.size()), unit};
  }
  return {stem, {}};
}

std::string range_text(const FoundParameter& p) {
  return fmt::format("{} {} ({} to {})", parameter_words(p.name), parameter_text(p.name, p.value),
                     parameter_text(p.name, p.low), parameter_text(p.name, p.high));
}

/// "corner 60 Hz (59 Hz to 61 Hz)"; "8 parameters, 6 of them weights above zero".
std::string values_in_words(const std::vector<FoundParameter>& parameters) {
  const auto weights =
      std::count_if(parameters.begin(), parameters.end(), [](const auto& p) { return is_of_bank(p.name); });
  if (weights == 0) {
    std::vector<std::string> values;
    for (const auto& p : parameters) values.push_back(range_text(p));
    return join(values, ", ");
  }
  const auto used = std::count_if(parameters.begin(), parameters.end(),
                                  [](const auto& p) { return is_of_bank(p.name) && p.value != 0.0; });
  return fmt::format("{} parameters, {} of them weights, of which {} not zero; their values stand below",
                     parameters.size(), weights, used);
}

}  // namespace

std::string parameter_words(const std::string& name) {
  for (const auto& [start, words] : kBanks) {
    if (name.starts_with(start))
      return std::string(words) + name.substr(start.size(), name.size() - start.size() - 1);
  }
  std::string words = name_and_unit(name).first;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string parameter_text(const std::string& name, double value) {
  const std::string_view unit = name_and_unit(name).second;
  if (unit.empty()) return figure_text(value);
  if (unit.find('/') != std::string_view::npos || unit == "degrees")
    return fmt::format("{} {}", figure_text(value), unit);
  return engineering_text(value, unit, 4);
}

std::string step_in_words(const DiagnosedStep& s) {
  std::string text =
      fmt::format("{} ({}): {}.", s.effect, s.placed, effect_registry().get(s.effect).facts().what);
  if (!s.parameters.empty()) {
    std::string values = values_in_words(s.parameters);
    values.front() = upper_case(values.front());
    text += " " + values + ".";
  }
  if (!s.tied_with.empty())
    text += fmt::format(" These records cannot tell it from {}.", join(s.tied_with, ", "));
  return text;
}

std::string rms_unit_sentence(const Diagnosis& d) {
  if (d.relative)
    return "Every rms of this page is relative: of H_model/H_measured - 1, real and imaginary part together, in percent.";
  return "Every rms of this page is in the unit of the records' y.";
}

std::string rms_text(const Diagnosis& d, double rms) {
  return d.relative ? figure_text(100.0 * rms) + " %" : figure_text(rms);
}

}  // namespace bodesmith::gap
