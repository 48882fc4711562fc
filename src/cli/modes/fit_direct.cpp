#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "fit/direct/direct_fit.hpp"

namespace bodesmith::cli {
namespace {

std::string root_text(const Complex& root) {
  if (root.imag() == 0.0) return " " + engineering_text(RadPerSecond{-root.real()}.hz().value, "Hz", 4);
  return fmt::format(" {} (damping {})", engineering_text(RadPerSecond{std::abs(root)}.hz().value, "Hz", 4),
                     rounded_text(-root.real() / std::abs(root), 3));
}

std::string roots_text(const char* name, const std::vector<Complex>& roots) {
  std::string text = fmt::format(" {}", name);
  if (roots.empty()) return fmt::format(" no {}", name);
  for (const Complex& root : roots) {
    if (root.imag() >= 0.0) text += root_text(root);
  }
  return text;
}

std::string direct_summary(const DirectFit& fit, bool real) {
  std::string text =
      fmt::format("{} sections ({} poles, {}): largest error {} dB, rms {} dB\n",
                  fit.sections.sections.size(), fit.sections.pole_count(), real ? "real" : "real or complex",
                  rounded_text(fit.max_db, 3), rounded_text(fit.rms_db, 3));
  for (const Section& section : fit.sections.sections) {
    text += " " + roots_text("zeros", section.zeros) + roots_text("poles", section.poles) + "\n";
  }
  if (fit.cancelled > 0) {
    text += fmt::format("{} of the poles asked for coincided with a zero and were left out\n", fit.cancelled);
  }
  if (fit.distant_zeros > 0) {
    text += fmt::format(
        "{} zeros far above the points made nothing better and were left out: the gain falls there\n",
        fit.distant_zeros);
  }
  if (fit.zeros_at_origin > 0) {
    text += fmt::format("{} zeros far below the points do as well at 0 Hz and stand there\n",
                        fit.zeros_at_origin);
  }
  return text;
}

}  // namespace

DirectFitOptions read_direct_options(const CommandLine& line, Provenance& from) {
  DirectFitOptions options;
  options.real = line.has("real");
  options.least_squares = line.has("least-squares");
  options.relative_degree = line.get<int>("relative-degree");
  options.use_phase = line.has("phase");
  options.min_damping = line.positive("least-damping");
  if (options.min_damping > 1.0) line.fail("--least-damping is above 1, where no pair is complex");
  options.seed = line.seed_value();
  if (const auto seconds = line.maybe_positive("max-seconds")) options.deadline = Deadline(*seconds);
  if (const auto corner = line.maybe_positive("max-corner-hz")) options.max_corner = Hertz{*corner};
  if (line.has("upper")) options.upper = BodePoints::read_csv(line.get<std::string>("upper"), from);
  if (line.has("lower")) options.lower = BodePoints::read_csv(line.get<std::string>("lower"), from);
  return options;
}

void add_direct_options(CommandLine& line) {
  line.option<double>("max-corner-hz", "no pole or zero above this");
  line.flag("least-squares", "smallest rms error in dB instead of the smallest maximum error");
  line.option<int>("relative-degree", "poles minus zeros", 0);
  line.flag("phase", "fit the column phase_deg too (stable, minimum-phase sections)");
  line.option<std::string>("upper", "CSV of Bode points the gain must stay below");
  line.option<std::string>("lower", "CSV of Bode points the gain must stay above");
  line.option<double>("max-seconds",
                      "time after which a direct fit starts nothing new and keeps the best so far");
  line.option<double>("least-damping", "smallest damping ratio of complex poles and zeros", 0.05);
}

int fit_to_sections(const CommandLine& line) {
  const std::optional<double> limit = line.maybe_positive("max-error-db");
  if (!line.has("order") && !limit) line.fail("--direct needs --order or --max-error-db");
  Provenance from;
  const BodePoints points = BodePoints::read_csv(line.files().front(), from);
  DirectFitOptions options = read_direct_options(line, from);
  if (line.has("order")) options.order = line.get<int>("order");
  const Stopwatch watch;
  const DirectFit fit = line.has("order") ? fit_directly(points, options)
                                          : fit_directly_within(points, options, *limit,
                                                                std::max(1, options.relative_degree), 12);
  const double seconds = watch.seconds();
  return write_direct_fit(line, fit, from, seconds, "");
}

int write_direct_fit(const CommandLine& line, const DirectFit& fit, const Provenance& from, double seconds,
                     const std::string& why) {
  const std::optional<double> limit = line.maybe_positive("max-error-db");
  warn_each(fit.warnings);
  Json out = fit.sections.to_json();
  out["fit"] = fit.report_json();
  write_file(line.output_path(), to_text(timed_document("sections", from, out, seconds)));

  const bool met = !limit || fit.max_db <= *limit;
  Json summary = {{"sections", fit.sections.sections.size()}, {"poles", fit.sections.pole_count()}};
  summary.update(fit.report_json());
  if (limit) summary["limit_met"] = met;
  if (!why.empty()) summary["chosen_because"] = why;
  std::string text = direct_summary(fit, line.has("real"));
  for (const std::string& one : fit.not_tried) text += "not tried in the time given: " + one + "\n";
  if (!met) text += limit_not_met(*limit, "dB");
  return print_summary(line, text, timed_document("fit_summary", from, summary, seconds), met);
}

}  // namespace bodesmith::cli
