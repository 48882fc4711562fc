#include "project/alternative_study.hpp"

#include "base/progress.hpp"
#include "numeric/parallel_for.hpp"
#include "project/alternative_hardware.hpp"

namespace bodesmith::project {

std::vector<AlternativeStudy> study_alternatives(const Project& project, const Design& design,
                                                 AlternativeHardware& hardware) {
  std::vector<AlternativeStudy> out(design.alternatives.size());
  parallel_for(out.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    out[i].design = with_alternative(project, design, hardware, i, out[i].refused);
    out[i].budget = make_budget(project, out[i].design);
  });
  stop_if_interrupted();
  return out;
}

}  // namespace bodesmith::project
