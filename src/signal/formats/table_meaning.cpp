#include "signal/formats/table_meaning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <numbers>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace bodesmith::formats {
namespace {

/// A level below this in dB, or a gain above kLinearMax, is not plausible in a table of nothing but positive numbers.
constexpr double kLinearMax = 4.0;
constexpr double kSoundMin = 30.0;
constexpr double kSoundMax = 150.0;

std::optional<std::size_t> first_of(const std::vector<Heading>& headings, Quantity quantity,
                                    std::size_t from = 0) {
  for (std::size_t i = from; i < headings.size(); ++i) {
    if (headings[i].quantity == quantity) return i;
  }
  return std::nullopt;
}

bool is_scale_word(const std::string& choice) {
  return choice == "db" || choice == "dB" || choice == "gain" || choice == "ohm";
}

std::optional<std::size_t> frequency_column(const std::vector<Heading>& headings) {
  const auto hz = first_of(headings, Quantity::frequency);
  return hz ? hz : first_of(headings, Quantity::angular_frequency);
}

/// The magnitude (or real part) column that the user chose; else the first.
std::size_t chosen_column(const Source& source, const std::vector<Heading>& headings) {
  std::vector<std::string> names;
  std::vector<std::size_t> places;
  for (const Quantity quantity : {Quantity::magnitude, Quantity::real}) {
    for (std::size_t i = 0; i < headings.size(); ++i) {
      if (headings[i].quantity != quantity) continue;
      names.push_back(headings[i].text);
      places.push_back(i);
    }
    if (source.choice.empty() && !places.empty()) break;
  }
  if (source.choice.empty() || is_scale_word(source.choice)) return places.front();
  // The whole choice may be a heading that contains '/'.
  return places[require_name(source, names, source.choice)];
}

/// The phase that belongs to a magnitude: the next one after it, else the first.
std::optional<std::size_t> phase_of(const std::vector<Heading>& headings, std::size_t magnitude) {
  const auto next = first_of(headings, Quantity::phase, magnitude);
  return next ? next : first_of(headings, Quantity::phase);
}

std::optional<std::size_t> imaginary_of(const std::vector<Heading>& headings, std::size_t real) {
  return first_of(headings, Quantity::imaginary, real);
}

ResponseTrace complex_trace(const NumberTable& table, const std::vector<Heading>& headings, std::size_t real,
                            std::size_t imaginary, Words& words) {
  std::vector<std::complex<double>> response(table.rows());
  for (std::size_t i = 0; i < response.size(); ++i)
    response[i] = {table.columns[real][i], table.columns[imaginary][i]};
  words.notes.push_back(fmt::format("'{}' and '{}'", headings[real].text, headings[imaginary].text));
  return to_trace(headings[real].text, response);
}

void validate_unit(const Source& source, const NumberTable& table, const Heading& heading) {
  if (heading.unit_known) return;
  throw InputError(source.file, table.lines.front(),
                   fmt::format("begins a table whose '{}' has a unit that is not known here", heading.text));
}

/// Gamma squared, 0 to 1, from shares or percent; empty where the column holds anything else.
std::vector<double> coherence_of(const Heading& heading, std::vector<double> values, Words& words) {
  double high = 0.0;
  bool legal = true;
  for (const double value : values) {
    legal = legal && value >= 0.0 && value <= 100.0;
    high = std::max(high, value);
  }
  if (!legal) {
    words.notes.push_back(fmt::format("'{}' not used: it is no coherence of 0 to 1", heading.text));
    return {};
  }
  const bool percent = heading.unit == "%" || high > 1.0;
  if (percent) {
    for (double& value : values) value /= 100.0;
  }
  words.notes.push_back(
      fmt::format("'{}' as gamma squared{}", heading.text, percent ? ", from percent" : ""));
  return values;
}

Foreign response_of(const Source& source, NumberTable table, const std::vector<Heading>& headings,
                    Words words) {
  const std::size_t at = *frequency_column(headings);
  validate_unit(source, table, headings[at]);
  std::vector<double> frequency = hertz(headings[at], std::move(table.columns[at]), words);
  const std::size_t column = chosen_column(source, headings);
  const auto phase = phase_of(headings, column);
  const bool real = headings[column].quantity == Quantity::real;
  std::optional<std::size_t> imaginary = real ? imaginary_of(headings, column) : std::nullopt;
  std::size_t real_part = column;
  if (!real && !phase && source.choice.empty()) {
    // Magnitude twice over: its parts hold the phase too.
    if (const auto re = first_of(headings, Quantity::real)) {
      imaginary = imaginary_of(headings, *re);
      real_part = *re;
    }
  }
  if (real && !imaginary)
    throw InputError(source.file, 0, fmt::format("has '{}' and no imaginary part", headings[column].text));
  ResponseTrace trace;
  if (imaginary) {
    trace = complex_trace(table, headings, real_part, *imaginary, words);
  } else {
    words.notes.push_back(
        fmt::format("'{}'", headings[column].text) +
        (phase ? fmt::format(" and '{}'", headings[*phase].text) : std::string(", no phase")));
    trace.name = headings[column].text;
    for (double& value : table.columns[column]) value *= headings[column].scale;
    trace.magnitude_db = decibels(source, headings[column].magnitude, table.columns[column], words);
    if (phase) {
      trace.phase_deg = std::move(table.columns[*phase]);
      if (headings[*phase].scale != 1.0) words.notes.emplace_back("phase from radians");
      for (double& value : trace.phase_deg) value *= headings[*phase].scale;
    }
  }
  if (const auto coherence = first_of(headings, Quantity::coherence))
    trace.coherence = coherence_of(headings[*coherence], std::move(table.columns[*coherence]), words);
  return response_columns(source, std::move(words), std::move(frequency), std::move(trace),
                          std::move(table.lines));
}

Foreign record_of(const Source& source, NumberTable table, const std::vector<Heading>& headings,
                  Words words) {
  const std::size_t at = *first_of(headings, Quantity::time);
  validate_unit(source, table, headings[at]);
  std::vector<double> time = std::move(table.columns[at]);
  if (headings[at].scale != 1.0) words.notes.push_back(fmt::format("time from {}", headings[at].unit));
  for (double& t : time) t *= headings[at].scale;
  std::vector<SignalTrace> signals;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    if (headings[i].quantity == Quantity::time) continue;
    SignalTrace signal{headings[i].text, std::move(table.columns[i])};
    if (headings[i].quantity == Quantity::signal) {
      for (double& value : signal.values) value *= headings[i].scale;
      if (headings[i].scale != 1.0)
        signal.name += fmt::format(" (times {})", rounded_text(headings[i].scale));
    }
    signals.push_back(std::move(signal));
  }
  return record_columns(source, std::move(words), std::move(time), choose_signals(source, std::move(signals)),
                        std::move(table.lines), Steps::as_they_are);
}

}  // namespace

