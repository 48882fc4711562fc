#include <array>
#include <string>

#include "approximate/all_methods.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

constexpr std::array<ApproximationMethod, 7> kMethods = {{
    {"minimax", "equal ripple in log magnitude (Remez exchange on log pole and zero positions)", minimax,
     false},
    {"oustaloup", "Oustaloup et al. 2000", oustaloup, true},
    {"refined-oustaloup", "Xue, Zhao and Chen 2006", refined_oustaloup, true},
    {"matsuda", "Matsuda and Fujii 1993, at real s", matsuda, true},
    {"carlson", "Carlson and Halijak 1964", carlson, true},
    {"pade", "continued fraction at the centre of the band", pade, true},
    {"charef", "Charef et al. 1992", charef, true},
}};

}  // namespace

std::span<const ApproximationMethod> approximation_methods() {
  return kMethods;
}

const ApproximationMethod& approximation_method(std::string_view name) {
  std::string names;
  for (const ApproximationMethod& method : kMethods) {
    if (method.name == name) return method;
    names += names.empty() ? "" : ", ";
    names += method.name;
  }
  throw InputError("'" + std::string(name) + "' is no approximation method, expected one of " + names);
}

}  // namespace bodesmith
