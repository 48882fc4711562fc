#include "faults/priors.hpp"

#include <cmath>
#include <map>

namespace bodesmith::faults {

std::vector<double> log_priors(const std::vector<Fault>& faults) {
  std::map<const FaultKind*, int> counts;
  for (const Fault& fault : faults) ++counts[fault.kind];
  double sum = 0.0;
  for (const auto& [kind, count] : counts) sum += kind->prior();
  std::vector<double> out;
  for (const Fault& fault : faults) out.push_back(std::log(fault.kind->prior() / (sum * counts[fault.kind])));
  return out;
}

}  // namespace bodesmith::faults
