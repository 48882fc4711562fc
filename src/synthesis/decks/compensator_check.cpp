#include "synthesis/decks/compensator_check.hpp"

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "schematic/analysis/in_time.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/decks/dialect.hpp"
#include "synthesis/json.hpp"

namespace bodesmith::spice {
namespace {

double check_transient(const circuit::Circuit& circuit, const std::string& library, double frequency_hz) {
  const double period = 1.0 / frequency_hz;
  const std::string points = triangle_points(frequency_hz);
  const Transient got =
      run_transient("triangle\n" + library + "Vin in 0 PWL(" + points + ")\nXc in out compensator\n", {"out"},
                    period / 1000.0, 2.0 * period, "compensator.sub");
  const auto triangle = [&](double t) {
    const double phase = t / period - std::floor(t / period);
    return phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
  };
  schematic::InTime run(circuit, triangle);
  run.begin(0.0);
  double worst = 0.0, peak = 0.0;
  std::size_t i = 0;
  for (int half = 1; half <= 4; ++half) {
    run.run_to(0.5 * half * period, [&](double from, double to) {
      for (; i < got.time_s.size() && got.time_s[i] <= to; ++i) {
        const double here = run.volts("out", std::max(got.time_s[i], from));
        worst = std::max(worst, std::abs(got.v[0][i] - here));
        peak = std::max(peak, std::abs(here));
      }
    });
  }
  return peak > 0.0 ? 100.0 * worst / peak : 0.0;
}

double check_noise(const circuit::Circuit& circuit, const std::string& library, Band band) {
  const NoiseSpectrum got = run_noise_of_text(library, band, 5, "compensator.sub");
  const std::vector<double> own = schematic::output_noise(circuit, got.grid);
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
  const std::string library = schematic::spice_text(compensator_library(circuit, "check"));
  const auto got = run_ac_of_text(library, "compensator.sub", grid);
  const auto network = circuit.opamp.is_ideal
                           ? schematic::network_response(circuit, grid, {.ideal_opamps = true})
                           : schematic::network_response(circuit, grid);
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
