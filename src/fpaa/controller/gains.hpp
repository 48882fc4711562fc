#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "fpaa/controller/controller.hpp"
#include "fpaa/gains/gain_schedule.hpp"
#include "fpaa/streams/plan_stream.hpp"

namespace bodesmith::fpaa {

/// The set that serves a frequency: the nearest in log f; the frequency itself when there are no sets.
Hertz serving_frequency(const std::vector<Hertz>& sets, Hertz operating);

/// `frequency_hz`, then a column `<CAM>_<capacitor>_units` for every capacitor that carries a rate gain, one
/// row a set. Empty when none does.
std::string gain_sets_csv(const ControllerVariant& variant, const Disturbance& disturbance);

/// The complete configuration of a controller whose every stage is publicly known (outside multipliers and
/// switch), and its gains as updates.
struct ControllerStreams {
  OutputSet
      files;  ///< chipN.ahf, primary.c, packets.bin; updates/setNNN_addressA.ahf and .bin (board packets)
  std::vector<std::string> warnings;
  an231::PinCells cells;
  std::size_t sets = 0;
};
/// Refused with the first CAM whose switches are not publicly known, or what does not fit.
Outcome<ControllerStreams> controller_streams(const ControllerVariant& variant,
                                              const Disturbance& disturbance);

}  // namespace bodesmith::fpaa
