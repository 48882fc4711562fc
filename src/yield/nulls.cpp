#include "yield/nulls.hpp"

#include <algorithm>
#include <cmath>

#include "lti/judged_floor.hpp"

namespace bodesmith::yield {

std::vector<Hertz> leave_out_nulls(const std::vector<Design>& designs, std::vector<Hertz>& grid) {
  std::vector<Hertz> left_out, kept;
  std::vector<double> largest;
  for (const Design& design : designs) {
    largest.push_back(0.0);
    for (const Hertz f : grid) largest.back() = std::max(largest.back(), std::abs(design.reference(f)));
  }
  for (const Hertz f : grid) {
    bool null = false;
    for (std::size_t i = 0; i < designs.size(); ++i)
      null = null || !(std::abs(designs[i].reference(f)) > kJudgedFloor * largest[i]);
    (null ? left_out : kept).push_back(f);
  }
  grid = std::move(kept);
  return left_out;
}

}  // namespace bodesmith::yield
