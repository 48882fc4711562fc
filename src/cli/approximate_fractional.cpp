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

std::string fractional_summary(const DirectFit& fit, const FractionalStability& stability, const Band& band) {
  std::string text =
      fmt::format("{} sections, {} poles: {} dB and {} deg over {} .. {} Hz\n", fit.sections.sections.size(),
                  fit.sections.pole_count(), rounded_text(fit.max_db, 3), rounded_text(fit.max_phase_deg, 3),
                  rounded_text(band.from.value), rounded_text(band.to.value));
  text += "stable by the argument principle";
  if (stability.matignon_count)
    text += fmt::format("; Matignon counts {} unstable poles", *stability.matignon_count);
  if (stability.powers_of_s > 0.0)
    text += fmt::format("; contains an integrator of order {}", rounded_text(stability.powers_of_s));
  return text + "\n";
}

}  // namespace

void add_fractional_options(CommandLine& line) {
  line.band("with a FRACTIONAL.toml: the band it is approximated over", "the end of that band");
  line.flag("real", "with a FRACTIONAL.toml: real poles and zeros only");
}

int approximate_fractional(const CommandLine& line) {
  const std::optional<Band> band = line.maybe_band();
  if (!band) line.fail("a FRACTIONAL.toml needs --from-hz and --to-hz");
  const auto limit = line.maybe_positive("max-error-db");
  Provenance from;
  const FractionalInput input = read_fractional(line.files().front(), from);
  const BodePoints points = sampled_points(input.transfer, line.files().front(), *band);
  const Stopwatch watch;
  const DirectFit fit = fit_fractional(line, points, limit);
  const double seconds = watch.seconds();
  const bool met = !limit || fit.max_db <= *limit;

  Json report = fit.report_json();
  report.erase("points");
  report["max_phase_deg"] = fit.max_phase_deg;
  report["stability"] = stability_json(input.stability);
  Json out = fit.sections.to_json();
  out["approximation"] = report;
  write_file(line.output_path(), to_text(timed_document("sections", from, out, seconds)));

  Json summary = {{"sections", fit.sections.sections.size()}, {"poles", fit.sections.pole_count()}};
  summary.update(report);
  summary["limit_met"] = met;
  std::string text = fractional_summary(fit, input.stability, *band);
  if (!met) text += limit_not_met(*limit, "dB");
  print_summary(line, text, timed_document("approximate_summary", from, summary, seconds));
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
