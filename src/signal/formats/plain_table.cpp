// Two or three columns of numbers and nothing that says what they are: frequency, magnitude, phase where a response is
// wanted (FRD and ZMA files are that), time, input, output where a record is. FILE:ri takes three columns as frequency,
// real and imaginary part (ngspice's wrdata), FILE:db, FILE:gain and FILE:ohm say the unit of the magnitude; so does a
// name that ends with .frd or .zma. A text right above the numbers that is not understood leaves nothing to guess.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

bool has_ending(const Source& source, std::string_view ending) {
  return lower_case(source.file).ends_with(ending);
}

/// Times may be below 0, frequencies spread; a table of even steps may be either.
bool reads_as_record(const Source& source, const NumberTable& table) {
  if (source.choice == "record" || source.choice == "response") return source.choice == "record";
  if (source.wanted != Content::any) return source.wanted == Content::record;
  if (!source.choice.empty() || has_ending(source, ".frd") || has_ending(source, ".zma")) return false;
  const std::vector<double>& axis = table.columns.front();
  if (axis.front() < 0.0) return true;
  const double step =
      (axis.back() - axis.front()) / static_cast<double>(std::max<std::size_t>(axis.size(), 2) - 1);
  for (std::size_t i = 1; i < axis.size(); ++i) {
    if (std::abs(axis[i] - axis[i - 1] - step) > 0.01 * std::abs(step)) return false;
  }
  throw InputError(
      source.file, table.lines.front(),
      fmt::format("begins a table without headings whose first column may be times or frequencies: say "
                  "{0}:record or {0}:response",
                  source.file));
}

Foreign plain_response(const Source& source, NumberTable table, Words words) {
  words.notes.emplace_back("first column taken as Hz");
  ResponseTrace trace;
  if (source.choice == "ri") {
    if (table.columns.size() != 3)
      throw InputError(source.file, table.lines.front(),
                       "has no third column, expected frequency, real and imaginary part");
    std::vector<std::complex<double>> response;
    for (std::size_t i = 0; i < table.rows(); ++i)
      response.emplace_back(table.columns[1][i], table.columns[2][i]);
    trace = to_trace("real, imaginary", response);
    words.notes.emplace_back("then real and imaginary part");
  } else {
    const MagnitudeScale scale = has_ending(source, ".zma")   ? MagnitudeScale::linear
                                 : has_ending(source, ".frd") ? MagnitudeScale::decibel
                                                              : MagnitudeScale::unknown;
    if (scale != MagnitudeScale::unknown)
      words.notes.emplace_back(scale == MagnitudeScale::linear ? "a .zma file: ohms, 0 dB is 1 ohm"
                                                               : "an .frd file: dB");
    trace.magnitude_db = decibels(source, scale, table.columns[1], words);
    if (table.columns.size() == 3) {
      trace.phase_deg = degrees_of(
          source, "a third column", std::move(table.columns[2]),
          fmt::format("say {0}:deg, {0}:rad, or {0}:ri of real and imaginary part", source.file), words);
      words.notes.emplace_back("third column taken as the phase (real and imaginary part: FILE:ri)");
    }
  }
  return response_columns(source, std::move(words), std::move(table.columns[0]), std::move(trace),
                          std::move(table.lines));
}

/// The columns are u and y where the user gives the sampling rate.
Foreign sampled_record(const Source& source, NumberTable table) {
  if (table.columns.size() > 2)
    throw InputError(
        source.file, table.lines.front(),
        fmt::format("has {} columns and no headings, expected u, or u and y, with a sampling rate",
                    table.columns.size()));
  Words words{"plain table without headings", {}};
  std::vector<double> time = sampled_times(*source.sample_hz, table.rows(), words);
  std::vector<SignalTrace> signals;
  for (std::vector<double>& column : table.columns)
    signals.push_back({fmt::format("column {}", signals.size() + 1), std::move(column)});
  return record_columns(source, std::move(words), std::move(time), std::move(signals), std::move(table.lines),
                        Steps::as_they_are);
}

class PlainTable : public Format {
 public:
  std::string_view name() const override { return "plain table"; }
  bool recognises(const Source& source) const override {
    const auto head = table_head(source);
    return head && head->headings.empty();
  }
  Foreign read(const Source& source) const override {
    NumberTable table = read_table(source, source.sample_hz ? 1 : 2);
    for (const char* known : {"", "ri", "db", "dB", "gain", "ohm", "deg", "rad", "record", "response"}) {
      if (source.choice == known) break;
      if (std::string_view(known) == "response")
        throw InputError(
            source.file, 0,
            fmt::format("has no choice '{}': a table without headings has :db, :gain, :ohm, :deg, :rad, :ri, "
                        ":record and :response",
                        source.choice));
    }
    if (table.unread_line > 0 || !table.headings.empty())
      throw InputError(
          source.file, std::max(table.unread_line, table.lines.front() - 1),
          fmt::format("'{}' right above the numbers is not understood, expected the names of {} columns "
                      "such as frequency_hz,magnitude_db,phase_deg or time_s,u,y",
                      (table.headings.empty() ? table.unread : join(table.headings, ", ")).substr(0, 80),
                      table.columns.size()));
    for (const std::vector<double>& column : table.columns) {
      for (std::size_t row = 0; row < column.size(); ++row) {
        if (std::isnan(column[row]))
          throw InputError(source.file, table.lines[row], "has an empty cell in a table without headings");
      }
    }
    if (source.sample_hz && source.wanted == Content::record) return sampled_record(source, std::move(table));
    const std::string name_in_small = lower_case(source.file);
    const std::size_t dot = name_in_small.rfind(".s");
    if (dot != std::string::npos && name_in_small.ends_with('p') && is_digit(name_in_small[dot + 2]))
      throw InputError(
          source.file, table.lines.front(),
          "begins numbers of a Touchstone file without the option line, expected one such as # GHZ S MA R 50");
    const std::size_t width = table.columns.size();
    if (width > 3)
      throw InputError(
          source.file, table.lines.front(),
          fmt::format("has {} columns and no headings that say what they are, expected two or three or "
                      "a header row such as frequency_hz,magnitude_db,phase_deg or time_s,u,y",
                      width));
    Words words{std::string(name()) + " without headings", {}};
    if (table.decimal_comma) words.notes.emplace_back("decimal commas");
    if (!reads_as_record(source, table)) return plain_response(source, std::move(table), std::move(words));
    words.notes.emplace_back("first column taken as seconds");
    std::vector<SignalTrace> signals{{"column 2", std::move(table.columns[1])}};
    if (width == 3) signals.push_back({"column 3", std::move(table.columns[2])});
    return record_columns(source, std::move(words), std::move(table.columns[0]), std::move(signals),
                          std::move(table.lines), Steps::as_they_are);
  }
};

}  // namespace

BODESMITH_ENTRY(Format, plain_table, PlainTable)

}  // namespace bodesmith::formats
