#include "signal/formats/headings.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <string_view>

#include "base/letters.hpp"
#include "base/text.hpp"

namespace bodesmith::formats {
namespace {

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

/// The last text in brackets; what stands before them into `rest`.
std::string bracketed(const std::string& text, std::string& rest) {
  for (const char* pair : {"()", "[]"}) {
    const std::size_t close = text.rfind(pair[1]);
    const std::size_t open = close == std::string::npos ? close : text.rfind(pair[0], close);
    if (open == std::string::npos || open == 0) continue;
    // V(out) is a name, not a unit.
    const std::string before(trim(std::string_view(text).substr(0, open)));
    if (open > 0 && text[open - 1] != ' ' && (lower_case(before) == "v" || lower_case(before) == "i"))
      continue;
    rest = before;
    return std::string(trim(std::string_view(text).substr(open + 1, close - open - 1)));
  }
  rest = text;
  // "f/Hz", "Gain dB"
  const std::size_t end = text.find_last_of("/ ");
  if (end != std::string::npos && end > 0 && is_unit_alone(text.substr(end + 1))) {
    rest = std::string(trim(std::string_view(text).substr(0, end)));
    return text.substr(end + 1);
  }
  return "";
}

struct Prefix {
  std::string_view text;
  double scale;
};
constexpr Prefix kPrefixes[] = {{"G", 1e9},  {"M", 1e6},  {"k", 1e3},         {"K", 1e3},  {"m", 1e-3},
                                {"u", 1e-6}, {"µ", 1e-6}, {"\xCE\xBC", 1e-6}, {"n", 1e-9}, {"p", 1e-12}};

/// Scale of `unit` in `base` ("kHz" in "Hz": 1e3); nothing for another unit. Prefixes are by case: mHz is not MHz.
std::optional<double> scale_of(std::string_view unit, std::string_view base) {
  if (lower_case(unit) == lower_case(base)) return 1.0;
  for (const Prefix& prefix : kPrefixes) {
    if (unit.starts_with(prefix.text) && lower_case(unit.substr(prefix.text.size())) == lower_case(base))
      return prefix.scale;
  }
  return std::nullopt;
}

std::optional<double> frequency_scale(std::string_view unit) {
  // All small or all large letters: nobody means millihertz then.
  const std::string low = lower_case(unit);
  if (low == "mhz" && unit != "mHz") return 1e6;
  if (low == "ghz") return 1e9;
  if (low == "khz") return 1e3;
  return scale_of(unit, "Hz");
}

std::optional<double> time_scale(std::string_view unit) {
  for (const char* base : {"s", "sec", "second", "seconds"}) {
    if (const auto scale = scale_of(unit, base)) return scale;
  }
  return std::nullopt;
}

bool is_radians(const std::string& unit) {
  return unit == "rad" || unit == "radian" || unit == "radians";
}

bool begins_with_word(const std::string& text, std::string_view word) {
  if (!text.starts_with(word)) return false;
  return text.size() == word.size() || !is_letter(text[word.size()]);
}

bool is_frequency(const std::string& name, const Heading& heading) {
  if (name.starts_with("freq") || name == "f" || name == "hz" || name == "frequenz") return true;
  return !heading.unit.empty() && frequency_scale(heading.unit).has_value() && !contains(name, "gain");
}

void read_magnitude(Heading& heading, const std::string& name, const std::string& unit) {
  heading.quantity = Quantity::magnitude;
  const bool decibel = unit.starts_with("db") || contains(name, "db") || contains(name, "spl");
  if (decibel) heading.magnitude = MagnitudeScale::decibel;
  if (decibel) return;
  for (const char* base : {"V", "A", "ohm", "ohms", "\xCE\xA9", "\xE2\x84\xA6", "V/V", "X"}) {
    if (const auto scale = scale_of(heading.unit, base)) {
      heading.magnitude = MagnitudeScale::linear;
      heading.scale = *scale;
    }
  }
  if (unit == "1" || unit == "lin" || unit == "linear" || contains(name, "linear"))
    heading.magnitude = MagnitudeScale::linear;
}

/// "TR1: Gain (Real)", "TR2: Gain (Degree)": what stands in brackets is a part of a complex number and no unit.
std::optional<Quantity> part_in_brackets(const std::string& unit) {
  if (unit == "real" || unit == "re") return Quantity::real;
  if (unit == "imag" || unit == "imaginary" || unit == "im") return Quantity::imaginary;
  if (unit == "degree" || unit == "degrees" || unit == "deg" || is_radians(unit)) return Quantity::phase;
  if (unit == "absolut" || unit == "absolute" || unit == "abs") return Quantity::magnitude;
  return std::nullopt;
}

}  // namespace

Heading parse_heading(const std::string& text) {
  Heading heading;
  heading.text = std::string(trim(text));
  std::string rest;
  heading.unit = bracketed(heading.text, rest);
  std::string name = lower_case(trim(rest));
  // frequency_hz, time_s, phase_deg: units at the end of the name.
  if (heading.unit.empty()) {
    const std::size_t bar = name.rfind('_');
    if (bar != std::string::npos && bar > 0 && is_unit_alone(rest.substr(bar + 1))) {
      heading.unit = rest.substr(bar + 1);
      name = name.substr(0, bar);
    }
  }
  if (heading.unit.empty() && frequency_scale(heading.text)) {
    heading.unit = heading.text;
    name = "hz";
  }
  const std::string unit = lower_case(heading.unit);
  if (const auto part = part_in_brackets(unit)) {
    heading.quantity = *part;
    if (is_radians(unit)) heading.scale = 180.0 / std::numbers::pi;
    if (*part == Quantity::magnitude) heading.magnitude = MagnitudeScale::linear;
    return heading;
  }
  if (name == "freq." || is_frequency(name, heading)) {
    heading.quantity = Quantity::frequency;
    const auto scale = frequency_scale(heading.unit);
    heading.scale = scale.value_or(1.0);
    if (unit == "rad/s" || unit == "rad/sec") {
      heading.quantity = Quantity::angular_frequency;
    } else if (!scale && !heading.unit.empty()) {
      heading.unit_known = false;
    }
    return heading;
  }
  if (name == "w" || name == "omega" || name == "\xCF\x89" || unit == "rad/s") {
    heading.quantity = Quantity::angular_frequency;
    return heading;
  }
  if (begins_with_word(name, "time") || name == "t" || name == "zeit" || name == "second" ||
      name == "seconds" || (time_scale(heading.unit) && name == "x-axis")) {
    heading.quantity = Quantity::time;
    heading.scale = time_scale(heading.unit).value_or(1.0);
    heading.unit_known = heading.unit.empty() || time_scale(heading.unit).has_value();
    if (heading.unit.empty() && name.starts_with("second")) heading.unit = "s";
    return heading;
  }
  if (contains(name, "phase") || contains(name, "angle") || name == "arg" || name == "deg") {
    heading.quantity = Quantity::phase;
    if (is_radians(unit)) heading.scale = 180.0 / std::numbers::pi;
    if (unit == "mrad") heading.scale = 0.18 / std::numbers::pi;
    return heading;
  }
  if (contains(name, "coherence")) {
    heading.quantity = Quantity::coherence;
    return heading;
  }
  if (contains(name, "imag") || name == "im" || name.starts_with("im(")) {
    heading.quantity = Quantity::imaginary;
    return heading;
  }
  if (contains(name, "real") || name == "re" || name.starts_with("re(")) {
    heading.quantity = Quantity::real;
    return heading;
  }
  if (contains(name, "mag") || contains(name, "gain") || contains(name, "spl") ||
      contains(name, "amplitude") || contains(name, "level") || contains(name, "impedance") ||
      name == "abs" || name == "db" || name == "z" || contains(name, "|") || unit.starts_with("db")) {
    read_magnitude(heading, name, unit);
    return heading;
  }
  if (const auto volts = scale_of(heading.unit, "V")) heading.scale = *volts;
  if (const auto amperes = scale_of(heading.unit, "A")) heading.scale = *amperes;
  return heading;
}

std::vector<Heading> parse_headings(const std::vector<std::string>& texts) {
  std::vector<Heading> out;
  for (const std::string& text : texts) out.push_back(parse_heading(text));
  return out;
}

bool is_unit_alone(const std::string& cell) {
  std::string unit(trim(cell));
  if (unit.size() > 2 && (unit.front() == '(' || unit.front() == '[')) unit = unit.substr(1, unit.size() - 2);
  if (frequency_scale(unit) || time_scale(unit) || scale_of(unit, "V") || scale_of(unit, "A")) return true;
  const std::string low = lower_case(unit);
  for (const char* base : {"ohm", "ohms"}) {
    if (scale_of(unit, base)) return true;
  }
  for (const char* known :
       {"db", "deg", "degree", "degrees", "\xC2\xB0", "\xB0", "rad", "rad/s", "ohm", "ohms"}) {
    if (low == known) return true;
  }
  return false;
}

}  // namespace bodesmith::formats
