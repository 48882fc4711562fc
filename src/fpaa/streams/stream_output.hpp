#pragma once

#include <string>

#include "base/documents/json_fwd.hpp"
#include "base/files.hpp"
#include "fpaa/streams/plan_stream.hpp"

namespace bodesmith::fpaa::an231 {

/// What every output says.
inline constexpr const char* kStreamStatus =
    "derived from public material, not tried on silicon: no chip was at hand";

/// Largest relative difference, in percent, between what the plan does and what the bytes make, read back, over
/// the plan's band: without holds and as the board runs. Throws DesignError when the bytes cannot be read back
/// or do something else (more than 1e-7 %).
double check_streams(const Plan& plan, const PlanStreams& streams);

/// chipN.ahf, primary.c, packets.bin.
OutputSet configuration_files(const PlanStreams& streams, const std::string& plan_file);
/// The same and first_power_on.md.
OutputSet stream_files(const Plan& plan, const PlanStreams& streams, const std::string& plan_file);

/// Currents, tones and the readings to expect of this very design.
std::string first_power_on(const Plan& plan, const PlanStreams& streams);

/// Of plan.json: `{"status", "chips": [{"chip", "address1", "bytes", "pins"}], "constants", "warnings",
/// "largest_difference_percent"}`.
Json stream_json(const PlanStreams& streams, double difference_percent);

}  // namespace bodesmith::fpaa::an231