bool has_response_headings(const std::vector<Heading>& headings) {
  return frequency_column(headings) &&
         (first_of(headings, Quantity::magnitude) || first_of(headings, Quantity::real));
}

bool has_record_headings(const std::vector<Heading>& headings) {
  return headings.size() >= 2 && first_of(headings, Quantity::time).has_value();
}

std::vector<double> decibels(const Source& source, MagnitudeScale scale, std::span<const double> values,
                             Words& words) {
  if (source.choice == "db" || source.choice == "dB") scale = MagnitudeScale::decibel;
  if (source.choice == "gain" || source.choice == "ohm") scale = MagnitudeScale::linear;
  if (scale == MagnitudeScale::unknown && !values.empty()) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    if (*low <= 0.0) {
      scale = MagnitudeScale::decibel;
      words.notes.emplace_back("magnitudes taken as dB, some being 0 or less");
    } else if (*high <= kLinearMax) {
      scale = MagnitudeScale::linear;
      words.notes.emplace_back(
          "magnitudes taken as linear gains, all being above 0 and at most 4 (else: FILE:db)");
    } else if (*low >= kSoundMin && *high <= kSoundMax) {
      scale = MagnitudeScale::decibel;
      words.notes.emplace_back(
          "magnitudes taken as dB, all being from 30 to 150 (else: FILE:gain or FILE:ohm)");
    } else {
      throw InputError(source.file, 0,
                       fmt::format("has magnitudes from {} to {} without a unit: say {}:db, :gain or :ohm",
                                   rounded_text(*low), rounded_text(*high), source.file));
    }
  }
  std::vector<double> out(values.begin(), values.end());
  if (scale == MagnitudeScale::decibel) return out;
  for (double& value : out) {
    if (value < 0.0)
      throw InputError(source.file, 0, fmt::format("has the magnitude {}, expected 0 or more", value));
    value = to_decibel(value);
  }
  words.notes.emplace_back("linear magnitudes made dB");
  return out;
}

std::vector<double> hertz(const Heading& heading, std::vector<double> values, Words& words) {
  double scale = heading.scale;
  if (heading.quantity == Quantity::angular_frequency) {
    scale = 0.5 / std::numbers::pi;
    words.notes.emplace_back("frequency from rad/s");
  } else if (heading.unit.empty()) {
    words.notes.emplace_back("frequency without a unit taken as Hz");
  } else if (scale != 1.0) {
    words.notes.push_back("frequency from " + heading.unit);
  }
  for (double& value : values) value *= scale;
  return values;
}

Foreign read_by_headings(const Source& source, NumberTable table, Words words) {
  const std::vector<Heading> headings = parse_headings(table.headings);
  if (table.decimal_comma) words.notes.emplace_back("decimal commas");
  if (has_response_headings(headings))
    return response_of(source, std::move(table), headings, std::move(words));
  if (has_record_headings(headings)) return record_of(source, std::move(table), headings, std::move(words));
  throw InputError(
      source.file, table.lines.front() - 1,
      fmt::format("has the columns {}: expected a frequency and a magnitude, or a time and signals",
                  join(table.headings, ", ")));
}

}  // namespace bodesmith::formats
