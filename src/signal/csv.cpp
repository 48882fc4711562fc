#include "signal/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/columns.hpp"
#include "signal/csv_rows.hpp"
#include "signal/formats/format.hpp"

namespace bodesmith {
namespace {

/// The text of some rows.
class RowsText {
 public:
  void write(const std::vector<std::vector<double>>& columns, std::size_t from, std::size_t to) {
    // -1.7976931348623157e+308 and what separates it from the next.
    constexpr std::size_t kLongestCell = 25;
    const std::size_t capacity = (to - from) * columns.size() * kLongestCell;
    if (capacity > capacity_) bytes_ = std::make_unique_for_overwrite<char[]>(capacity);
    capacity_ = std::max(capacity_, capacity);
    char* p = bytes_.get();
    for (std::size_t row = from; row < to; ++row) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (c > 0) *p++ = ',';
        p = std::to_chars(p, p + kLongestCell, columns[c][row]).ptr;
      }
      *p++ = '\n';
    }
    size_ = static_cast<std::size_t>(p - bytes_.get());
  }
  std::size_t size() const { return size_; }
  std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t capacity_ = 0;
  std::size_t size_ = 0;
};

char separator_of(std::string_view header) {
  if (header.find(',') != std::string_view::npos) return ',';
  if (header.find(';') != std::string_view::npos) return ';';
  return header.find('\t') != std::string_view::npos ? '\t' : ',';
}

std::string_view unquoted_name(std::string_view cell) {
  cell = trim(cell);
  return cell.size() >= 2 && cell.front() == '"' && cell.back() == '"' ? cell.substr(1, cell.size() - 2)
                                                                       : cell;
}

/// Whether the first line that is no comment names columns as this program does; without times where the user gives the
/// sampling rate.
bool has_own_header(std::string_view text, bool times_given) {
  while (!text.empty()) {
    const std::string_view line = trim(next_line(text));
    if (line.empty() || line.front() == '#') continue;
    bool time = false;
    bool frequency = false;
    bool signal = false;
    bool magnitude = false;
    for (const std::string_view cell : split(line, separator_of(line))) {
      const std::string_view name = unquoted_name(cell);
      // A count of rows without a name, a separator at the end: a table of another program. A phase without a unit may be
      // radians, which its reader looks at.
      if (name.empty() || lower_case(name) == "phase") return false;
      time = time || name == column::time_s;
      frequency = frequency || name == column::frequency_hz;
      signal = signal || name == column::input || name == column::output || name == column::reference;
      magnitude = magnitude || name == column::gain || name == column::magnitude_db;
    }
    return ((time || times_given) && signal) || (frequency && magnitude);
  }
  return false;
}

/// The file and the choice in FILE:CHOICE: the shortest beginning up to a colon that is a file.
std::pair<std::filesystem::path, std::string> split_path(const std::filesystem::path& path) {
  const std::string text = path.string();
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return {path, ""};
  for (std::size_t colon = text.find(':'); colon != std::string::npos; colon = text.find(':', colon + 1)) {
    const std::filesystem::path file = text.substr(0, colon);
    if (std::filesystem::exists(file, ignored) && !std::filesystem::is_directory(file, ignored))
      return {file, text.substr(colon + 1)};
  }
  return {path, ""};
}

bool parse_cell(std::string_view cell, bool comma_allowed, double& value, bool& comma) {
  if (parse_number(cell, value)) return true;
  cell = trim(cell);
  const std::size_t at = cell.find(',');
  if (!comma_allowed || at == std::string_view::npos || cell.find('.') != std::string_view::npos)
    return false;
  std::string with_point(cell);
  with_point[at] = '.';
  comma = parse_number(with_point, value) || comma;
  return parse_number(with_point, value);
}

}  // namespace

Csv Csv::read(const std::filesystem::path& path, Provenance& from, formats::Content wanted) {
  const auto [file, choice] = split_path(path);
  const std::string bytes = from.read(file);
  const std::string text = formats::to_utf8(bytes);
  const auto own = [&, name = file.string()] {
    Csv csv = parse(text, name);
    if (csv.decimal_commas_) from.inputs.back().read_as = "CSV with decimal commas";
    return csv;
  };
  if (choice.empty() && has_own_header(text, from.sample_hz.has_value())) return own();
  const formats::Source source{file.string(), bytes, text, choice, wanted, from.sample_hz};
  const formats::Format* format = formats::format_of(source);
  if (format == nullptr) {
    if (bytes.find('\0') != std::string::npos)
      throw InputError(file.string(), 0,
                       "is a binary file of no format that is known here (docs/formats.md)");
    if (!choice.empty())
      throw InputError(file.string(), 0, fmt::format("has no choice '{}': its format is not known", choice));
    return own();
  }
  formats::Foreign foreign = format->read(source);
  Csv csv;
  csv.file_ = file.string();
  csv.names_ = std::move(foreign.names);
  csv.columns_ = std::move(foreign.columns);
  csv.lines_ = std::move(foreign.lines);
  // Names in binary files may be of any encoding, damaged ones of any bytes.
  for (char& c : foreign.read_as) {
    if (static_cast<unsigned char>(c) < 0x20) c = '?';
  }
  csv.read_as_ = formats::to_utf8(foreign.read_as);
  from.inputs.back().read_as = csv.read_as_;
  return csv;
}

