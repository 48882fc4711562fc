#include "signal/formats/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/formats/headings.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

/// How a table is written.
struct Writing {
  char separator;  ///< ' ': any run of blanks and tabs
  char decimal;
};
constexpr Writing kWritings[] = {{'\t', '.'}, {';', '.'}, {',', '.'}, {' ', '.'},
                                 {'\t', ','}, {';', ','}, {' ', ','}};
constexpr std::size_t kLinesLookedAt = 400;

bool is_comment(std::string_view line) {
  return line.find_first_of("*#!%;") == 0 || line.substr(0, 2) == "//";
}

bool begins_like_number(std::string_view line) {
  const std::size_t at = line.find_first_not_of("+-.,");
  return at != std::string_view::npos && at <= 2 && line[at] >= '0' && line[at] <= '9';
}

std::string_view unquoted(std::string_view cell) {
  cell = trim(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
  return trim(cell);
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator != ' ') {
    std::size_t begin = 0;
    while (true) {
      const std::size_t end = line.find(separator, begin);
      cells.push_back(unquoted(line.substr(begin, end == std::string_view::npos ? end : end - begin)));
      if (end == std::string_view::npos) break;
      begin = end + 1;
    }
    if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
    return;
  }
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    cells.push_back(unquoted(line.substr(at, end - at)));
    at = end;
  }
}

bool cell_number(std::string_view cell, char decimal, double& value) {
  if (decimal == '.') return parse_number(cell, value);
  if (cell.size() > 60 || cell.find('.') != std::string_view::npos) return false;
  char buffer[64];
  std::copy(cell.begin(), cell.end(), buffer);
  std::replace(buffer, buffer + cell.size(), ',', '.');
  return parse_number({buffer, cell.size()}, value);
}

struct Attempt {
  NumberTable table;
  std::vector<std::string_view> raw_above;
  int broken_line = 0;  ///< 0: read to its end
  std::string why;
  bool numbers_above =
      false;  ///< a line above the first row begins like a number: perhaps another writing is meant
};

/// One row. False when it is not one; then `why` says so.
bool parse_row(const std::vector<std::string_view>& cells, char decimal, std::vector<double>& row,
               std::string& why) {
  row.clear();
  for (const std::string_view cell : cells) {
    double value = 0.0;
    if (!cell_number(cell, decimal, value)) {
      why = fmt::format("'{}' is not a finite number", cell.substr(0, 40));
      return false;
    }
    row.push_back(value);
  }
  return true;
}

Attempt attempt(std::string_view text, const Writing& writing, std::size_t line_limit) {
  Attempt out;
  NumberTable& table = out.table;
  table.decimal_comma = writing.decimal == ',';
  std::vector<std::string_view> cells;
  std::vector<double> row;
  std::string why;
  int number = 0;
  for (std::size_t seen = 0; !text.empty() && seen < line_limit; ++seen) {
    ++number;
    const std::size_t end = text.find('\n');
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const bool started = !table.columns.empty();
    if (line.empty() || is_comment(line)) {
      if (!started) out.raw_above.push_back(line);
      continue;
    }
    split_cells(line, writing.separator, cells);
    const bool numbers = parse_row(cells, writing.decimal, row, why);
    if (!started) {
      if (!numbers || cells.size() < 2) {
        out.numbers_above = out.numbers_above || begins_like_number(line);
        out.raw_above.push_back(line);
        continue;
      }
      table.columns.resize(row.size());
    } else if (!numbers || row.size() != table.columns.size()) {
      out.broken_line = number;
      out.why = !numbers ? why
                         : fmt::format("has {} cells, expected {} as in the rows above", row.size(),
                                       table.columns.size());
      return out;
    }
    for (std::size_t i = 0; i < row.size(); ++i) table.columns[i].push_back(row[i]);
    table.lines.push_back(number);
  }
  return out;
}

