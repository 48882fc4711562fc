#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "cli/command_line.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::cli {

void add_margin_options(CommandLine& line);
/// What a design's response is multiplied with to be that of a loop.
struct LoopPlant {
  std::vector<Hertz> grid;
  std::vector<std::complex<double>> response;
};
/// With --margins: measured ones at their own points, others where the loop turns.
std::optional<LoopPlant> read_loop_plant(const CommandLine& line, const yield::Design& design,
                                         Provenance& from);
/// The margins of the design's loop into json["margins"]; returns the lines of the summary.
std::string study_margins(const CommandLine& line, const yield::Design& design, const LoopPlant& plant,
                          const yield::Options& options, Json& json);

}  // namespace bodesmith::cli
