#include "synthesis/stages/stage_form.hpp"

namespace bodesmith::circuit {

std::vector<double> StageForm::capacitors(std::span<const double> values) const {
  std::vector<double> out;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].kind == Part::Kind::capacitor) out.push_back(values[i]);
  }
  return out;
}

std::optional<std::vector<double>> StageForm::exact_near(std::span<const double> values) const {
  return design(capacitors(values));
}

}  // namespace bodesmith::circuit
