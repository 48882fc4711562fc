#include "spice/check.hpp"

#include "circuit/response.hpp"
#include "spice/emit.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith {

SpiceCheck check_with_ngspice(const Circuit& circuit, const Sections& wanted, int points) {
  SpiceCheck out;
  const Band corners = wanted.corner_band();
  out.band = corners.to.value > 0.0 ? Band{Hertz{corners.from.value / 10.0}, Hertz{corners.to.value * 10.0}}
                                    : Band{Hertz{1.0}, Hertz{1000.0}};
  const std::vector<Hertz> grid = log_grid(out.band, points);
  const auto got = run_ac_of_text(compensator_library(circuit, "check"), "compensator.sub", grid);
  const bool ideal = circuit.model.name == "ideal";
  const auto network =
      ideal ? network_response_ideal(circuit, grid) : network_response(circuit, grid, circuit.model);
  std::vector<std::complex<double>> target;
  for (const Hertz f : grid) target.push_back(wanted.response(f.rad_s()));
  out.against_network = compare_responses(grid, got, network);
  out.against_sections = compare_responses(grid, got, target);
  return out;
}

}  // namespace bodesmith
