#include "spice/compensator_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "circuit/json.hpp"
#include "circuit/noise.hpp"
#include "circuit/response.hpp"
#include "circuit/stated_band.hpp"
#include "circuit/transient.hpp"
#include "spice/compensator_library.hpp"
#include "spice/ngspice.hpp"
#include "spice/triangle.hpp"

namespace bodesmith::spice {
namespace {

double check_transient(const circuit::Circuit& circuit, const std::string& library, double frequency_hz) {
  const double period = 1.0 / frequency_hz;
  const std::string points = triangle_points(frequency_hz);
  const Transient got =
      run_transient("triangle\n" + library + "Vin in 0 PWL(" + points + ")\nXc in out compensator\n", {"out"},
                    period / 1000.0, 2.0 * period, "compensator.sub");
  const double step = period / 2000.0;
  const auto triangle = [&](double t) {
    const double phase = t / period - std::floor(t / period);
    return phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
  };
  const std::vector<double> own = circuit::simulate_stages(circuit, triangle, step, 4001);
  double worst = 0.0, peak = 0.0;
  for (size_t i = 0; i < got.time_s.size(); ++i) {
    const double place = std::clamp(got.time_s[i] / step, 0.0, 3999.999);
    const size_t at = static_cast<size_t>(place);
    const double share = place - static_cast<double>(at);
    const double here = own[at] + share * (own[at + 1] - own[at]);
    worst = std::max(worst, std::abs(got.v[0][i] - here));
    peak = std::max(peak, std::abs(here));
  }
  return peak > 0.0 ? 100.0 * worst / peak : 0.0;
}

double check_noise(const circuit::Circuit& circuit, const std::string& library, Band band) {
  const NoiseSpectrum got = run_noise_of_text(library, band, 5, "compensator.sub");
  const std::vector<double> own = circuit::output_noise(circuit, circuit.model, got.grid);
  double worst = 0.0;
  for (size_t i = 0; i < own.size(); ++i)
    worst = std::max(worst, 100.0 * std::abs(got.v_per_rthz[i] / own[i] - 1.0));
  return worst;
}

}  // namespace

CompensatorCheck check_compensator(const circuit::Circuit& circuit, const Sections& wanted, int points) {
  CompensatorCheck out;
  out.band = circuit::searched_band(circuit::without_far_zeros(wanted));
  const std::vector<Hertz> grid = log_grid(out.band, points);
  const std::string library = compensator_library(circuit, "check");
  const auto got = run_ac_of_text(library, "compensator.sub", grid);
  const auto network = circuit.model.is_ideal ? circuit::network_response_ideal(circuit, grid)
                                              : circuit::network_response(circuit, grid, circuit.model);
  std::vector<std::complex<double>> target;
  for (const Hertz f : grid) target.push_back(wanted.response(f.rad_s()));
  out.against_network = compare_responses(grid, got, network);
  out.against_sections = compare_responses(grid, got, target);
  out.transient_percent =
      check_transient(circuit, library, std::sqrt(out.band.from.value * out.band.to.value));
  out.noise_percent = check_noise(circuit, library, out.band);
  return out;
}

Json to_json(const CompensatorCheck& check) {
  return {{"version", ngspice_version()},
          {"band_hz", {check.band.from.value, check.band.to.value}},
          {"against_program", circuit::to_json(check.against_network)},
          {"against_sections", circuit::to_json(check.against_sections)},
          {"transient_percent", check.transient_percent},
          {"noise_percent", check.noise_percent}};
}

}  // namespace bodesmith::spice
