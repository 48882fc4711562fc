#include <fmt/format.h>

#include <string>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/choice.hpp"

namespace bodesmith::cli {
namespace {

std::string cascade_summary(const CascadeFit& fit) {
  std::string text =
      fit.bounded ? fmt::format("bounded least squares, {} <= beta <= {}{}\n", rounded_text(fit.lower_bound),
                                rounded_text(fit.upper_bound),
                                fit.lower_bound == 0.0 ? " (a beta of 0 is allowed: that term is 1)" : "")
      : fit.least_squares && !fit.fewest_bands ? std::string("least squares of the orders\n")
      : fit.fewest_bands ? fmt::format("least squares of the fewest bands, {} for {} points\n",
                                       fit.terms.size(), fit.cascade.fit->points.size())
                         : std::string("interpolation of every point above the base\n");
  text += fmt::format("base {} Hz (gain {}; the curve has {} dB there, a consequence of the fit)\n",
                      rounded_text(fit.base.value), rounded_text(fit.cascade.gain),
                      rounded_text(fit.base_got_db, 3));
  for (const CascadeFitTerm& term : fit.terms) {
    text += fmt::format("  {:>8} .. {:<8} Hz  beta {:>9}  {}{}  (1 % of a gain changes it by up to {})\n",
                        rounded_text(term.band.from.value), rounded_text(term.band.to.value),
                        rounded_text(term.beta, 5),
                        term.beta == 0.0 ? "flat"
                        : term.rises     ? "lead"
                                         : "lag ",
                        term.at_bound ? ", at its bound" : "", rounded_text(term.max_sensitivity, 3));
  }
  text += "  frequency_hz  target_db    got_db\n";
  for (const Cascade::FitPoint& point : fit.cascade.fit->points) {
    text += fmt::format("  {:>12}  {:>9.4f} {:>9.4f}\n", rounded_text(point.frequency.value, 6),
                        point.wanted_db, point.got_db);
  }
  text += fmt::format("rms {} dB, largest error at a point {} dB, condition number {}\n",
                      rounded_text(fit.cascade.fit->rms_db, 3), rounded_text(fit.cascade.fit->max_db, 3),
                      rounded_text(fit.condition_number, 3));
  return text;
}

CascadeFitOptions read_cascade_options(const CommandLine& line, Provenance& from) {
  CascadeFitOptions options;
  if (const auto base = line.maybe_positive("base-hz")) options.base = Hertz{*base};
  options.beta_max = line.maybe_positive("beta-max");
  options.term_beta_max = line.all<double>("term-beta-max");
  if (options.beta_max && !options.term_beta_max.empty())
    line.fail("--beta-max and --term-beta-max exclude each other");
  options.beta_positive = line.has("beta-positive");
  if (options.beta_positive && !options.bounded())
    line.fail("--beta-positive needs --beta-max or --term-beta-max");
  if (line.has("corners")) options.corners = Cascade::read(line.get<std::string>("corners"), from).terms;
  if (line.has("fit-corners")) options.fitted_terms = line.integer("fit-corners", 1, 50);
  if (!options.corners.empty() && options.fitted_terms > 0)
    line.fail("--corners and --fit-corners exclude each other");
  options.surprise_db = line.positive("surprise-db");
  if (line.has("fewest-bands")) {
    options.fewest_bands_db = line.maybe_positive("max-error-db");
    if (!options.fewest_bands_db) line.fail("--fewest-bands needs --max-error-db");
  }
  return options;
}

}  // namespace

void add_cascade_options(CommandLine& line) {
  line.option<double>("base-hz",
                      "frequency of gain 1 at which the first band starts (default: the lowest point)");
  line.option<double>("beta-max",
                      "bounded fit (eq. 19): |beta| at most this; without it interpolation (eq. 18)");
  line.list<double>("term-beta-max", "a bound for every term instead (c_i of eq. 19), in their order");
  line.option<std::string>("corners", "a cascade.json whose lambda and x are taken; the orders are fitted");
  line.option<int>("fit-corners",
                   "number of terms whose lambda and x are fitted too (at least three points each)");
  line.flag("beta-positive", "with a bound: 0 <= beta, as eq. 19 prints it (cannot follow a dip)");
  line.flag("fewest-bands", "with --max-error-db: the fewest bands that keep every point within it");
  line.flag("allow-large-orders",
            "write the interpolation even where an order is beyond use (|beta| above 20)");
  line.option<double>(
      "surprise-db",
      "warn when the curve leaves the range of two neighbouring points, or depends on a single "
      "point, by more than this",
      0.5);
}

namespace {

int write_cascade(const CommandLine& line, const CascadeFit& fit, const Provenance& from, double seconds,
                  const std::string& why) {
  const std::optional<double> limit = line.maybe_positive("max-error-db");
  warn_each(fit.warnings);
  write_file(line.output_path(), to_text(timed_document("cascade", from, fit.to_json(), seconds)));

  const bool met = !limit || fit.cascade.fit->max_db <= *limit;
  Json summary = fit.to_json();
  if (limit) summary["limit_met"] = met;
  if (!why.empty()) summary["chosen_because"] = why;
  std::string text = cascade_summary(fit);
  if (!met) text += limit_not_met(*limit, "dB");
  return print_summary(line, text, timed_document("fit_summary", from, summary, seconds), met);
}

/// The interpolation cannot be built, and there is a limit to choose by: the fewest bands or sections.
int choose_other_fit(const CommandLine& line, const BodePoints& points, const CascadeFitOptions& options,
                     const std::string& reason, Provenance& from) {
  const std::optional<double> limit = line.maybe_positive("max-error-db");
  if (!limit || line.has("fewest-bands")) {
    throw DesignError(
        points.file, 0,
        reason + (line.has("fewest-bands")
                      ? "; expected a larger --max-error-db, a bound (--beta-max 5) or --direct"
                      : "; expected --max-error-db E (fit then chooses between fewer bands and sections), "
                        "--direct --max-error-db E for sections, or a bound (--beta-max 5)"));
  }
  const Stopwatch watch;
  FitChoice chosen = choose_fit(points, options, read_direct_options(line, from), *limit);
  const double seconds = watch.seconds();
  note(fmt::format("{}: {}", reason, chosen.why));
  if (chosen.cascade) return write_cascade(line, *chosen.cascade, from, seconds, chosen.why);
  note(fmt::format("{} holds sections, as with --direct", line.output_path().string()));
  return write_direct_fit(line, *chosen.sections, from, seconds, chosen.why);
}

}  // namespace

int fit_to_cascade(const CommandLine& line) {
  Provenance from;
  const CascadeFitOptions options = read_cascade_options(line, from);
  const BodePoints points = BodePoints::read_csv(line.files().front(), from);
  const bool as_asked = options.bounded() || !options.corners.empty() || options.fitted_terms > 0;
  const bool large = line.has("allow-large-orders");
  if (points.points.size() > kMostPointsToInterpolate && !options.fewest_bands_db && !as_asked && !large)
    return choose_other_fit(
        line, points, options,
        fmt::format("{} points would make {} bands", points.points.size(), points.points.size() - 1), from);
  const Stopwatch watch;
  ChartedFit charted;
  // With a limit the interpolation is held against what meets it, without one the paper's chart goes on.
  if (large || line.has("max-error-db"))
    charted.fit = fit_cascade(points, options);
  else
    charted = fit_by_chart(points, options);
  const double seconds = watch.seconds();
  const std::optional<std::string> unusable = why_unusable(charted.fit);
  if (unusable && !large && !as_asked) return choose_other_fit(line, points, options, *unusable, from);
  for (const std::string& step : charted.steps) note(step);
  return write_cascade(line, charted.fit, from, seconds, join(charted.steps, "; "));
}

}  // namespace bodesmith::cli
