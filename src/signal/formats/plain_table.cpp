// Two or three columns of numbers and nothing that says what they are: frequency, magnitude, phase where a response is
// wanted (FRD and ZMA files are that), time, input, output where a record is. FILE:ri takes three columns as frequency,
// real and imaginary part (ngspice's wrdata), FILE:db, FILE:gain and FILE:ohm say the unit of the magnitude.
#include <fmt/format.h>

#include <complex>

#include "base/error.hpp"
#include "signal/formats/all_formats.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

/// A record begins at or before 0, or has even steps; frequencies are above 0 and spread.
bool reads_as_record(const Source& source, const NumberTable& table) {
  if (source.wanted != Content::any) return source.wanted == Content::record;
  const std::vector<double>& axis = table.columns.front();
  if (axis.front() <= 0.0) return true;
  if (axis.size() < 3) return false;
  const double step = (axis.back() - axis.front()) / static_cast<double>(axis.size() - 1);
  for (std::size_t i = 1; i < axis.size(); ++i) {
    if (std::abs(axis[i] - axis[i - 1] - step) > 0.01 * std::abs(step)) return false;
  }
  return true;
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
    trace.magnitude_db = decibels(source, MagnitudeScale::unknown, table.columns[1], words);
    if (table.columns.size() == 3) {
      trace.phase_deg = std::move(table.columns[2]);
      words.notes.emplace_back(
          "third column taken as the phase in degrees (real and imaginary part: FILE:ri)");
    }
  }
  return response_columns(source, std::move(words), std::move(table.columns[0]), std::move(trace),
                          std::move(table.lines));
}

class PlainTable : public Format {
 public:
  std::string_view name() const override { return "plain table"; }
  bool recognises(const Source& source) const override {
    const auto head = table_head(source);
    return head && head->headings.empty();
  }
  Foreign read(const Source& source) const override {
    NumberTable table = read_table(source);
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

const Format& plain_table() {
  static const PlainTable format;
  return format;
}

}  // namespace bodesmith::formats
