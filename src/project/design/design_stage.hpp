#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lti/frequency_grid.hpp"
#include "report/plot.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith::project {

/// One stage of a design as a frequency response that can be compared with the others. It refers to its design.
struct DesignStage {
  std::string name;  ///< "cascade", "sections", "fpaa", "circuit", …
  std::function<Complex(RadPerSecond)> response;
  std::optional<std::size_t> previous = std::nullopt;  ///< place of the stage it is made from
};

/// bode.csv: a column of decibels and one of degrees for each stage.
std::string stages_csv(const std::vector<DesignStage>& stages, const std::vector<Hertz>& grid);

/// Magnitude and phase (unwrapped) of all stages, the target's points as marks.
report::BodePlot stages_bode(const std::vector<DesignStage>& stages, const std::vector<Hertz>& grid,
                             const BodePoints* points);

/// The curves of a magnitude plot less `reference_db`, without the one called `left_out`; scaled by what is within the band.
report::Plot difference_plot(const report::Plot& magnitude, const std::string& title, const Band& band,
                             const std::function<double(Hertz)>& reference_db, const std::string& left_out);

}  // namespace bodesmith::project
