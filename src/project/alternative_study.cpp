#include "project/alternative_study.hpp"

#include "base/progress.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::project {
namespace {

/// The same design with another alternative chosen, made on the board and of the parts by itself; what cannot be made stays
/// empty, and why is added to `refused`. The one that is built already stays as it is.
Design with_alternative(const Project& project, const Design& design, AlternativeHardware& hardware,
                        std::size_t chosen, std::vector<std::string>& refused) {
  Design out = design;
  if (chosen == design.chosen) return out;
  out.chosen = chosen;
  out.plan.reset();
  out.circuit.reset();
  if (project.deadline.passed() && !hardware.is_made(chosen)) {
    refused.emplace_back("Not tried in the time given.");
    return out;
  }
  const AlternativeHardware::Made& made = hardware.of(chosen);
  if (made.plan) {
    if (const auto* refusal = refusal_of(*made.plan)) {
      refused.push_back("Not on the board: " + refusal->reason);
    } else {
      out.plan = std::get<fpaa::Plan>(*made.plan);
    }
  }
  if (made.circuit) {
    if (const auto* refusal = refusal_of(*made.circuit)) {
      refused.push_back("Not of these parts: " + refusal->reason);
    } else {
      out.circuit = std::get<circuit::BuildChoice>(*made.circuit);
    }
  }
  return out;
}

}  // namespace

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
