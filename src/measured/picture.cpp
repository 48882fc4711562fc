#include "measured/picture.hpp"

namespace bodesmith::measured {

std::string GapPicture::svg() const {
  using report::Series;
  const auto plot = [&](const std::string& title, const Series& first, const Series& second) {
    report::Plot out;
    out.title = title;
    out.x = {x_label, logarithmic};
    out.y = {"%"};
    out.series = {first, second};
    return out;
  };
  std::vector<report::Plot> all = {
      plot("Measured less predicted", {"as it was designed", x, gap}, {"with what was found", x, left})};
  if (!before.empty()) all.push_back(plot(what, {"measured", x, before}, {"predicted of next/", x, after}));
  return report::stack_svg(all);
}

}  // namespace bodesmith::measured
