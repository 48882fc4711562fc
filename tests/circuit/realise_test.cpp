#include "circuit/realise.hpp"

#include <gtest/gtest.h>

#include "circuit/response.hpp"
#include "seed_sections.hpp"

namespace bodesmith {
namespace {

TEST(Realise, SeedSectionsWithE12CapacitorsAndE96Resistors) {
  RealiseOptions options;
  const Realised made = realise(seed_sections(), options);
  const auto grid = log_grid({Hertz{1}, Hertz{100}}, 200);
  std::vector<std::complex<double>> wanted;
  for (const Hertz f : grid) wanted.push_back(seed_sections().response(f.rad_s()));
  const auto got = circuit_response(made.circuit, grid);
  const auto d = compare_responses(grid, got, wanted);
  const auto real = compare_responses(grid, network_response(made.circuit, grid, options.opamp), wanted);
  std::printf("%g dB %g deg; real %g dB; nearest %g; band all %g dB opamps %g nodes %g %g\n",
              d.max_magnitude_db, d.max_phase_deg, real.max_magnitude_db,
              made.report.nearest.max_magnitude_db, made.report.all.max_magnitude_db,
              made.report.opamps.max_magnitude_db, made.report.highest_node_db, made.report.lowest_node_db);
  for (const auto& p : made.circuit.parts) std::printf("%s %g %g\n", p.name.c_str(), p.wanted, p.realised);
  EXPECT_LE(d.max_magnitude_db, 0.02);
}

}  // namespace
}  // namespace bodesmith
