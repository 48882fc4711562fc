#pragma once

#include <map>
#include <string>
#include <vector>

#include "fpaa/device/config_stream.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/streams/api_code.hpp"

namespace bodesmith::fpaa {

struct UpdateOptions {
  /// Plan's capacitor name -> name in the user's table, e.g. {"Ca", "C1"}; without an entry the names must
  /// agree. (Which capacitor of the "Pole and Zero" option is which is not publicly known: read it off the
  /// CAM's dialog.)
  std::map<std::string, std::string> names;
  bool clocks =
      true;  ///< also the divisors (chip clocks 0-3 in bytes 7-4 of bank 0, system clocks in 9 and 10)
};

/// The update stream of one chip: capacitors by the user's own component tables, clock divisors; EndExecute, and
/// UpdateClocks with clocks. Throws DesignError when a CAM of the plan is not in the project under its name, or a
/// capacitor is not in its table.
ConfigStream update_stream(const ChipPlan& chip, const ApiProject& project, const UpdateOptions& options);

/// Differences between what a stream sets and what the plan wants, one line each; empty: they agree.
std::vector<std::string> compare_with_plan(const ConfigStream& stream, const ChipPlan& chip,
                                           const ApiProject& project, const UpdateOptions& options);

/// C source with one array a chip, as the vendor's tool writes arrays.
std::string c_arrays(const std::vector<std::pair<std::string, Bytes>>& arrays, const std::string& plan_file);

/// C source that sets the plan's capacitors through the generated API (SetCapValue by the capacitor's place
/// in its table) and hands each chip's update to a function of the user's that sends it.
std::string c_calls(const Plan& plan, const ApiProject& project, const UpdateOptions& options,
                    const std::string& plan_file);

}  // namespace bodesmith::fpaa
