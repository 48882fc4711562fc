#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace bodesmith {

/// How far read_plain_rows() came.
struct PlainRows {
  std::size_t bytes = 0;  ///< of the text, up to the beginning of a line
  int lines = 0;
};

/// Reads rows of `columns.size()` finite numbers, blank lines and comments, for as long as a text holds nothing
/// else: the values go behind those in `columns`, the number of each row's line (the first one's is `first_line`)
/// behind those in `lines`. It stops at the beginning of the first line that is anything else.
/// Texts of more than a megabyte are read in pieces side by side; the outcome does not depend on that.
PlainRows read_plain_rows(std::string_view text, char separator, int first_line,
                          std::vector<std::vector<double>>& columns, std::vector<int>& lines);

}  // namespace bodesmith
