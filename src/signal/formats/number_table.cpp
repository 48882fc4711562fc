#include "signal/formats/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/formats/headings.hpp"

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

/// Where the cell that begins at `begin` ends: quotation marks that open it hold separators too.
std::size_t end_of_cell(std::string_view line, std::size_t begin, std::string_view separators) {
  std::size_t from = line.find_first_not_of(" \t", begin);
  if (from != std::string_view::npos && line[from] == '"') {
    const std::size_t close = line.find('"', from + 1);
    if (close != std::string_view::npos) begin = close;
  }
  return std::min(line.find_first_of(separators, begin), line.size());
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == ' ') {
    std::size_t at = 0;
    while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos) {
      const std::size_t end = end_of_cell(line, at, " \t");
      cells.push_back(unquoted(line.substr(at, end - at)));
      at = end;
    }
    return;
  }
  for (std::size_t begin = 0;;) {
    const std::size_t end = end_of_cell(line, begin, {&separator, 1});
    cells.push_back(unquoted(line.substr(begin, end - begin)));
    if (end == line.size()) break;
    begin = end + 1;
  }
}

bool cell_number(std::string_view cell, char decimal, double& value) {
  if (cell.empty()) {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  if (decimal == '.') return parse_number(cell, value);
  if (cell.size() > 60 || cell.find('.') != std::string_view::npos) return false;
  char buffer[64];
  std::copy(cell.begin(), cell.end(), buffer);
  std::replace(buffer, buffer + cell.size(), ',', '.');
  return parse_number({buffer, cell.size()}, value);
}

struct Attempt {
  NumberTable table;
  std::vector<std::string_view> raw_above;  ///< one a line of the file
  int broken_line = 0;                      ///< 0: read to its end
  std::string why;
  bool numbers_above =
      false;  ///< a line above the first row begins like a number: perhaps another writing is meant
};

/// "End of Xyce(TM) Simulation": what programs write below the last row.
bool is_closing(std::string_view line) {
  return lower_case(line.substr(0, 7)) == "end of ";
}

/// One row, which has its first number. False when it is not one; then `why` says so.
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

std::size_t cells_used(const std::vector<double>& row) {
  return static_cast<std::size_t>(std::ranges::count_if(row, [](double v) { return !std::isnan(v); }));
}

/// Rows may end with more or fewer separators than the first one.
void fit_empty_end(std::vector<double>& row, std::size_t columns) {
  while (row.size() > columns && std::isnan(row.back())) row.pop_back();
}

/// "1,000", "12.500": one to three digits, a sign between, three digits.
bool is_grouped(std::string_view cell, char sign) {
  const std::size_t at = cell.find(sign);
  return at != std::string_view::npos && at >= 1 && at <= 3 && cell.size() == at + 4 && cell.front() != '0' &&
         std::ranges::all_of(cell, [&](char c) { return is_digit(c) || c == sign; });
}

/// Whether every decimal sign of the rows may as well stand between thousands: "1,000;3", "20,000;-1".
class Grouping {
 public:
  explicit Grouping(const Writing& writing)
      : decimal_(writing.decimal), possible_(writing.separator == ';' || writing.decimal == ',') {}
  void see(const std::vector<std::string_view>& cells) {
    if (!possible_) return;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].find(decimal_) == std::string_view::npos) continue;
      possible_ = i == 0 && is_grouped(cells[i], decimal_);
      if (!possible_) return;
      ++grouped_;
    }
  }
  bool found() const { return possible_ && grouped_ > 0; }

 private:
  char decimal_;
  bool possible_;
  std::size_t grouped_ = 0;
};

