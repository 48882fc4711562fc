#include "gap/effects/plays.hpp"

#include <array>
#include <string>

namespace bodesmith::gap {

PlayBank play_bank(double half_range) {
  constexpr std::array kParts = {0.02, 0.06, 0.12, 0.2, 0.3, 0.42, 0.56, 0.72, 0.88};
  constexpr double kStart = 0.01;
  PlayBank bank{{0.0}, {1.0}, {}, {}};
  for (std::size_t k = 0; k < kParts.size(); ++k) {
    bank.radius.push_back(kParts[k] * half_range);
    bank.weight.push_back(kStart);
    bank.unknowns.push_back(linear_unknown("w[" + std::to_string(k + 1) + "]", 0.0, 5.0, 0.05));
    bank.start.push_back(kStart);
  }
  return bank;
}

}  // namespace bodesmith::gap
