#pragma once

#include <cstdint>
#include <vector>

#include "part_errors/study.hpp"

namespace bodesmith::part_errors {

/// One drawn copy at one frequency: the fast model beside ngspice on the netlist with those very deviations.
struct DrawCheck {
  std::uint64_t draw = 0;
  Hertz frequency;
  double percent = 0.0;  ///< tracking error, lag removed
  double ngspice_percent = 0.0;
  double drive_rms_percent = 0.0;  ///< rms difference of v, of the stroke
};

/// The first `count` draws, at the frequencies in turn. Needs ngspice.
std::vector<DrawCheck> check_draws(const controller::AnalogController& controller,
                                   const tracking::Stage& stage, const StudyOptions& options, int count);

}  // namespace bodesmith::part_errors