Attempt attempt(std::string_view text, const Writing& writing, std::size_t line_limit,
                std::size_t least_columns) {
  Attempt out;
  NumberTable& table = out.table;
  table.decimal_comma = writing.decimal == ',';
  std::vector<std::string_view> cells;
  std::vector<double> row;
  std::string why;
  int number = 0;
  int blank = 0;
  Grouping grouping(writing);
  // A channel alone stands behind the empty cell of the X_Value that its file leaves out.
  const bool one_behind_empty = text.starts_with("LabVIEW Measurement");
  for (std::size_t seen = 0; !text.empty() && seen < line_limit; ++seen) {
    ++number;
    const std::string_view whole = next_line(text), line = trim(whole);
    const bool started = !table.columns.empty();
    if (started && is_closing(line) && trim(text).empty()) break;
    if (line.empty() || is_comment(line)) {
      if (!started) out.raw_above.push_back(line);
      if (line.empty()) ++blank;
      continue;
    }
    // gnuplot's sign of another set of data.
    if (started && blank >= 2) {
      out.broken_line = number;
      out.why = "begins a second block of numbers, expected one in a file";
      return out;
    }
    blank = 0;
    // The last tabs of a line stand between empty cells.
    split_cells(writing.separator == '\t' ? whole : line, writing.separator, cells);
    const bool numbers = parse_row(cells, writing.decimal, row, why);
    if (!started) {
      const bool wide = cells_used(row) >= least_columns || (one_behind_empty && row.size() >= least_columns);
      if (!numbers || !wide) {
        out.numbers_above = out.numbers_above || begins_like_number(line);
        out.raw_above.push_back(line);
        continue;
      }
      table.columns.resize(row.size());
    }
    fit_empty_end(row, table.columns.size());
    if (!numbers || row.size() != table.columns.size()) {
      out.broken_line = number;
      out.why = !numbers ? why
                         : fmt::format("has {} cells, expected {} as in the rows above", row.size(),
                                       table.columns.size());
      return out;
    }
    grouping.see(cells);
    for (std::size_t i = 0; i < row.size(); ++i) table.columns[i].push_back(row[i]);
    table.lines.push_back(number);
  }
  if (table.columns.empty()) return out;
  // A first column may be empty, or full.
  const std::vector<double>& first = table.columns.front();
  const auto empty = [](double v) { return std::isnan(v); };
  if (const auto at = std::ranges::find_if(first, empty);
      at != first.end() && !std::ranges::all_of(first, empty)) {
    out.broken_line = table.lines[static_cast<std::size_t>(at - first.begin())];
    out.why = "has no first number";
  }
  if (grouping.found()) {
    out.broken_line = table.lines.front();
    out.why = fmt::format(
        "begins numbers in which '{}' may be a decimal sign or stand between thousands: write 1000 without it",
        writing.decimal);
  }
  return out;
}

/// Comments are remarks unless they name what numbers are: a unit, a quantity.
bool names_quantities(std::string_view comment) {
  static constexpr std::string_view kQuantities[] = {"freq", "frequency", "time", "phase",
                                                     "mag",  "magnitude", "gain", "real",
                                                     "imag", "re",        "im",   "amplitude"};
  for (std::size_t at = 0; at < comment.size();) {
    const std::size_t begin = comment.find_first_not_of(" \t,;:=()[]/*#!%_\"", at);
    if (begin == std::string_view::npos) return false;
    at = std::min(comment.find_first_of(" \t,;:=()[]/*#!%_\"", begin), comment.size());
    const std::string word = lower_case(comment.substr(begin, at - begin));
    if (std::find(std::begin(kQuantities), std::end(kQuantities), word) != std::end(kQuantities)) return true;
    // Single letters (s, V, A), "us" and "second" are words of remarks too.
    if (word.size() > 1 && word.size() <= 4 && word != "us" &&
        is_unit_alone(std::string(comment.substr(begin, at - begin))))
      return true;
  }
  return false;
}

bool is_ornament(std::string_view line) {
  return std::ranges::none_of(
      line, [](char c) { return is_letter_or_digit(c) || static_cast<unsigned char>(c) > 0x7f; });
}

bool begins_bracket(std::string_view cell) {
  return cell.starts_with('(') || cell.starts_with('[');
}

/// "[um]", "dB", "#": a cell of a line of units; at least one of them is a unit that is known.
bool is_unit_line(const std::vector<std::string>& cells) {
  return std::ranges::any_of(cells, is_unit_alone) && std::ranges::all_of(cells, [](const std::string& cell) {
           return cell.empty() || cell == "#" || cell == "-" || begins_bracket(cell) || is_unit_alone(cell);
         });
}

std::vector<std::string> heading_cells(std::string_view line, char separator) {
  while (!line.empty() && is_comment(line)) line.remove_prefix(1);
  line = trim(line);
  std::vector<std::string> out;
  for (const std::string_view cell : formats::split_cells(line, separator)) {
    // "Freq (Hz)" between blanks is one heading.
    if (separator == ' ' && !out.empty() && begins_bracket(cell) && !begins_bracket(out.back())) {
      out.back() += " " + std::string(cell);
    } else {
      out.emplace_back(cell);
    }
  }
  while (out.size() > 1 && out.back().empty()) out.pop_back();
  return out;
}

/// Next to the names of columns: "t0 = -0.005" (Rigol), "Comment" (LabVIEW).
bool is_note_among_headings(const std::string& cell) {
  return cell.find('=') != std::string::npos || cell == "Comment";
}

/// Names between two blanks and more: "Frequency / MHz        S1,1/abs,dB" (CST).
std::vector<std::string> widely_spaced(std::string_view line) {
  std::vector<std::string> out;
  line = trim(line);
  while (!line.empty()) {
    const std::size_t end = std::min(line.find("  "), line.size());
    out.emplace_back(unquoted(line.substr(0, end)));
    line = trim(line.substr(end));
  }
  return out;
}

