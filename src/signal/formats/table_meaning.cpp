#include "signal/formats/table_meaning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <string_view>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace bodesmith::formats {
namespace {

/// Times of rows that have none, as the lines above them say.
struct Sampling {
  std::string key;  ///< as the file calls the step
  double start_s = 0.0;
  double step_s = 0.0;
};

constexpr std::string_view kStepKeys[] = {"delta_x", "hresolution", "time interval", "xinc",
                                          "sample interval"};
constexpr std::string_view kStartKeys[] = {"x0", "hoffset", "xorg"};

/// The one number behind a key; nothing where its cells differ or are none.
std::optional<double> only_number(const std::vector<std::string_view>& cells, bool decimal_comma) {
  std::optional<double> only;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    std::string cell(trim(cells[i]));
    if (cell.empty()) continue;
    if (decimal_comma) std::replace(cell.begin(), cell.end(), ',', '.');
    if (cell.back() == 'S') cell.back() = 's';
    double value = 0.0;
    if (!parse_quantity(cell, value) || (only && *only != value)) return std::nullopt;
    only = value;
  }
  return only;
}

/// "Delta_X<tab>1e-4<tab>1e-4" and "X0" (LabVIEW), "HResolution" and "HOffset" (Yokogawa), "Time interval,100uS" (Owon),
/// "XInc:,1e-4" and "XOrg:" (Infiniium). Nothing where there is no step, or where channels have different ones.
std::optional<Sampling> sampling_above(const NumberTable& table) {
  Sampling out;
  for (const std::string& line : table.above) {
    const char separator = line.find('\t') != std::string::npos  ? '\t'
                           : line.find(';') != std::string::npos ? ';'
                                                                 : ',';
    const std::vector<std::string_view> cells = formats::split_cells(line, separator);
    std::string key = lower_case(cells.front());
    while (key.ends_with(':') || key.ends_with(' ')) key.pop_back();
    // LabVIEW's spectra have steps of frequency.
    if (key == "x_dimension" && line.find("Time") == std::string::npos) return std::nullopt;
    const auto is_in = [&](const auto& keys) {
      return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
    };
    if (!is_in(kStepKeys) && !is_in(kStartKeys)) continue;
    const auto value = only_number(cells, table.decimal_comma);
    if (!value) return std::nullopt;
    if (is_in(kStartKeys)) {
      out.start_s = *value;
    } else {
      out.key = cells.front();
      out.step_s = *value;
    }
  }
  if (!(out.step_s > 0.0)) return std::nullopt;
  return out;
}

/// A level below this in dB, or a gain above kLinearMax, is not plausible in a table of nothing but positive numbers.
constexpr double kLinearMax = 4.0;
constexpr double kSoundMin = 30.0;
constexpr double kSoundMax = 150.0;

/// Of several columns a file means the one that is a quotient, then S21, then one that is not the level of one signal.
int rank_of(const Heading& heading) {
  const bool forward = lower_case(heading.text).find("s21") != std::string::npos ||
                       heading.text.find("S(2,1)") != std::string::npos;
  return (heading.quotient ? 0
          : forward        ? 1
          : heading.level  ? 4
                           : 2) +
         (heading.magnitude != MagnitudeScale::decibel && !heading.level ? 1 : 0);
}

struct Candidates {
  std::vector<std::string> names;
  std::vector<std::size_t> places;
};

/// The magnitude (or real part) column that the user chose; else the one that the headings call out.
std::size_t chosen_column(const Source& source, const std::vector<Heading>& headings) {
  Candidates all;
  for (const Quantity quantity : {Quantity::magnitude, Quantity::real}) {
    for (std::size_t i = 0; i < headings.size(); ++i) {
      if (headings[i].quantity != quantity) continue;
      all.names.push_back(headings[i].text);
      all.places.push_back(i);
    }
    if (source.choice.empty() && !all.places.empty()) break;
  }
  // The whole choice may be a heading that contains '/'.
  if (!source.choice.empty() && !is_scale_word(source.choice))
    return all.places[require_name(source, all.names, source.choice)];
  const auto ranks_below = [&](std::size_t a, std::size_t b) {
    return rank_of(headings[a]) < rank_of(headings[b]);
  };
  const std::size_t best = *std::ranges::min_element(all.places, ranks_below);
  const auto equal = std::ranges::count_if(all.places, [&](std::size_t i) { return !ranks_below(best, i); });
  if (equal > 1)
    throw InputError(source.file, 0,
                     fmt::format("holds {}: choose one as FILE:NAME, or a quotient as FILE:NAME/NAME",
                                 join(all.names, ", ")));
  return best;
}

