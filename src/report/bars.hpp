#pragma once

#include <string>
#include <vector>

namespace bodesmith::report {

/// Horizontal bars in groups of one a name, below one another; `names` are the legend.
struct Bars {
  std::string title;
  std::string axis;  ///< what the values are; bars begin at 0
  std::vector<std::string> names;
  struct Group {
    std::string label;
    std::vector<double> values;      ///< one a name; what is not finite is left out
    std::vector<std::string> texts;  ///< what stands behind each bar
  };
  std::vector<Group> groups;
  double line = 0.0;  ///< a dashed line across all of them, called line_name; 0: none
  std::string line_name;
};

/// As one `svg` element that stands on its own.
std::string to_svg(const Bars& bars);

}  // namespace bodesmith::report
