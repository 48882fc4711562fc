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

  std::size_t rows() const { return lines.size(); }
};

/// Cells end at tabs, semicolons, commas or blanks, decimals begin with a point or a comma: whichever makes numbers of
/// all rows. Lines that begin with one of * # ! % ; or with // are comments. The headings are the line above the first
/// row (a comment too, if it names a frequency or time) when it has as many cells; a line of units below them is added to
/// them in brackets.
/// InputError names the line of what is not a number, and of a row of another length.
NumberTable read_table(const Source& source);
/// The beginning of such a table with its headings, also of one that is broken further down; nothing where the text
/// does not begin so. Looks at the first lines only and throws nothing.
std::optional<NumberTable> table_head(const Source& source);
bool looks_like_table(const Source& source);

}  // namespace bodesmith::formats
