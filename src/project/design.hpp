#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "approximate/approximate.hpp"
#include "circuit/realise.hpp"
#include "fit/cascade_fit.hpp"
#include "fit/waveform_error.hpp"
#include "fpaa/plan.hpp"
#include "multiplier_layout/layout.hpp"
#include "project/alternatives.hpp"
#include "project/project_file.hpp"
#include "spice/check.hpp"

namespace bodesmith::project {

/// Everything between the wish and the hardware.
struct Design {
  CascadeFit fit;
  CascadeApproximation approximation;
  std::vector<Alternative> alternatives;
  std::size_t chosen = 0;  ///< of the alternatives: what plan and circuit are made of
  std::optional<fpaa::Plan> plan;
  std::optional<Realised> circuit;
  DisturbanceLayout layout;
  std::vector<std::string> passed_over;  ///< better alternatives that the hardware cannot make, and why
  const Sections& sections() const { return alternatives[chosen].sections; }
  double compute_s = 0.0;  ///< fit to plan, netlist and layout, without the alternatives that are not built
  double alternatives_s = 0.0;
};

Design make_design(const Project& project);

/// One stage of the way, as a response that can be laid beside the others.
struct DesignStage {
  std::string name;  ///< "cascade", "sections", "fpaa", "fpaa with holds", "circuit", "circuit with op-amps"
  std::string previous;  ///< the stage it is judged against; empty for the first
  std::function<std::complex<double>(RadPerSecond)> response;
};
std::vector<DesignStage> design_stages(const Design& design);

/// What a stage adds to the error, and what has come together so far.
struct BudgetRow {
  std::string stage;
  std::string previous;
  ResponseDifference against_previous;  ///< over the band; zero for the cascade
  double points_max_db = 0.0;           ///< largest miss at the wanted points
  WaveformError waveform;  ///< compensating waveform at the tracked frequencies, percent of range
};

struct Budget {
  Band band;
  std::vector<BudgetRow> rows;
  WaveformError uncompensated;  ///< the rate effect left alone: gain 1 at every frequency
  WaveformError constant;       ///< the best single gain
  double constant_gain = 1.0;
  /// The cascade's magnitude fits, and yet its waveform is worse than with no rate compensation at all.
  bool magnitude_only_is_worse = false;
};
Budget make_budget(const Project& project, const Design& design);

}  // namespace bodesmith::project
