#include "hysteresis/identification.hpp"

#include "base/progress.hpp"

namespace bodesmith::hysteresis {

Identified ModelType::identify(std::span<const TimeRecord> records, const IdentifyOptions& options) const {
  for (const TimeRecord& record : records) record.require_measured_sizes();
  const Stopwatch watch;
  Identified out = fit(records, options);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace bodesmith::hysteresis