/// As many headings as columns, by the rows' own separator or another. Above a line of units channels may be numbers.
std::vector<std::string> headings_in(std::string_view line, char separator, std::size_t columns,
                                     bool above_units) {
  constexpr char kWide = 'w';
  for (const char by : {separator, kWide, ',', ';', '\t', ' '}) {
    std::vector<std::string> cells = by == kWide ? widely_spaced(line) : heading_cells(line, by);
    // Gamry's units: "#<tab>s<tab>Hz"; the mark is a cell like the others.
    if (cells.size() + 1 == columns && by != ' ' && line.size() > 1 && line[0] == '#' && line[1] == by)
      cells.insert(cells.begin(), "#");
    while (cells.size() > columns && is_note_among_headings(cells.back())) cells.pop_back();
    if (cells.size() != columns) continue;
    const auto end = above_units ? cells.begin() + 1 : cells.end();
    if (std::none_of(cells.begin(), end, [](const std::string& c) { return begins_like_number(c); }))
      return cells;
  }
  return {};
}

/// Columns in which every cell is empty go; those at the end before headings are counted.
void drop_empty_columns(NumberTable& table, bool at_end_only) {
  for (std::size_t c = table.columns.size(); c-- > 0;) {
    const auto& column = table.columns[c];
    if (!std::ranges::all_of(column, [](double v) { return std::isnan(v); })) {
      if (at_end_only) return;
      continue;
    }
    table.columns.erase(table.columns.begin() + static_cast<std::ptrdiff_t>(c));
    if (c < table.headings.size())
      table.headings.erase(table.headings.begin() + static_cast<std::ptrdiff_t>(c));
  }
}

/// LabVIEW says above what its X_Value is, and the units of the others.
void name_labview_columns(const std::vector<std::string_view>& above, std::vector<std::string>& headings) {
  if (headings.empty() || headings.front() != "X_Value") return;
  std::vector<std::string_view> units;
  bool over_time = false;
  for (const std::string_view line : above) {
    over_time = over_time || line.starts_with("X_Dimension\tTime");
    if (line.starts_with("Y_Unit_Label\t")) units = split(line, '\t');
  }
  std::size_t signal = 0;
  for (std::string& heading : headings) {
    if (heading == "X_Value") {
      if (over_time) heading = "Time (s)";
    } else if (++signal < units.size() && !trim(units[signal]).empty()) {
      heading += fmt::format(" ({})", trim(units[signal]));
    }
  }
}

void find_headings(Attempt& found, char separator) {
  NumberTable& table = found.table;
  drop_empty_columns(table, true);
  std::vector<std::string> units;
  for (std::size_t line_number = found.raw_above.size(); line_number > 0; --line_number) {
    const std::string_view line = found.raw_above[line_number - 1];
    if (is_ornament(line) || line == "End Comments") continue;
    std::vector<std::string> cells = headings_in(line, separator, table.columns.size(), !units.empty());
    if (is_comment(line)) {
      // Prose may have as many words as the table columns.
      const std::vector<Heading> meant = parse_headings(cells);
      if (cells.empty() || (!has_response_headings(meant) && !has_record_headings(meant))) {
        if (!names_quantities(line)) continue;
        cells.clear();
      }
    }
    if (cells.empty()) {
      table.unread_line = static_cast<int>(line_number);
      table.unread = line;
      break;
    }
    if (units.empty() && is_unit_line(cells)) {
      units = std::move(cells);
      continue;
    }
    for (std::size_t i = 0; i < units.size(); ++i) {
      if (units[i].empty() || units[i] == "#" || units[i] == "-") continue;
      cells[i] += begins_bracket(units[i]) ? " " + units[i] : " (" + units[i] + ")";
    }
    table.headings = std::move(cells);
    break;
  }
  name_labview_columns(found.raw_above, table.headings);
  // "# Hz dB deg": the units say what the columns are.
  if (table.headings.empty()) table.headings = std::move(units);
  if (!table.headings.empty()) table.unread_line = 0;
  drop_empty_columns(table, false);
  for (const std::string_view line : found.raw_above) table.above.emplace_back(line);
}

struct Best {
  Attempt found;
  char separator = 0;
};
/// The writing that makes most rows; the one that got furthest where none reads to the end.
std::optional<Best> best_attempt(std::string_view text, std::size_t line_limit,
                                 std::size_t least_columns = 2) {
  std::optional<Best> best;
  for (const Writing& writing : kWritings) {
    Attempt found = attempt(text, writing, line_limit, least_columns);
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

std::vector<std::string_view> split_cells(std::string_view line, char separator) {
  std::vector<std::string_view> out;
  split_cells(line, separator, out);
  return out;
}

NumberTable read_table(const Source& source, std::size_t least_columns) {
  auto best = best_attempt(source.text, static_cast<std::size_t>(-1), least_columns);
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