/// FILE:A/B of two magnitudes, where no heading is called so.
std::optional<std::pair<std::size_t, std::size_t>> chosen_quotient(const Source& source,
                                                                   const std::vector<Heading>& headings) {
  const Choice choice = split_choice(source.choice);
  std::vector<std::string> names;
  for (const Heading& heading : headings)
    names.push_back(heading.quantity == Quantity::magnitude ? heading.text : std::string());
  if (choice.between != '/' || find_name(names, source.choice)) return std::nullopt;
  return std::pair(require_name(source, names, choice.first), require_name(source, names, choice.second));
}

/// The phase that belongs to a magnitude: the next one after it, else the first.
std::optional<std::size_t> phase_of(const std::vector<Heading>& headings, std::size_t magnitude) {
  const auto next = first_of(headings, Quantity::phase, magnitude);
  return next ? next : first_of(headings, Quantity::phase);
}

std::optional<std::size_t> imaginary_of(const std::vector<Heading>& headings, std::size_t real) {
  const auto next = first_of(headings, Quantity::imaginary, real);
  return next ? next : first_of(headings, Quantity::imaginary);
}

ResponseTrace complex_trace(const NumberTable& table, const std::vector<Heading>& headings, std::size_t real,
                            std::size_t imaginary, Words& words) {
  std::vector<Complex> response(table.rows());
  for (std::size_t i = 0; i < response.size(); ++i)
    response[i] = {headings[real].scale * table.columns[real][i],
                   headings[imaginary].scale * table.columns[imaginary][i]};
  words.notes.push_back(fmt::format("'{}' and '{}'", headings[real].text, headings[imaginary].text));
  return to_trace(headings[real].text, response);
}

void validate_unit(const Source& source, const NumberTable& table, const Heading& heading) {
  if (heading.unit_known || (heading.quantity == Quantity::magnitude && is_scale_word(source.choice))) return;
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

/// Rows in which one of these columns has an empty cell go, and it is said.
void leave_out_empty(NumberTable& table, std::initializer_list<std::optional<std::size_t>> used,
                     Words& words) {
  std::vector<std::size_t> kept;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const bool empty = std::ranges::any_of(
        used, [&](const auto& column) { return column && std::isnan(table.columns[*column][row]); });
    if (!empty) kept.push_back(row);
  }
  if (kept.size() == table.rows()) return;
  words.notes.push_back(fmt::format("{} rows with empty cells left out", table.rows() - kept.size()));
  for (std::size_t to = 0; to < kept.size(); ++to) {
    for (std::vector<double>& column : table.columns) column[to] = column[kept[to]];
    table.lines[to] = table.lines[kept[to]];
  }
  for (std::vector<double>& column : table.columns) column.resize(kept.size());
  table.lines.resize(kept.size());
}

std::vector<double> phase_of_column(const Source& source, const Heading& heading, std::vector<double> values,
                                    Words& words) {
  if (std::abs(heading.scale) != 1.0) words.notes.emplace_back("phase from radians");
  if (heading.scale < 0.0) words.notes.push_back(fmt::format("'{}' with the other sign", heading.text));
  for (double& value : values) value *= heading.scale;
  if (!heading.unit.empty()) return values;
  return degrees_of(source, fmt::format("'{}'", heading.text), std::move(values),
                    fmt::format("say {0}:deg or {0}:rad", source.file), words);
}

std::vector<double> level_of_column(const Source& source, const Heading& heading, std::vector<double> values,
                                    Words& words) {
  if (heading.scale < 0.0) words.notes.push_back(fmt::format("'{}' with the other sign", heading.text));
  for (double& value : values) value *= heading.scale;
  return decibels(source, heading.magnitude, values, words);
}

/// A magnitude with its phase.
ResponseTrace magnitude_trace(const Source& source, const NumberTable& table,
                              const std::vector<Heading>& headings, std::size_t column, Words& words) {
  const Heading& heading = headings[column];
  ResponseTrace trace;
  trace.name = heading.text;
  trace.magnitude_db = level_of_column(source, heading, table.columns[column], words);
  if (const auto phase = phase_of(headings, column)) {
    validate_unit(source, table, headings[*phase]);
    trace.phase_deg = phase_of_column(source, headings[*phase], table.columns[*phase], words);
  }
  return trace;
}

/// One magnitude, whose level alone is no response.
ResponseTrace single_trace(const Source& source, NumberTable& table, const std::vector<Heading>& headings,
                           std::size_t column, Words& words) {
  const Heading& heading = headings[column];
  const auto phase = phase_of(headings, column);
  words.notes.push_back(
      fmt::format("'{}'", heading.text) +
      (phase ? fmt::format(" and '{}'", headings[*phase].text) : std::string(", no phase")));
  if (!phase && heading.level && source.choice.empty())
    throw InputError(source.file, 0,
                     fmt::format("has '{}' and no phase: a spectrum, expected a response (FILE:NAME/NAME is "
                                 "one signal over another, FILE:db or FILE:gain takes it as it is)",
                                 heading.text));
  if (heading.level)
    words.notes.push_back(
        fmt::format("0 dB is {} {}", heading.magnitude == MagnitudeScale::decibel ? 0 : 1, heading.unit));
  if (lower_case(heading.unit).starts_with("ohm")) words.notes.emplace_back("an impedance: 0 dB is 1 ohm");
  leave_out_empty(table, {frequency_column(headings), column, phase}, words);
  return magnitude_trace(source, table, headings, column, words);
}

