#include "fpaa/search/design.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {

bool DesignStage::is_free(std::size_t capacitor) const {
  if (whole || !(c[capacitor] > 0.0)) return false;
  if (is_first()) return capacitor != 2 * from.size();
  return capacitor != kC3 && capacitor != kCA && capacitor != kCB;
}

int Design::opamps() const {
  int out = 0;
  for (const DesignStage& stage : stages) out += stage.opamps();
  return out;
}

void Design::scale_node(std::size_t stage, double factor) {
  for (std::size_t s = stage; s < stages.size(); ++s) {
    DesignStage& at = stages[s];
    for (std::size_t i = 0; i < at.c.size(); ++i) {
      const int input = at.input_of(i);
      if (input < 0) continue;
      if (s == stage) {
        at.c[i] *= factor;
      } else if (at.from[static_cast<std::size_t>(input)] == static_cast<int>(stage)) {
        at.c[i] /= factor;
      }
    }
  }
}

double snapped(double value) {
  constexpr int kBits = 20;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, kBits)), exponent - kBits);
}

}  // namespace bodesmith::fpaa
