#pragma once

#include <atomic>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/plan/plan.hpp"
#include "project/design/alternatives.hpp"
#include "project/project.hpp"
#include "synthesis/realise_search.hpp"

namespace bodesmith::project {

/// The sections, which state that they are made for `band`.
Sections stating_band(Sections sections, Band band);

/// The disturbance paper's configuration: FilterBilinear alone, on one chip at one clock, which is searched. Nothing where no board is
/// asked for, or it cannot be made so.
std::optional<fpaa::Plan> make_paper_plan(const Project& project, const Sections& sections, Band band);

/// What each alternative of a design becomes on the board and of the parts: each made once, by whoever asks first, from any
/// thread; whoever asks meanwhile waits.
class AlternativeHardware {
 public:
  /// The project must live as long as this does.
  AlternativeHardware(const Project& project, const std::optional<CascadeFit>& fit,
                      const std::vector<Alternative>& alternatives);

  /// Absent where the project has no such hardware. Of several alternatives by the realisation that was asked for alone; without
  /// a plant judged in the target's band, and by another realisation where the usual one falls short.
  const std::optional<Outcome<synthesis::BuildChoice>>& circuit_of(std::size_t alternative);
  /// To be built: all that the search can do.
  const std::optional<Outcome<fpaa::Plan>>& plan_of(std::size_t alternative);
  /// For a comparison: as it is built where that is known, else by a quick search (fpaa::PlanOptions::quick).
  const std::optional<Outcome<fpaa::Plan>>& compared_plan_of(std::size_t alternative);
  bool is_made(std::size_t alternative) const { return places_[alternative].compared; }

 private:
  struct Place {
    Sections sections;
    Band band;
    std::once_flag circuit_once, plan_once, compared_once;
    std::atomic<bool> built = false, compared = false;
    std::optional<Outcome<fpaa::Plan>> plan, compared_plan;
    std::optional<Outcome<synthesis::BuildChoice>> circuit;
  };

  const Project& project_;
  std::deque<Place> places_;
};

}  // namespace bodesmith::project