/// One magnitude over another; with a phase where each has its own.
ResponseTrace quotient_trace(const Source& source, NumberTable& table, const std::vector<Heading>& headings,
                             std::size_t above, std::size_t below, Words& words) {
  words.notes.push_back(fmt::format("'{}' over '{}'", headings[above].text, headings[below].text));
  validate_unit(source, table, headings[below]);
  const auto phase_above = phase_of(headings, above);
  const auto phase_below = phase_of(headings, below);
  leave_out_empty(table, {frequency_column(headings), above, below, phase_above, phase_below}, words);
  Words aside;
  ResponseTrace out = magnitude_trace(source, table, headings, above, words);
  const ResponseTrace under = magnitude_trace(source, table, headings, below, aside);
  if (phase_above == phase_below) out.phase_deg.clear();
  for (std::size_t i = 0; i < under.magnitude_db.size(); ++i) out.magnitude_db[i] -= under.magnitude_db[i];
  for (std::size_t i = 0; i < out.phase_deg.size(); ++i) out.phase_deg[i] -= under.phase_deg[i];
  return out;
}

/// A second axis under the same heading must be the same one: blocks side by side have one each.
void validate_one_axis(const Source& source, const NumberTable& table, const std::vector<Heading>& headings,
                       std::size_t axis) {
  for (std::size_t i = axis + 1; i < headings.size(); ++i) {
    const bool again =
        headings[i].quantity == headings[axis].quantity && headings[i].text == headings[axis].text;
    if (again && table.columns[i] != table.columns[axis])
      throw InputError(source.file, table.lines.front(),
                       fmt::format("begins a table with two columns '{}' that differ", headings[axis].text));
  }
}

Foreign response_of(const Source& source, NumberTable table, const std::vector<Heading>& headings,
                    Words words) {
  const std::size_t at = *frequency_column(headings);
  validate_unit(source, table, headings[at]);
  validate_one_axis(source, table, headings, at);
  const auto quotient = chosen_quotient(source, headings);
  const std::size_t column = quotient ? quotient->first : chosen_column(source, headings);
  validate_unit(source, table, headings[column]);
  const bool real = headings[column].quantity == Quantity::real;
  std::optional<std::size_t> imaginary = real ? imaginary_of(headings, column) : std::nullopt;
  std::size_t real_part = column;
  if (!real && !phase_of(headings, column) && source.choice.empty()) {
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
    leave_out_empty(table, {at, real_part, imaginary}, words);
    trace = complex_trace(table, headings, real_part, *imaginary, words);
  } else {
    trace = quotient ? quotient_trace(source, table, headings, column, quotient->second, words)
                     : single_trace(source, table, headings, column, words);
  }
  std::vector<double> frequency = hertz(headings[at], std::move(table.columns[at]), words);
  if (const auto coherence = first_of(headings, Quantity::coherence))
    trace.coherence = coherence_of(headings[*coherence], std::move(table.columns[*coherence]), words);
  return response_columns(source, std::move(words), std::move(frequency), std::move(trace),
                          std::move(table.lines));
}

/// The times of the file, or those of the sampling rate that the user gave.
std::vector<double> times_of(const Source& source, NumberTable& table, const std::vector<Heading>& headings,
                             Words& words) {
  const auto at = first_of(headings, Quantity::time);
  if (!at && source.sample_hz) return sampled_times(*source.sample_hz, table.rows(), words);
  if (!at) {
    const Sampling sampling = *sampling_above(table);
    words.notes.push_back(
        fmt::format("steps of {} by '{}'", engineering_text(sampling.step_s, "s", 6), sampling.key));
    std::vector<double> time(table.rows());
    for (std::size_t i = 0; i < time.size(); ++i)
      time[i] = sampling.start_s + sampling.step_s * static_cast<double>(i);
    return time;
  }
  validate_unit(source, table, headings[*at]);
  validate_one_axis(source, table, headings, *at);
  std::vector<double> time = std::move(table.columns[*at]);
  if (headings[*at].scale != 1.0) words.notes.push_back(fmt::format("time from {}", headings[*at].unit));
  for (double& t : time) t *= headings[*at].scale;
  return time;
}

