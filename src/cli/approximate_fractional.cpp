#include <fmt/format.h>

#include <cmath>

#include "approximate/fractional_transfer.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/approximate_modes.hpp"
#include "cli/commands.hpp"
#include "fit/direct_fit.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

/// The exact response as complex Bode points, 40 a decade.
BodePoints sample(const FractionalTransfer& transfer, const std::string& file, Band band) {
  BodePoints out;
  out.file = file;
  const int count = std::max(20, static_cast<int>(40.0 * std::log10(band.to.value / band.from.value)));
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

}  // namespace

void add_fractional_options(po::options_description& options) {
  options.add_options()("from-hz", po::value<double>(),
                        "with a FRACTIONAL.toml: the band it is approximated over")(
      "to-hz", po::value<double>(), "the end of that band")(
      "real", "with a FRACTIONAL.toml: real poles and zeros only");
}

int approximate_fractional(const CommandLine& line) {
  if (!line.has("from-hz") || !line.has("to-hz")) line.fail("a FRACTIONAL.toml needs --from-hz and --to-hz");
  const Band band{Hertz{line.positive("from-hz")}, Hertz{line.positive("to-hz")}};
  if (!(band.to > band.from)) line.fail("--to-hz is not above --from-hz");
  Provenance from;
  const FractionalTransfer transfer = FractionalTransfer::read(line.files().front(), from);
  const FractionalStability stability = fractional_stability(transfer.denominator);
  if (!stability.stable()) {
    throw DesignError(
        line.files().front(), 0,
        fmt::format("is unstable ({} poles in the right half plane), expected a stable transfer function",
                    stability.unstable_poles));
  }
  if (fractional_stability(transfer.numerator).unstable_poles > 0) {
    throw DesignError(line.files().front(), 0,
                      "has zeros in the right half plane, expected a minimum-phase one");
  }
  const BodePoints points = sample(transfer, line.files().front(), band);
  DirectFitOptions options;
  options.use_phase = true;
  options.real = line.has("real");
  options.seed = line.seed_value();
  const auto limit = line.maybe<double>("max-error-db");
  const Stopwatch watch;
  DirectFit fit;
  const int first = line.has("order") ? line.get<int>("order") : limit ? 1 : 4;
  const int last = line.has("order") || !limit ? first : std::min(12, line.get<int>("max-order"));
  for (options.order = first; options.order <= last; ++options.order) {
    fit = fit_directly(points, options);
    if (limit && fit.max_db <= *limit) break;
  }
  const double seconds = watch.seconds();
  const bool met = !limit || fit.max_db <= *limit;

  Json report = fit.report_json();
  report.erase("points");
  report["max_phase_deg"] = fit.max_phase_deg;
  report["stability"] = stability_json(stability);
  Json out = json_header("sections", from);
  out.update(fit.sections.to_json());
  out["approximation"] = report;
  out["timing_s"] = {{"compute", seconds}};
  write_file(line.output_path(), to_text(out));

  Json summary = json_header("approximate_summary", from);
  summary["sections"] = fit.sections.sections.size();
  summary["poles"] = fit.sections.pole_count();
  summary.update(report);
  summary["limit_met"] = met;
  summary["timing_s"] = {{"compute", seconds}};
  std::string text =
      fmt::format("{} sections, {} poles: {} dB and {} deg over {} .. {} Hz\n", fit.sections.sections.size(),
                  fit.sections.pole_count(), rounded_text(fit.max_db, 3), rounded_text(fit.max_phase_deg, 3),
                  rounded_text(band.from.value), rounded_text(band.to.value));
  text += "stable by the argument principle";
  if (stability.matignon_count)
    text += fmt::format("; Matignon counts {} unstable poles", *stability.matignon_count);
  if (stability.powers_of_s > 0.0)
    text += fmt::format("; holds an integrator of order {}", rounded_text(stability.powers_of_s));
  text += "\n";
  if (!met) text += fmt::format("the limit of {} dB is NOT met\n", rounded_text(*limit));
  print_summary(line, text, summary);
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
