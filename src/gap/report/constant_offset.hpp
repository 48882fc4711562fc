#pragma once

#include <string>
#include <vector>

#include "gap/report/size.hpp"

namespace bodesmith::gap {

/// A held-out record whose gap is for the most part one constant: the mean m of the residual e = y - y_model, with
/// share = m^2 / mean(e^2) of it. A stage's zero that moved between two records (drift, creep, another preload) does
/// this, and no term of a model can know it.
struct ConstantOffset {
  std::string file;
  double value = 0.0;        ///< in the unit of y
  double share = 0.0;        ///< of the mean square of the gap
  double rms_without = 0.0;  ///< what would be left without it
};

/// The held-out time records for which that share is at least a half.
std::vector<ConstantOffset> constant_offsets(const GapMeter& meter, const Model& model, const Study& study);

/// One sentence for a person.
std::string to_text(const ConstantOffset& offset);

}  // namespace bodesmith::gap
