#include "cli/yield_margins.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "cli/bode_loop.hpp"
#include "lti/frequency_grid.hpp"
#include "tolerance/margins.hpp"

namespace bodesmith::cli {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> complex_response(const ResponseSource& source, const std::vector<Hertz>& grid) {
  const LevelAndPhase curves = source.on_grid(grid);
  if (curves.phase_deg.empty())
    throw InputError(source.stem + ": has no phase, so that its loop has no margins");
  std::vector<Complex> out;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (std::isnan(curves.magnitude_db[i]))
      throw InputError(fmt::format("{}: has no value at {} Hz", source.stem, rounded_text(grid[i].value)));
    out.push_back(std::polar(from_decibel(curves.magnitude_db[i]), to_radians(curves.phase_deg[i])));
  }
  return out;
}

std::string kept_text(const char* what, const std::vector<double>& least_first, std::optional<double> nominal,
                      const char* unit) {
  if (least_first.empty() || !nominal) return fmt::format("no {}", what);
  return fmt::format("{} {} {}, {} or more in 95 of 100 circuits", what, rounded_text(std::abs(*nominal), 4),
                     unit, rounded_text(yield::kept_by_95(least_first), 4));
}

}  // namespace

void add_margin_options(CommandLine& line) {
  line.list<std::string>(
      "margins", "PLANT...: margins of the loop of the design and these in series, over its tolerances");
}

std::optional<LoopPlant> read_loop_plant(const CommandLine& line, const yield::Design& design,
                                         Provenance& from) {
  if (!line.has("margins")) return std::nullopt;
  constexpr double kBeyond = 10.0;  // the loop's crossings lie about the corners
  constexpr int kPoints = 400;
  constexpr double kMostChange = 0.05;
  std::vector<ResponseSource> sources;
  for (const std::string& file : line.get<std::vector<std::string>>("margins"))
    sources.push_back(load_response(file, {}, from));
  const ResponseSource plant = sources.size() == 1 ? sources.front() : series_of(sources);
  for (const ResponseSource& source : sources) {
    if (source.own_frequencies.empty()) continue;
    if (source.own_frequencies.size() < 2)
      throw InputError(source.stem + ": holds one point, so that its loop has no margins");
    return LoopPlant{source.own_frequencies, complex_response(plant, source.own_frequencies)};
  }
  const Band band{Hertz{design.band.from.value / kBeyond}, Hertz{design.band.to.value * kBeyond}};
  const auto loop = [&](Hertz f) { return design.wanted(f) * complex_response(plant, {f}).front(); };
  LoopPlant out{judging_grid(loop, band, kPoints, kMostChange), {}};
  out.response = complex_response(plant, out.grid);
  return out;
}

std::string study_margins(const CommandLine& line, const yield::Design& design, const LoopPlant& plant,
                          const yield::Options& options, Json& json) {
  const yield::LoopStudy study = yield::study_loop(design, options, plant.grid, plant.response);
  json["margins"] = yield::to_json(study);
  const auto* phase = study.nominal.least_phase_margin();
  const auto* gain = study.nominal.least_gain_margin();
  const auto value = [](const auto* crossing, auto member) {
    return crossing != nullptr ? std::optional<double>(crossing->*member) : std::nullopt;
  };
  return fmt::format("  as a loop with {}:\n    {}\n    {}\n    {} of {} circuits unstable\n",
                     join(line.get<std::vector<std::string>>("margins"), ", "),
                     kept_text("phase margin", study.phase_margin_deg,
                               value(phase, &LoopMargins::GainCrossing::phase_margin_deg), "deg"),
                     kept_text("gain margin", study.gain_margin_db,
                               value(gain, &LoopMargins::PhaseCrossing::gain_margin_db), "dB"),
                     study.unstable == 0 ? std::string("none") : fmt::format("{}", study.unstable),
                     options.samples);
}

}  // namespace bodesmith::cli
