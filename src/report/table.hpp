#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/plot.hpp"

namespace bodesmith::report {

/// A table of a page. Cells are plain text; `marked` rows are set off (a limit missed, the best choice).
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> marked;
};

/// A row of a table that can be chosen, and what is then shown of it. Every choice of a table has the same plots.
struct Choice {
  std::string name;
  std::vector<std::pair<std::string, std::string>> figures;  ///< value and meaning
  std::vector<Plot> plots;
  std::vector<std::string> notes;                     ///< that must not be missed
  std::vector<std::pair<Table, std::string>> tables;  ///< and their captions
};

}  // namespace bodesmith::report
