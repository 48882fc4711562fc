#include "signal/formats/headings.hpp"

#include <algorithm>
#include <numbers>
#include <string_view>

#include "base/text.hpp"

namespace bodesmith::formats {
namespace {

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

// dB10 is a level of powers, half of what is meant here.
constexpr std::string_view kLevelFunctions[] = {"db", "db20", "vdb", "logmag"};
constexpr std::string_view kAngleFunctions[] = {"ang_deg", "cang_deg", "phase", "arg", "ang", "ph", "vp"};
constexpr std::string_view kRadianFunctions[] = {"ang_rad", "cang_rad"};
constexpr std::string_view kSizeFunctions[] = {"mag", "abs", "vm"};
constexpr std::string_view kRealFunctions[] = {"re", "vr"};
constexpr std::string_view kImaginaryFunctions[] = {"im", "vi"};

template <std::size_t N>
bool is_one_of(std::string_view name, const std::string_view (&words)[N]) {
  return std::find(std::begin(words), std::end(words), name) != std::end(words);
}

bool is_function_of(std::string_view name) {
  return is_one_of(name, kLevelFunctions) || is_one_of(name, kAngleFunctions) ||
         is_one_of(name, kRadianFunctions) || is_one_of(name, kSizeFunctions) ||
         is_one_of(name, kRealFunctions) || is_one_of(name, kImaginaryFunctions) || name == "-im" ||
         name == "amp";
}

/// Where the bracket that closes at `close` opens.
std::size_t opening_of(std::string_view text, std::size_t close) {
  const char closing = text[close];
  const char opening = closing == ')' ? '(' : '[';
  int depth = 0;
  for (std::size_t i = close + 1; i-- > 0;) {
    if (text[i] == closing) ++depth;
    if (text[i] == opening && --depth == 0) return i;
  }
  return std::string_view::npos;
}

/// V(out), dB(S(2,1)), Re(Z): what stands in the brackets is what was measured. Mag(dB) has a unit there.
bool is_name_with_brackets(std::string_view before, const std::string& inside) {
  const std::string name = lower_case(before);
  return name == "v" || name == "i" || ((name == "p" || is_function_of(name)) && !is_unit_alone(inside));
}

/// The last text in brackets; what stands before them into `rest`.
std::string bracketed(const std::string& text, std::string& rest) {
  const std::size_t close = text.find_last_of(")]");
  const std::size_t open = close == std::string::npos ? close : opening_of(text, close);
  if (open != std::string::npos && open > 0) {
    const std::string_view before = std::string_view(text).substr(0, open);
    std::string inside(trim(std::string_view(text).substr(open + 1, close - open - 1)));
    if (before.back() == ' ' || !is_name_with_brackets(before, inside)) {
      rest = std::string(trim(before));
      return inside;
    }
  }
  rest = text;
  // "f/Hz", "Gain dB", "Z / Ohm", "Gain in dB", "Frequency, Hz", "FREQ.KHZ"
  const std::size_t end = text.find_last_of("/ .,");
  if (end != std::string::npos && end > 0 && !is_unit_alone(text) && is_unit_alone(text.substr(end + 1))) {
    rest = std::string(trim(std::string_view(text).substr(0, end)));
    if (rest.ends_with(" in") || rest == "in") rest = rest.substr(0, rest.size() - 2);
    rest = rest.substr(0, rest.find_last_not_of("/ .,") + 1);
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

/// Scale of "rad/s", "krad/s", "radians/second", "rad s^-1" in rad/s.
std::optional<double> angular_scale(std::string_view unit) {
  for (const char* base : {"rad/s", "rad/sec", "rad/second", "radians/s", "radians/sec", "radians/second",
                           "rad s^-1", "rad_s"}) {
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
  if (name.starts_with("freq") || name == "acfrequency" || name == "f" || name == "hz" || name == "frequenz")
    return true;
  return !heading.unit.empty() && frequency_scale(heading.unit).has_value() && !contains(name, "gain");
}

/// Volts and amperes, as peaks and means too.
std::optional<double> signal_scale(std::string_view unit) {
  for (const char* base :
       {"V", "Volt", "Volts", "Vpp", "Vp", "Vpk", "Vrms", "A", "Ampere", "Amperes", "Amp"}) {
    if (const auto scale = scale_of(unit, base)) return scale;
  }
  return std::nullopt;
}

std::optional<double> resistance_scale(std::string_view unit) {
  for (const char* base : {"ohm", "ohms", "\xCE\xA9", "\xE2\x84\xA6"}) {
    if (const auto scale = scale_of(unit, base)) return scale;
  }
  return std::nullopt;
}

bool is_degrees(const std::string& unit) {
  return unit.empty() || unit == "*" || unit == "deg." || unit.ends_with("\xC2\xB0") || unit == "\xB0" ||
         unit == "deg" || unit == "degree" || unit == "degrees";
}

constexpr std::string_view kLossWords[] = {"attenuation", "loss", "d\xC3\xA4mpfung"};
/// Of a linear magnitude: what is no gain but its square or a logarithm.
constexpr std::string_view kNoGainWords[] = {"power gain", "power ratio", "squared", "^2",
                                             "\xC2\xB2",   "log10",       "ln(",     "ln|"};
/// Next to magnitudes and phases: what is said of them, not they themselves.
constexpr std::string_view kAsideWords[] = {"std", "deviation", "uncertainty", "error", "margin", "delay"};
/// Levels of one signal.
constexpr std::string_view kDensityWords[] = {"psd", "density", "noise"};

template <std::size_t N>
bool contains_one_of(const std::string& text, const std::string_view (&words)[N]) {
  return std::any_of(std::begin(words), std::end(words),
                     [&](std::string_view w) { return contains(text, w); });
}

void read_magnitude(Heading& heading, const std::string& name, const std::string& unit) {
  heading.quantity = Quantity::magnitude;
  heading.quotient = contains(name, "math") || contains(name, " / ");
  heading.level = contains_one_of(name, kDensityWords);
  // An attenuation is a gain of the other sign; as a ratio it is not known which.
  if (contains_one_of(name, kLossWords)) {
    heading.unit_known = unit == "db";
    heading.magnitude = MagnitudeScale::decibel;
    heading.scale = -heading.scale;
    return;
  }
  if (unit.starts_with("db/") || contains(unit, "hz")) {
    heading.unit_known = false;
    return;
  }
  // A program that writes either: the values or the user say which.
  if (unit == "dbv/ohm" || unit == "dbv/ohms") return;
  if (unit.starts_with("db") || contains(name, "db") || contains(name, "spl")) {
    heading.magnitude = MagnitudeScale::decibel;
    for (const char* of_one_signal : {"dbv", "dbu", "dbm", "dbmv", "dbuv", "db\xC2\xB5v", "dbfs", "dbvrms"})
      heading.level = heading.level || unit == of_one_signal;
    return;
  }
  if (contains_one_of(name, kNoGainWords) || (name.starts_with("log") && !contains(name, "mag"))) {
    heading.unit_known = false;
    return;
  }
  if (const auto ohm = resistance_scale(heading.unit)) {
    heading.magnitude = MagnitudeScale::linear;
    heading.scale *= *ohm;
  } else if (const auto signal = signal_scale(heading.unit)) {
    heading.magnitude = MagnitudeScale::linear;
    heading.scale *= *signal;
    heading.level = true;
  } else if (unit == "1" || unit == "-" || unit == "u" || unit == "x" || unit == "v/v" || unit == "a/a" ||
             unit == "lin" || unit == "linear" || unit == "ratio" || contains(name, "linear")) {
    heading.magnitude = MagnitudeScale::linear;
  } else {
    heading.unit_known = heading.unit.empty();
  }
}

void read_phase(Heading& heading, const std::string& unit) {
  heading.quantity = Quantity::phase;
  if (contains(lower_case(heading.text), "lag")) heading.scale = -heading.scale;
  if (is_radians(unit)) {
    heading.scale *= 180.0 / std::numbers::pi;
  } else if (unit == "mrad") {
    heading.scale *= 0.18 / std::numbers::pi;
  } else {
    heading.unit_known = is_degrees(unit);
  }
}

/// "-Phase", "neg. Phase", "-Im(Z)": the sign, which goes from the name.
double take_sign(std::string& name) {
  for (const std::string_view sign : {"-", "neg. ", "negative "}) {
    if (!name.starts_with(sign) || name.size() == sign.size()) continue;
    name = std::string(trim(std::string_view(name).substr(sign.size())));
    return -1.0;
  }
  return 1.0;
}

/// Parts of a complex number as impedance analysers name them: Zre, Z_real, Z', Re(Z), Im(Z), Z'', R (Ohm), X (Ohm).
std::optional<Quantity> part_named(const std::string& name, bool ohms) {
  const std::string function = name.substr(0, name.find_first_of("(: "));
  if (contains(name, "imag") || is_one_of(function, kImaginaryFunctions) || name == "zim" || name == "z_im" ||
      name == "z''" || name == "z\"" || (ohms && (name == "x" || name == "xs")))
    return Quantity::imaginary;
  if (contains(name, "real") || is_one_of(function, kRealFunctions) || name == "zre" || name == "z_re" ||
      name == "z'" || (ohms && (name == "r" || name == "rs")))
    return Quantity::real;
  return std::nullopt;
}

constexpr std::string_view kPhaseNames[] = {"fase", "arg",      "deg",   "zphz",    "ph",
                                            "phi",  "\xCF\x86", "theta", "\xCE\xB8"};

/// "|Z|", "|H|", "|S21|"; "|Vac|" is how the measurement was driven.
bool is_size_between_bars(const std::string& name) {
  const std::size_t bar = name.find('|');
  if (bar == std::string::npos || bar + 1 >= name.size()) return false;
  return std::string_view("zyhgst").find(name[bar + 1]) != std::string_view::npos;
}

/// "TR1: Gain (Real)", "TR2: Gain (Degree)": what stands in brackets is a part of a complex number and no unit.
std::optional<Quantity> part_in_brackets(const std::string& unit) {
  if (unit == "real" || unit == "re" || unit == "real part") return Quantity::real;
  if (unit == "imag" || unit == "imaginary" || unit == "im" || unit == "imaginary part")
    return Quantity::imaginary;
  if (unit == "phase" || unit == "degree" || unit == "degrees" || unit == "deg" || unit == "\xC2\xB0" ||
      is_radians(unit))
    return Quantity::phase;
  if (unit == "absolut" || unit == "absolute" || unit == "abs" || unit.starts_with("magnitude"))
    return Quantity::magnitude;
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
    const std::size_t bar = name.ends_with("_rad_s") ? name.size() - 6 : name.rfind('_');
    if (bar != std::string::npos && bar > 0 && is_unit_alone(rest.substr(bar + 1))) {
      heading.unit = rest.substr(bar + 1);
      name = name.substr(0, bar);
    }
  }
  if (heading.unit.empty() && frequency_scale(heading.text)) {
    heading.unit = heading.text;
    name = "hz";
  }
  if (heading.unit.empty() &&
      (name.starts_with("db") || name == "rad/s" || is_degrees(name) || is_radians(name) ||
       resistance_scale(heading.text)) &&
      is_unit_alone(heading.text))
    heading.unit = heading.text;
  const std::string unit = lower_case(heading.unit);
  std::string unsigned_name = name;
  const double sign = take_sign(unsigned_name);
  const bool aside = contains_one_of(name, kAsideWords);
  if (const auto part = aside ? std::nullopt : part_in_brackets(unit)) {
    heading.scale = sign;
    if (unit == "phase") heading.unit.clear();
    if (*part == Quantity::phase) read_phase(heading, lower_case(heading.unit));
    heading.quantity = *part;
    // "S2,1 [Magnitude in dB]" (CST)
    if (*part == Quantity::magnitude)
      heading.magnitude = unit.ends_with("db") ? MagnitudeScale::decibel : MagnitudeScale::linear;
    return heading;
  }
  if (name == "freq." || is_frequency(name, heading)) {
    heading.quantity = Quantity::frequency;
    heading.logarithm = name.starts_with("log") || name.ends_with(" log") || name.ends_with("log10");
    const auto scale = frequency_scale(heading.unit);
    const auto angular = angular_scale(heading.unit);
    heading.scale = angular ? *angular : scale.value_or(1.0);
    if (angular) heading.quantity = Quantity::angular_frequency;
    heading.unit_known = scale || angular || heading.unit.empty();
    return heading;
  }
  if (name == "w" || name == "omega" || name == "\xCF\x89" || angular_scale(heading.unit)) {
    heading.quantity = Quantity::angular_frequency;
    heading.scale = angular_scale(heading.unit).value_or(1.0);
    heading.unit_known = heading.unit.empty() || angular_scale(heading.unit).has_value();
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
  if (aside) {
    heading.scale = signal_scale(heading.unit).value_or(1.0);
    return heading;
  }
  name = unsigned_name;
  // PSpice writes P(V(out)); P(W) is a power.
  if (name.starts_with("p(v(") || name.starts_with("p(i(")) name = "phase" + name.substr(1);
  const std::string function = name.substr(0, name.find_first_of("(:"));
  heading.scale = sign;
  if (function.size() < name.size() && is_function_of(function)) {
    if (is_one_of(function, kAngleFunctions) || is_one_of(function, kRadianFunctions)) {
      read_phase(heading, is_one_of(function, kRadianFunctions) ? std::string("rad") : unit);
      return heading;
    }
    if (is_one_of(function, kLevelFunctions) || is_one_of(function, kSizeFunctions)) {
      heading.quantity = Quantity::magnitude;
      heading.magnitude =
          is_one_of(function, kLevelFunctions) ? MagnitudeScale::decibel : MagnitudeScale::linear;
      return heading;
    }
  }
  if (contains(name, "phase") || contains(name, "angle") || is_one_of(name, kPhaseNames) ||
      name.ends_with("/arg")) {
    read_phase(heading, unit);
    return heading;
  }
  if (contains(name, "coherence")) {
    heading.quantity = Quantity::coherence;
    return heading;
  }
  const auto ohm = resistance_scale(heading.unit);
  if (const auto part = part_named(name, ohm.has_value())) {
    heading.quantity = *part;
    heading.scale *= ohm.value_or(1.0);
    return heading;
  }
  if (!time_scale(heading.unit) &&
      (contains(name, "mag") || contains(name, "gain") || contains(name, "spl") ||
       contains(name, "amplitude") || contains(name, "level") || contains(name, "impedance") ||
       contains_one_of(name, kLossWords) || name == "abs" || name.ends_with("/abs") || name == "db" ||
       name == "z" || name == "zmod" || (function == "amp" && function.size() < name.size()) ||
       is_size_between_bars(name) || unit.starts_with("db") || (ohm && heading.unit == heading.text))) {
    read_magnitude(heading, name, unit);
    return heading;
  }
  heading.scale = signal_scale(heading.unit).value_or(1.0);
  return heading;
}

std::vector<Heading> parse_headings(const std::vector<std::string>& texts) {
  std::vector<Heading> out;
  for (const std::string& text : texts) out.push_back(parse_heading(text));
  if (out.empty()) return out;
  // qucsconv's tables: "r out.v" and "i out.v" are one complex variable.
  for (std::size_t i = 0; i + 1 < out.size(); ++i) {
    if (!texts[i].starts_with("r ") || texts[i + 1] != "i" + texts[i].substr(1)) continue;
    out[i].quantity = Quantity::real;
    out[i + 1].quantity = Quantity::imaginary;
    for (const std::size_t part : {i, i + 1}) {
      out[part].text = texts[i].substr(2);
      out[part].scale = 1.0;
    }
  }
  // "X (Second)", "Elapsed Time (ms)", "in s": the first column's unit says what it is where all others are signals.
  const bool signals = std::ranges::all_of(out, [](const Heading& h) {
    return h.quantity == Quantity::signal || (h.quantity == Quantity::magnitude && h.level);
  });
  const auto seconds = signals ? time_scale(out.front().unit) : std::nullopt;
  if (seconds) {
    out.front().quantity = Quantity::time;
    out.front().scale = *seconds;
  }
  return out;
}

bool is_unit_alone(const std::string& cell) {
  std::string unit(trim(cell));
  if (unit.size() > 2 && (unit.front() == '(' || unit.front() == '[')) unit = unit.substr(1, unit.size() - 2);
  if (frequency_scale(unit) || time_scale(unit) || signal_scale(unit) || resistance_scale(unit)) return true;
  const std::string low = lower_case(unit);
  for (const char* known : {"db", "dbv", "dbu", "dbm", "dbv/ohm", "rad", "mrad", "\xC2\xB0", "\xB0"}) {
    if (low == known) return true;
  }
  if (angular_scale(unit)) return true;
  return !low.empty() && low != "*" && is_degrees(low);
}

std::optional<std::size_t> first_of(const std::vector<Heading>& headings, Quantity quantity,
                                    std::size_t from) {
  for (std::size_t i = from; i < headings.size(); ++i) {
    if (headings[i].quantity == quantity) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> frequency_column(const std::vector<Heading>& headings) {
  const auto hz = first_of(headings, Quantity::frequency);
  return hz ? hz : first_of(headings, Quantity::angular_frequency);
}

bool has_response_headings(const std::vector<Heading>& headings) {
  return frequency_column(headings) &&
         (first_of(headings, Quantity::magnitude) || first_of(headings, Quantity::real));
}

bool has_record_headings(const std::vector<Heading>& headings) {
  return headings.size() >= 2 && first_of(headings, Quantity::time).has_value();
}

}  // namespace bodesmith::formats
