#pragma once

#include <atomic>
#include <deque>
#include <mutex>
#include <optional>

#include "base/outcome.hpp"
#include "circuit/realise.hpp"
#include "fpaa/plan.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

struct Design;

/// What each alternative of a design becomes on the board and of the parts: made once, by whoever asks first, from any
/// thread; whoever asks meanwhile waits.
class AlternativeHardware {
 public:
  /// `design` has its fit and its alternatives; the project must live as long as this does.
  AlternativeHardware(const Project& project, const Design& design);

  /// Absent where the project has no such hardware.
  struct Made {
    std::optional<Outcome<fpaa::Plan>> plan;
    std::optional<Outcome<circuit::Realised>> circuit;
  };
  const Made& of(std::size_t alternative);
  bool is_made(std::size_t alternative) const { return places_[alternative].done; }
  std::size_t count() const { return places_.size(); }

 private:
  struct Place {
    Sections sections;
    Band band;
    std::once_flag once;
    std::atomic<bool> done = false;
    Made made;
  };
  void make(Place& place) const;

  const Project& project_;
  std::deque<Place> places_;
};

}  // namespace bodesmith::project
