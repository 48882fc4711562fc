#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "approximate/fractional_stability.hpp"
#include "approximate/fractional_transfer.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "cli/approximate_modes.hpp"
#include "cli/commands.hpp"
#include "fit/direct_fit.hpp"

namespace bodesmith::cli {
namespace {

/// The exact response as complex Bode points, 40 a decade.
BodePoints sampled_points(const FractionalTransfer& transfer, const std::string& file, Band band) {
  BodePoints out;
  out.file = file;
  const int count = whole_number(40.0 * std::log10(band.to.value / band.from.value), 20, 40 * 700);
  for (const Hertz f : log_grid(band, count)) {
    const auto g = transfer.response(f.rad_s());
    out.points.push_back({f, std::abs(g), to_degrees(std::arg(g)), 1.0, 0});
  }
  return out;
}

Json stability_json(const FractionalStability& s) {
  Json out;
  out["stable"] = s.stable();
  out["unstable_poles"] = s.unstable_poles;
  if (s.matignon_count) out["unstable_poles_by_matignon"] = *s.matignon_count;
  out["common_step"] = s.common_step;
  out["integrator_power"] = s.powers_of_s;
  return out;
}

/// The transfer function of the file, which must be stable and minimum-phase.
struct FractionalInput {
  FractionalTransfer transfer;
  FractionalStability stability;
};

FractionalInput read_fractional(const std::string& file, Provenance& from) {
  FractionalInput out;
  out.transfer = FractionalTransfer::read(file, from);
  out.stability = fractional_stability(out.transfer.denominator);
  if (!out.stability.stable()) {
    throw DesignError(
        file, 0,
        fmt::format("is unstable ({} poles in the right half plane), expected a stable transfer function",
                    out.stability.unstable_poles));
  }
  if (fractional_stability(out.transfer.numerator).unstable_poles > 0) {
    throw DesignError(file, 0,
                      "has zeros in the right half plane, expected a minimum-phase transfer function");
  }
  return out;
}

DirectFit fit_fractional(const CommandLine& line, const BodePoints& points, std::optional<double> limit) {
  DirectFitOptions options;
  options.use_phase = true;
  options.real = line.has("real");
  options.seed = line.seed_value();
  if (limit && !line.has("order")) {
    return fit_directly_within(points, options, *limit, 1, std::min(12, line.get<int>("max-order")));
  }
  if (line.has("order")) options.order = line.get<int>("order");
  return fit_directly(points, options);
}

/// Poles at 0 that stand for an integrator of this power: 1 for s^-0.9, 2 for s^-1.6.
int whole_integrators(double power) {
  return power > 0.0 ? std::max(1, nearest_whole<int>(power)) : 0;
}

/// The points without the integrators: times (j w)^n.
BodePoints without_integrators(BodePoints points, int integrators) {
  for (BodePoint& point : points.points) {
    point.gain *= std::pow(point.frequency.rad_s().value, integrators);
    point.phase_deg = *point.phase_deg + 90.0 * integrators;
  }
  return points;
}

void add_integrators(Sections& sections, int integrators) {
  for (int i = 0; i < integrators; ++i) {
    Section one;
    one.poles = {{0.0, 0.0}};
    sections.sections.insert(sections.sections.begin(), one);
  }
}

/// The lowest pole: below it a finite gain takes the place of the integrator.
Hertz lowest_pole(const Sections& sections) {
  double out = INFINITY;
  for (const Section& section : sections.sections) {
    for (const std::complex<double>& pole : section.poles) out = std::min(out, std::abs(pole));
  }
  return RadPerSecond{out}.hz();
}

std::string integrator_text(double power, int kept, const Sections& sections) {
  std::string text = fmt::format("; contains an integrator of order {}", rounded_text(power));
  if (kept > 0) return text + fmt::format(", kept as {} pole{} at 0", kept, kept == 1 ? "" : "s");
  return text +
         fmt::format(
             ", which these sections make down to {}: at rest their gain is {} dB (--keep-integrator: a pole at 0)",
             engineering_text(lowest_pole(sections).value, "Hz"),
             rounded_text(to_decibel(std::abs(sections.dc_gain())), 3));
}

/// A cascade has terms for a method; a transfer function is fitted as a whole.
void refuse_cascade_options(const CommandLine& line) {
  for (const char* option : {"method", "over-band", "complex", "arrange", "merge-db", "biquads"}) {
    if (line.has(option))
      line.fail(fmt::format(
          "--{} is for the terms of a cascade; a FRACTIONAL.toml is fitted as a whole (minimax in dB "
          "and degrees)",
          option));
  }
}

std::string fractional_summary(const DirectFit& fit, const FractionalStability& stability, int kept,
                               const Band& band) {
  std::string text =
      fmt::format("{} sections, {} poles: {} dB and {} deg over {} to {}\n", fit.sections.sections.size(),
                  fit.sections.pole_count(), rounded_text(fit.max_db, 3), rounded_text(fit.max_phase_deg, 3),
                  engineering_text(band.from.value, "Hz"), engineering_text(band.to.value, "Hz"));
  text += "stable by the argument principle";
  if (stability.matignon_count)
    text += fmt::format("; Matignon counts {} unstable poles", *stability.matignon_count);
  if (stability.powers_of_s > 0.0) text += integrator_text(stability.powers_of_s, kept, fit.sections);
  return text + "\n";
}

}  // namespace

void add_fractional_options(CommandLine& line) {
  line.band("with a FRACTIONAL.toml: the band it is approximated over", "the end of that band");
  line.flag("real", "with a FRACTIONAL.toml: real poles and zeros only");
  line.flag("keep-integrator",
            "with a FRACTIONAL.toml: an integrator stays one, as poles at 0 (infinite gain at rest)");
}

int approximate_fractional(const CommandLine& line) {
  refuse_cascade_options(line);
  const std::optional<Band> band = line.maybe_band();
  if (!band) line.fail("a FRACTIONAL.toml needs --from-hz and --to-hz");
  const auto limit = line.maybe_positive("max-error-db");
  Provenance from;
  const FractionalInput input = read_fractional(line.files().front(), from);
  const int kept = line.has("keep-integrator") ? whole_integrators(input.stability.powers_of_s) : 0;
  if (line.has("keep-integrator") && kept == 0) {
    throw DesignError(line.files().front(), 0, "has no integrator that --keep-integrator could keep");
  }
  const BodePoints points =
      without_integrators(sampled_points(input.transfer, line.files().front(), *band), kept);
  const Stopwatch watch;
  DirectFit fit = fit_fractional(line, points, limit);
  add_integrators(fit.sections, kept);
  const double seconds = watch.seconds();
  const bool met = !limit || fit.max_db <= *limit;

  Json report = fit.report_json();
  report.erase("points");
  report["max_phase_deg"] = fit.max_phase_deg;
  report["stability"] = stability_json(input.stability);
  report["poles_at_0"] = kept;
  Json out = fit.sections.to_json();
  out["approximation"] = report;
  write_file(line.output_path(), to_text(timed_document("sections", from, out, seconds)));

  Json summary = {{"sections", fit.sections.sections.size()}, {"poles", fit.sections.pole_count()}};
  summary.update(report);
  summary["limit_met"] = met;
  std::string text = fractional_summary(fit, input.stability, kept, *band);
  if (!met) text += limit_not_met(*limit, "dB");
  print_summary(line, text, timed_document("approximate_summary", from, summary, seconds));
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