Csv Csv::parse(std::string_view text, const std::string& file) {
  Csv csv;
  csv.file_ = file;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  int line_number = 0;
  char separator = ',';
  while (!text.empty()) {
    ++line_number;
    const std::string_view line = trim(next_line(text));
    if (line.empty() || line.front() == '#') continue;
    // Spreadsheets of some countries separate by semicolons.
    if (csv.names_.empty()) separator = separator_of(line);
    std::vector<std::string_view> cells = split(line, separator);
    for (std::string_view& cell : cells) cell = unquoted_name(cell);
    if (csv.names_.empty()) {
      csv.header_line_ = line_number;
      for (const std::string_view cell : cells) {
        double number = 0.0;
        if (cell.empty() || parse_number(cell, number)) {
          throw InputError(
              file, line_number,
              fmt::format("'{}' is not a column name, expected a header row such as time_s,u,y", cell));
        }
        if (std::ranges::find(csv.names_, cell) != csv.names_.end()) {
          throw InputError(file, line_number, fmt::format("column '{}' is named twice", cell));
        }
        csv.names_.emplace_back(cell);
      }
      csv.columns_.resize(csv.names_.size());
      // Nearly always all that follows; a line of any other kind is left to this loop, which knows what to say.
      const PlainRows plain = read_plain_rows(text, separator, line_number + 1, csv.columns_, csv.lines_);
      text.remove_prefix(plain.bytes);
      line_number += plain.lines;
      continue;
    }
    if (cells.size() != csv.names_.size()) {
      throw InputError(
          file, line_number,
          fmt::format("has {} cells, expected {} as in the header", cells.size(), csv.names_.size()));
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = 0.0;
      if (!parse_cell(cells[i], separator != ',', value, csv.decimal_commas_) &&
          !parse_quantity(cells[i], value)) {
        throw InputError(file, line_number,
                         fmt::format("'{}' in column '{}' is not a finite number",
                                     trim(cells[i]).substr(0, 40), csv.names_[i]));
      }
      csv.columns_[i].push_back(value);
    }
    csv.lines_.push_back(line_number);
  }
  if (csv.names_.empty())
    throw InputError(file, 0, "has no header row, expected column names such as time_s,u,y");
  if (csv.lines_.empty()) throw InputError(file, csv.header_line_, "has no rows below the header");
  // Under the program's own word too, where the file does not have that one itself.
  const std::size_t given = csv.names_.size();
  for (std::size_t i = 0; i < given; ++i) {
    const ColumnWord word = column_word(csv.names_[i]);
    if (csv.has(word.name)) continue;
    csv.names_.push_back(word.name);
    csv.columns_.push_back(csv.columns_[i]);
    for (double& value : csv.columns_.back()) value *= word.scale;
  }
  return csv;
}

namespace {

/// Columns that were misspelt, such as time_s as times_s: named where one stands in the place of the one that lacks.
std::string column_meant(std::string_view name, const std::vector<std::string>& found) {
  const auto near = nearest_word(name, found);
  return near ? fmt::format(" (did you mean it by '{}'?)", *near) : std::string();
}

}  // namespace

bool Csv::has(std::string_view name) const {
  return std::ranges::find(names_, name) != names_.end();
}

const std::vector<double>& Csv::column(std::string_view name) const {
  const auto at = std::ranges::find(names_, name);
  if (at == names_.end() && foreign() && (name == column::frequency_hz || name == column::time_s)) {
    throw InputError(file_, 0,
                     fmt::format("is a {} ({}), expected a {}",
                                 name == column::time_s ? "frequency response" : "time record", read_as_,
                                 name == column::time_s ? "time record" : "frequency response"));
  }
  if (at == names_.end()) {
    throw InputError(
        file_, header_line_,
        fmt::format("has no column '{}', found: {}{}", name, join(names_, ", "), column_meant(name, names_)));
  }
  return columns_[static_cast<std::size_t>(at - names_.begin())];
}

void Csv::fail(std::size_t row, std::string_view message) const {
  if (!lines_.empty()) throw InputError(file_, lines_[row], message);
  throw InputError(file_, 0, fmt::format("point {}: {}", row + 1, message));
}

void CsvWriter::add(std::string_view name, std::vector<double> values) {
  if (!columns_.empty() && columns_.front().size() != values.size()) {
    throw std::logic_error(fmt::format("CSV columns of different length: {}", name));
  }
  names_.emplace_back(name);
  columns_.push_back(std::move(values));
}

std::string CsvWriter::text() const {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    for (const double value : columns_[c]) {
      if (!std::isfinite(value))
        throw InputError(fmt::format(
            "the result in column '{}' is not a finite number: inputs whose numbers double precision cannot hold",
            names_[c]));
    }
  }
  std::string out = join(names_, ",") + "\n";
  const std::size_t rows = columns_.empty() ? 0 : columns_.front().size();
  // Pieces of rows side by side, a few at a time: the text stands twice in memory only for those.
  constexpr std::size_t kRows = 16384;
  constexpr std::size_t kPieces = 16;
  const std::size_t pieces = (rows + kRows - 1) / kRows;
  std::vector<RowsText> texts(std::min(pieces, kPieces));
  const int threads = thread_count(0);
  for (std::size_t done = 0; done < pieces; done += kPieces) {
    const std::size_t now = std::min(kPieces, pieces - done);
    parallel_for(now, threads, [&](std::size_t i) {
      const std::size_t first = (done + i) * kRows;
      texts[i].write(columns_, first, std::min(rows, first + kRows));
    });
    if (done == 0) out.reserve(out.size() + (texts[0].size() + texts[0].size() / 8) * pieces);
    for (std::size_t i = 0; i < now; ++i) out += texts[i].view();
  }
  return out;
}

void CsvTable::add_row(const std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text_ += ',';
    for (const char c : cells[i]) text_ += c == ',' ? ';' : c;
  }
  text_ += '\n';
}

}  // namespace bodesmith