/// "Sample", "#", a heading that is empty (a table of Python or R): 0, 1, 2, … or 1, 2, 3, …
bool counts_rows(const std::string& heading, const std::vector<double>& column) {
  const std::string name = lower_case(heading);
  if (!name.empty() && name != "#" && name != "sample" && name != "samples" && name != "index" &&
      name != "no" && name != "no." && name != "number" && name != "point" && name != "id")
    return false;
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (column[i] != column.front() + static_cast<double>(i)) return false;
  }
  return true;
}

Foreign record_of(const Source& source, NumberTable table, const std::vector<Heading>& headings,
                  Words words) {
  std::vector<std::string> names;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    if (headings[i].quantity == Quantity::time || counts_rows(headings[i].text, table.columns[i])) continue;
    if (i > 0 && headings[i].quantity == Quantity::imaginary && headings[i].text == headings[i - 1].text) {
      const auto& imaginary = table.columns[i];
      const auto other = std::ranges::find_if(imaginary, [](double v) { return v != 0.0; });
      if (other != imaginary.end())
        throw InputError(source.file, table.lines[static_cast<std::size_t>(other - imaginary.begin())],
                         fmt::format("'{}' is complex, expected signals over time", headings[i].text));
      continue;
    }
    places.push_back(i);
    names.push_back(headings[i].text);
  }
  const std::vector<std::size_t> chosen = choose_signals(source, names);
  std::optional<std::size_t> second;
  if (chosen.size() > 1) second = places[chosen[1]];
  leave_out_empty(table, {first_of(headings, Quantity::time), places[chosen[0]], second}, words);
  std::vector<SignalTrace> signals;
  for (const std::size_t i : chosen) {
    const Heading& heading = headings[places[i]];
    SignalTrace signal{heading.text, table.columns[places[i]]};
    if ((heading.quantity == Quantity::signal || heading.level) && heading.scale != 1.0) {
      for (double& value : signal.values) value *= heading.scale;
      signal.name += fmt::format(" (times {})", rounded_text(heading.scale));
    }
    signals.push_back(std::move(signal));
  }
  std::vector<double> time = times_of(source, table, headings, words);
  return record_columns(source, std::move(words), std::move(time), std::move(signals), std::move(table.lines),
                        Steps::as_they_are);
}

}  // namespace

bool is_scale_word(const std::string& choice) {
  return choice == "db" || choice == "dB" || choice == "gain" || choice == "ohm" || choice == "deg" ||
         choice == "rad";
}

std::vector<double> degrees_of(const Source& source, std::string_view name, std::vector<double> values,
                               std::string_view instead, Words& words) {
  const bool radians = source.choice == "rad";
  // Two turns: radians that were unwrapped are told from degrees as well.
  const bool small = std::ranges::all_of(
      values, [](double v) { return std::isnan(v) || std::abs(v) <= 4.0 * std::numbers::pi; });
  const bool zero = std::ranges::all_of(values, [](double v) { return !(v != 0.0); });
  if (small && !zero && !radians && source.choice != "deg")
    throw InputError(
        source.file, 0,
        fmt::format("has {} within 4 pi and no unit, so that it may be radians: {}", name, instead));
  if (radians) {
    for (double& value : values) value = to_degrees(value);
    words.notes.emplace_back("phase from radians");
  }
  return values;
}

std::vector<double> sampled_times(double sample_hz, std::size_t count, Words& words) {
  words.notes.push_back(fmt::format("samples at {} as asked", engineering_text(sample_hz, "Hz", 6)));
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<double>(i) / sample_hz;
  return out;
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
    scale *= heading.scale;
    words.notes.push_back("frequency from " + (heading.unit.empty() ? "rad/s" : heading.unit));
  } else if (heading.unit.empty()) {
    words.notes.emplace_back("frequency without a unit taken as Hz");
  } else if (scale != 1.0) {
    words.notes.push_back("frequency from " + heading.unit);
  }
  if (heading.logarithm) {
    words.notes.emplace_back("frequency from its logarithm to base 10");
    for (double& value : values) value = std::pow(10.0, value);
  }
  for (double& value : values) value *= scale;
  return values;
}

bool is_record(const Source& source, const NumberTable& table, const std::vector<Heading>& headings) {
  if (has_record_headings(headings)) return true;
  return !headings.empty() && (source.sample_hz || (!frequency_column(headings) && sampling_above(table)));
}

Foreign read_by_headings(const Source& source, NumberTable table, Words words) {
  const std::vector<Heading> headings = parse_headings(table.headings);
  if (table.decimal_comma) words.notes.emplace_back("decimal commas");
  if (has_response_headings(headings))
    return response_of(source, std::move(table), headings, std::move(words));
  if (is_record(source, table, headings))
    return record_of(source, std::move(table), headings, std::move(words));
  throw InputError(
      source.file, table.lines.front() - 1,
      fmt::format("has the columns {}: expected a frequency and a magnitude, or a time and signals",
                  join(table.headings, ", ")));
}

}  // namespace bodesmith::formats
