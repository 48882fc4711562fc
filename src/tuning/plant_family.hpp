#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::tuning {

using Response = std::function<Complex(RadPerSecond)>;

/// One plant that the loop may meet.
struct PlantMember {
  std::string name;  ///< "nominal", "delay + 2 sigma", the file of another plant
  Response response;
};

/// The plants that a controller shall serve, the nominal one first.
struct PlantFamily {
  std::vector<PlantMember> members;
  std::optional<Band>
      band;  ///< where the nominal plant was measured, or has its corners; up to the highest of any file's
  double rms_fit_db = 0.0;  ///< of a measured response: how well its model fits

  const PlantMember& nominal() const { return members.front(); }
};

struct PlantSpread {
  double sigmas = 2.0;        ///< of the standard deviations that a fit states
  double gain_percent = 0.0;  ///< every plant also with its gain so much higher and lower
  double frequency_percent =
      0.0;  ///< and with all its corners so much higher and lower (the delay as much shorter and longer)
};

/// From one file each: a measured complex response (fitted by fit_measured()), sections.json (its `fit` states standard
/// deviations) or a linear model.toml. Next to the nominal plant stand: each parameter of a fit moved by `sigmas` of its
/// deviations, up and down, one at a time, its gain at rest kept; the corners of `gain_percent` and `frequency_percent`; and
/// the other files. InputError for a plant without a response, or with no more than a gain.
PlantFamily read_plants(const std::vector<std::string>& files, const PlantSpread& spread, Provenance& from);

}  // namespace bodesmith::tuning