std::vector<std::string> heading_cells(std::string_view line, char separator) {
  while (!line.empty() && is_comment(line)) line.remove_prefix(1);
  line = trim(line);
  std::vector<std::string_view> cells;
  split_cells(line, separator, cells);
  std::vector<std::string> out;
  for (const std::string_view cell : cells) {
    // "Freq (Hz)" between blanks is one heading.
    if (separator == ' ' && !out.empty() && (cell.starts_with('(') || cell.starts_with('['))) {
      out.back() += " " + std::string(cell);
    } else {
      out.emplace_back(cell);
    }
  }
  return out;
}

/// As many headings as columns, by the rows' own separator or another.
std::vector<std::string> headings_in(std::string_view line, char separator, std::size_t columns) {
  for (const char by : {separator, ',', ';', '\t', ' '}) {
    std::vector<std::string> cells = heading_cells(line, by);
    if (cells.size() != columns) continue;
    if (std::none_of(cells.begin(), cells.end(), [](const std::string& c) { return begins_like_number(c); }))
      return cells;
  }
  return {};
}

void find_headings(Attempt& found, char separator) {
  NumberTable& table = found.table;
  std::vector<std::string> units;
  for (std::size_t back = 1; back <= found.raw_above.size(); ++back) {
    const std::string_view line = found.raw_above[found.raw_above.size() - back];
    if (line.empty() || line == "*" || line == "#") continue;
    std::vector<std::string> cells = headings_in(line, separator, table.columns.size());
    if (cells.empty()) break;
    if (is_comment(line)) {
      // Prose may have as many words as the table columns.
      const std::vector<Heading> meant = parse_headings(cells);
      if (!has_response_headings(meant) && !has_record_headings(meant)) break;
    }
    if (units.empty() && std::all_of(cells.begin(), cells.end(), is_unit_alone)) {
      units = std::move(cells);
      continue;
    }
    for (std::size_t i = 0; i < units.size(); ++i) {
      cells[i] += units[i].starts_with('(') ? " " + units[i] : " (" + units[i] + ")";
    }
    table.headings = std::move(cells);
    break;
  }
  // "# Hz dB deg": the units say what the columns are.
  if (table.headings.empty()) table.headings = std::move(units);
  for (const std::string_view line : found.raw_above) table.above.emplace_back(line);
}

struct Best {
  Attempt found;
  char separator = 0;
};
/// The writing that makes most rows; the one that got furthest where none reads to the end.
std::optional<Best> best_attempt(std::string_view text, std::size_t line_limit) {
  std::optional<Best> best;
  for (const Writing& writing : kWritings) {
    Attempt found = attempt(text, writing, line_limit);
    if (found.table.columns.empty()) continue;
    const bool whole = found.broken_line == 0;
    const bool certain = whole && !found.numbers_above;
    const auto rank = [](const Attempt& a) { return std::pair(a.broken_line == 0, a.table.rows()); };
    if (!best || rank(found) > rank(best->found)) best = Best{std::move(found), writing.separator};
    if (certain) break;
  }
  return best;
}

}  // namespace

NumberTable read_table(const Source& source) {
  auto best = best_attempt(source.text, static_cast<std::size_t>(-1));
  if (!best) throw InputError(source.file, 0, "has no rows of numbers");
  if (best->found.broken_line > 0) throw InputError(source.file, best->found.broken_line, best->found.why);
  find_headings(best->found, best->separator);
  return std::move(best->found.table);
}

std::optional<NumberTable> table_head(const Source& source) {
  if (source.text.substr(0, 4096).find('\0') != std::string_view::npos) return std::nullopt;
  auto best = best_attempt(source.text, kLinesLookedAt);
  if (!best || best->found.table.columns.size() < 2) return std::nullopt;
  find_headings(best->found, best->separator);
  return std::move(best->found.table);
}

bool looks_like_table(const Source& source) {
  return table_head(source).has_value();
}

}  // namespace bodesmith::formats
