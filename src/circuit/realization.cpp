#include "circuit/realization.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuit/forms.hpp"

namespace bodesmith::circuit {

std::vector<double> StageForm::capacitors(std::span<const double> values) const {
  std::vector<double> out;
  for (size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].kind == Part::Kind::capacitor) out.push_back(values[i]);
  }
  return out;
}

bool StageForm::exact_near(std::span<const double> values, std::vector<double>& exact) const {
  return design(capacitors(values), exact);
}

const std::vector<Realization>& realizations() {
  static const std::vector<Realization> all = {
      first_order_realization(),         first_order_right_zero_realization(),
      first_order_trimmed_realization(), inverter_realization(),
      tow_thomas_realization(),          khn_realization(),
      sallen_key_realization(),          multiple_feedback_realization(),
  };
  return all;
}

const Realization& realization_named(const std::string& name) {
  std::vector<std::string> names = {"opamp-rc"};
  for (const Realization& one : realizations()) {
    if (one.name == name) return one;
    names.push_back(one.name);
  }
  for (const char* ladder : {"foster1", "foster2", "cauer1", "cauer2"}) names.emplace_back(ladder);
  throw InputError(fmt::format("'{}' is not a realization, expected one of {}", name, join(names, ", ")));
}

const Realization& default_realization(const Section& section) {
  // Zeros at the origin: Tow-Thomas makes them as differences of resistors, which no preferred value meets.
  if (section.poles.size() == 2 && section.zeros.size() == 2 && std::abs(section.zeros[0]) == 0.0 &&
      std::abs(section.zeros[1]) == 0.0) {
    const double quality =
        std::abs(section.poles[0]) / std::abs((section.poles[0] + section.poles[1]).real());
    return realization_named(quality <= 3.0 ? "sallen-key" : "khn");
  }
  for (const char* name : {"inverter", "first-order", "first-order-right-zero", "tow-thomas"}) {
    const Realization& one = realization_named(name);
    if (one.refusal(section).empty()) return one;
  }
  throw DesignError("a section fits none of the op-amp RC forms");
}

}  // namespace bodesmith::circuit
