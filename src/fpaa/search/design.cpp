#include "fpaa/search/design.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {

bool DesignStage::is_vendors() const {
  if (is_first()) return from.size() == 1;
  return (c[kC1] > 0.0) + (c[kCp] > 0.0) + (c[kCpp] > 0.0) == 1 && c1_inverting;
}

int DesignStage::capacitor_count() const {
  return static_cast<int>(std::count_if(c.begin(), c.end(), [](double v) { return v > 0.0; }));
}

bool DesignStage::is_free(std::size_t capacitor) const {
  if (whole || !(c[capacitor] > 0.0)) return false;
  if (is_first()) return capacitor != 2 * from.size();
  return capacitor != kC3 && capacitor != kCA && capacitor != kCB;
}

int DesignStage::input_of(std::size_t capacitor) const {
  if (!is_first()) return capacitor <= kCpp ? 0 : -1;
  return capacitor < 2 * from.size() ? static_cast<int>(capacitor / 2) : -1;
}

bool DesignStage::may_be_left_out(std::size_t capacitor) const {
  const int input = input_of(capacitor);
  if (input < 0) return false;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (input_of(i) == input && c[i] > c[capacitor]) return true;
  }
  return false;
}

bool DesignStage::is_stable() const {
  if (is_first()) return c[2 * from.size()] > 0.0;
  // q0 + q1 D + q2 D^2 in powers of 1/z.
  const double loop = c[kC2] * c[kC3];
  const double damp = c[kC4] * (kind == Kind::second_low ? c[kCA] : c[kC3]);
  const double q1 = damp - loop;
  const double q2 = c[kCA] * c[kCB] - (kind == Kind::second_low ? 0.0 : damp);
  const double first = loop + q1 + q2;
  return std::abs(q2) < first && std::abs(q1 + 2.0 * q2) < first + q2;
}

double DesignStage::largest_units(std::size_t capacitor, int max_capacitor) const {
  const bool banks = !is_first() && (capacitor == kCA || capacitor == kCB) && capacitor_count() <= 6;
  return banks ? 2.0 * max_capacitor : max_capacitor;
}

double DesignStage::switched_units(int opamp) const {
  if (is_first()) {
    double out = 0.0;
    for (std::size_t i = 0; i <= from.size(); ++i) out += c[2 * i];
    return out;
  }
  if (opamp == 1) return c[kC1] + c[kC2];
  return c[kC3] + (kind == Kind::second_low ? c[kC4] + c[kCp] : 0.0);
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
