#pragma once

#include <cstddef>
#include <vector>

#include "fpaa/cams/cam_values.hpp"
#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

class Cam;

/// What the dialog asks for: one gain an input, negative for one that inverts.
struct SumDiffSpec {
  std::vector<double> gains;

  std::string option() const;
};

const Cam& sum_diff_cam();

}  // namespace bodesmith::fpaa
