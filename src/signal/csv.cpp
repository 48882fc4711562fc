#include "signal/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith {

Csv Csv::read(const std::filesystem::path& path, Provenance& from) {
  return parse(from.read(path), path.string());
}

Csv Csv::parse(std::string_view text, const std::string& file) {
  Csv csv;
  csv.file_ = file;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  int line_number = 0;
  char separator = ',';
  while (!text.empty()) {
    ++line_number;
    const std::size_t end = text.find('\n');
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    // Spreadsheets of some countries separate by semicolons.
    if (csv.names_.empty() && line.find(',') == std::string_view::npos &&
        line.find(';') != std::string_view::npos)
      separator = ';';
    const std::vector<std::string_view> cells = split(line, separator);
    if (csv.names_.empty()) {
      csv.header_line_ = line_number;
      for (std::string_view cell : cells) {
        cell = trim(cell);
        if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
          cell = cell.substr(1, cell.size() - 2);
        double number = 0.0;
        if (cell.empty() || parse_number(cell, number)) {
          throw InputError(
              file, line_number,
              fmt::format("'{}' is not a column name, expected a header row such as time_s,u,y", cell));
        }
        if (std::find(csv.names_.begin(), csv.names_.end(), cell) != csv.names_.end()) {
          throw InputError(file, line_number, fmt::format("column '{}' is named twice", cell));
        }
        csv.names_.emplace_back(cell);
      }
      csv.columns_.resize(csv.names_.size());
      continue;
    }
    if (cells.size() != csv.names_.size()) {
      throw InputError(
          file, line_number,
          fmt::format("has {} cells, expected {} as in the header", cells.size(), csv.names_.size()));
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = 0.0;
      if (!parse_number(cells[i], value)) {
        throw InputError(file, line_number,
                         fmt::format("'{}' in column '{}' is not a finite number{}",
                                     trim(cells[i]).substr(0, 40), csv.names_[i],
                                     separator == ';' && cells[i].find(',') != std::string_view::npos
                                         ? ", expected a point before the decimals"
                                         : ""));
      }
      csv.columns_[i].push_back(value);
    }
    csv.lines_.push_back(line_number);
  }
  if (csv.names_.empty())
    throw InputError(file, 0, "has no header row, expected column names such as time_s,u,y");
  if (csv.lines_.empty()) throw InputError(file, csv.header_line_, "has no rows below the header");
  return csv;
}

bool Csv::has(std::string_view name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

const std::vector<double>& Csv::column(std::string_view name) const& {
  const auto at = std::find(names_.begin(), names_.end(), name);
  if (at == names_.end()) {
    throw InputError(file_, header_line_,
                     fmt::format("has no column '{}', found: {}", name, join(names_, ", ")));
  }
  return columns_[static_cast<std::size_t>(at - names_.begin())];
}

std::vector<double> Csv::column(std::string_view name) && {
  return std::as_const(*this).column(name);
}

void Csv::fail(std::size_t row, std::string_view message) const {
  throw InputError(file_, lines_[row], message);
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
  out.reserve(out.size() + rows * columns_.size() * 20);
  char buffer[40];
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (c > 0) out += ',';
      const auto result = std::to_chars(buffer, buffer + sizeof buffer, columns_[c][row]);
      out.append(buffer, result.ptr);
    }
    out += '\n';
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
