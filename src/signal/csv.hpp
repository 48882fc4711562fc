#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/provenance.hpp"
#include "signal/formats/text_encoding.hpp"

namespace bodesmith {

/// A CSV file of numbers with a header row. `#` starts a comment (at the beginning of a line), blank lines
/// are passed over, CRLF or LF, UTF-8 with or without byte order mark. Cells end at commas, or at semicolons or tabs
/// when the header has no comma; then decimals may begin with a
/// comma. Values may have prefixes (4k7), columns other words for the same (columns.hpp).
class Csv {
 public:
  /// This program's CSV, or a file of any of the formats in signal/formats/ (told apart by content), converted to the
  /// same columns; `from` then says what was converted. `path` may end with a choice, FILE:CHOICE.
  /// Errors (a cell that is not a finite number, a row of another length, no header, no rows) name file and
  /// line.
  static Csv read(const std::filesystem::path& path, Provenance& from,
                  formats::Content wanted = formats::Content::any);
  static Csv parse(std::string_view text, const std::string& file);

  const std::string& file() const { return file_; }
  const std::vector<std::string>& names() const { return names_; }
  std::size_t rows() const { return columns_.empty() ? 0 : columns_.front().size(); }
  /// Converted from another format.
  bool foreign() const { return !read_as_.empty(); }
  bool has(std::string_view name) const;
  /// Throws InputError naming the header's line when there is no such column.
  const std::vector<double>& column(std::string_view name) const;
  /// Line of the file in which row i stands; 0 in binary files and of samples made of uneven ones.
  int line(std::size_t row) const { return lines_.empty() ? 0 : lines_[row]; }
  int header_line() const { return header_line_; }
  [[noreturn]] void fail(std::size_t row, std::string_view message) const;

 private:
  std::string file_;
  int header_line_ = 0;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
  std::vector<int> lines_;
  std::string read_as_;
  bool decimal_commas_ = false;
};

/// Writes columns of equal length below their names; numbers so that they read back as the same doubles. text()
/// throws InputError when one is not finite.
class CsvWriter {
 public:
  void add(std::string_view name, std::vector<double> values);
  std::string text() const;

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

/// A table row by row, its cells text: names, numbers as number_text() writes them, empty cells. A comma in a
/// cell becomes a semicolon.
class CsvTable {
 public:
  explicit CsvTable(const std::vector<std::string>& names) { add_row(names); }
  void add_row(const std::vector<std::string>& cells);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace bodesmith
