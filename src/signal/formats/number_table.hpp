#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "signal/formats/format.hpp"

namespace bodesmith::formats {

/// Rows of numbers in a text, and what stands above them.
struct NumberTable {
  std::vector<std::string> above;     ///< lines above the first row, comments and blank ones too, trimmed
  std::vector<std::string> headings;  ///< one a column, or none
  std::vector<std::vector<double>> columns;
  std::vector<int> lines;  ///< of each row
  bool decimal_comma = false;
  int unread_line = 0;  ///< of a heading or option right above the numbers that is not understood; 0: none
  std::string unread;   ///< that line

  std::size_t rows() const { return lines.size(); }
};

/// Cells end at tabs, semicolons, commas or blanks (not within quotation marks), decimals begin with a point or a comma:
/// whichever makes numbers of all rows. Lines that begin with one of * # ! % ; or with // are comments. The headings are
/// the line above the first row (a comment too, if it names a frequency or time) when it has as many cells; a line of
/// units below them is added to them in brackets. A line there that is none, unless it is a remark, is `unread`: what it
/// says of the numbers is not known, so they cannot be guessed. An empty cell is a NaN; columns of nothing else go.
/// InputError names the line of what is not a number, and of a row of another length.
NumberTable read_table(const Source& source, std::size_t least_columns = 2);
/// The beginning of such a table with its headings, also of one that is broken further down; nothing where the text
/// does not begin so. Looks at the first lines only and throws nothing.
std::optional<NumberTable> table_head(const Source& source);
bool looks_like_table(const Source& source);

/// The cells of a line; within quotation marks a separator is none, and they go. ' ': any run of blanks and tabs.
std::vector<std::string_view> split_cells(std::string_view line, char separator);

}  // namespace bodesmith::formats
