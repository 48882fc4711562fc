#include <fmt/format.h>

#include <string>

#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/fit_modes.hpp"
#include "fit/cascade_fit.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

std::string summary_text(const CascadeFit& fit) {
  std::string text =
      fit.bounded
          ? fmt::format("bounded least squares, {} <= beta <= {}{}\n", rounded_text(fit.lower_bound),
                        rounded_text(fit.upper_bound),
                        fit.lower_bound == 0.0 ? " (a beta of 0 counts as allowed: that term is 1)" : "")
          : std::string("interpolation of every point above the base\n");
  text += fmt::format("base {} Hz (gain {}; the curve has {} dB there, a consequence)\n",
                      rounded_text(fit.base.value), rounded_text(fit.cascade.gain),
                      rounded_text(fit.base_got_db, 3));
  for (const CascadeFitTerm& term : fit.terms) {
    text += fmt::format("  {:>8} .. {:<8} Hz  beta {:>9}  {}{}  (1 % of a gain moves it by up to {})\n",
                        rounded_text(term.band.from.value), rounded_text(term.band.to.value),
                        rounded_text(term.beta, 5),
                        term.beta == 0.0 ? "flat"
                        : term.rises     ? "lead"
                                         : "lag ",
                        term.at_bound ? ", at its bound" : "", rounded_text(term.max_sensitivity, 3));
  }
  text += "  frequency_hz  wanted_db    got_db\n";
  for (const Cascade::FitPoint& point : fit.cascade.fit->points) {
    text += fmt::format("  {:>12}  {:>9.4f} {:>9.4f}\n", rounded_text(point.frequency.value, 6),
                        point.wanted_db, point.got_db);
  }
  text += fmt::format("rms {} dB, largest miss {} dB, condition number {}\n",
                      rounded_text(fit.cascade.fit->rms_db, 3), rounded_text(fit.cascade.fit->max_db, 3),
                      rounded_text(fit.condition_number, 3));
  return text;
}

}  // namespace

void add_cascade_options(po::options_description& options) {
  options.add_options()("base-hz", po::value<double>(),
                        "frequency of gain 1 at which the first band starts (default: the lowest point)")(
      "beta-max", po::value<double>(),
      "bounded fit (eq. 19): |beta| at most this; without it interpolation (eq. 18)")(
      "beta-positive", "with --beta-max: 0 <= beta, as eq. 19 prints it (cannot follow a dip)")(
      "fewest-bands",
      "with --max-error-db: the fewest bands with which no point is missed by more than that")(
      "surprise-db", po::value<double>()->default_value(0.5),
      "warn when the curve leaves what two neighbouring points span, or hangs on one point, by more than "
      "this");
}

int fit_to_cascade(const CommandLine& line) {
  CascadeFitOptions options;
  if (line.maybe<double>("base-hz")) options.base = Hertz{line.positive("base-hz")};
  if (line.maybe<double>("beta-max")) options.beta_max = line.positive("beta-max");
  options.beta_positive = line.has("beta-positive");
  if (options.beta_positive && !options.beta_max) line.fail("--beta-positive needs --beta-max");
  options.surprise_db = line.positive("surprise-db");
  std::optional<double> limit;
  if (line.maybe<double>("max-error-db")) limit = line.positive("max-error-db");

  if (line.has("fewest-bands")) {
    if (!limit) line.fail("--fewest-bands needs --max-error-db");
    options.fewest_bands_db = limit;
  }
  Provenance from;
  const BodePoints points = BodePoints::read_csv(line.files().front(), from);
  const Stopwatch watch;
  const CascadeFit fit = fit_cascade(points, options);
  const double seconds = watch.seconds();
  for (const std::string& warning : fit.warnings) note("warning: " + warning);

  Json out = json_header("cascade", from);
  out.update(fit.to_json());
  out["timing_s"] = {{"compute", seconds}};
  write_file(line.output_path(), to_text(out));

  Json summary = json_header("fit_summary", from);
  summary.update(fit.to_json());
  const bool met = !limit || fit.cascade.fit->max_db <= *limit;
  if (limit) summary["limit_met"] = met;
  summary["timing_s"] = {{"compute", seconds}};
  std::string text = summary_text(fit);
  if (!met) text += fmt::format("the limit of {} dB is NOT met\n", rounded_text(*limit));
  print_summary(line, text, summary);
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
