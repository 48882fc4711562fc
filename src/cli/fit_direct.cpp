#include <fmt/format.h>

#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/fit_modes.hpp"
#include "fit/direct_fit.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

std::string summary_text(const DirectFit& fit, bool real) {
  std::string text =
      fmt::format("{} sections ({} poles, {}): largest miss {} dB, rms {} dB\n", fit.sections.sections.size(),
                  fit.sections.pole_count(), real ? "real" : "real or complex", rounded_text(fit.max_db, 3),
                  rounded_text(fit.rms_db, 3));
  for (const Section& section : fit.sections.sections) {
    text += " ";
    for (const char* kind : {"zeros", "poles"}) {
      text += fmt::format(" {}", kind);
      for (const auto& root : kind == std::string("zeros") ? section.zeros : section.poles) {
        if (root.imag() < 0.0) continue;
        text +=
            root.imag() == 0.0
                ? fmt::format(" {} Hz", rounded_text(RadPerSecond{-root.real()}.hz().value))
                : fmt::format(" {} Hz (damping {})", rounded_text(RadPerSecond{std::abs(root)}.hz().value),
                              rounded_text(-root.real() / std::abs(root), 3));
      }
    }
    text += "\n";
  }
  if (fit.cancelled > 0)
    text += fmt::format("{} of the poles asked for met a zero and were left out\n", fit.cancelled);
  return text;
}

}  // namespace

void add_direct_options(po::options_description& options) {
  options.add_options()("max-corner-hz", po::value<double>(), "no pole or zero above this")(
      "least-squares", "smallest rms dB instead of the smallest largest miss")(
      "relative-degree", po::value<int>()->default_value(0), "poles minus zeros")(
      "phase", "fit the column phase_deg too (stable, minimum-phase sections)")(
      "upper", po::value<std::string>(), "CSV of Bode points the gain must stay below")(
      "lower", po::value<std::string>(), "CSV of Bode points the gain must stay above")(
      "least-damping", po::value<double>()->default_value(0.05), "of complex poles and zeros");
}

int fit_to_sections(const CommandLine& line) {
  DirectFitOptions options;
  options.real = line.has("real");
  options.least_squares = line.has("least-squares");
  options.relative_degree = line.get<int>("relative-degree");
  options.use_phase = line.has("phase");
  options.least_damping = line.positive("least-damping");
  options.seed = line.seed_value();
  if (line.maybe<double>("max-corner-hz")) options.max_corner = Hertz{line.positive("max-corner-hz")};
  std::optional<double> limit;
  if (line.maybe<double>("max-error-db")) limit = line.positive("max-error-db");
  if (!line.has("order") && !limit) line.fail("--direct needs --order or --max-error-db");

  Provenance from;
  const BodePoints points = BodePoints::read_csv(line.files().front(), from);
  if (line.has("upper")) options.upper = BodePoints::read_csv(line.get<std::string>("upper"), from);
  if (line.has("lower")) options.lower = BodePoints::read_csv(line.get<std::string>("lower"), from);
  const Stopwatch watch;
  DirectFit fit;
  if (line.has("order")) {
    options.order = line.get<int>("order");
    fit = fit_directly(points, options);
  } else {
    for (options.order = std::max(1, options.relative_degree); options.order <= 12; ++options.order) {
      fit = fit_directly(points, options);
      if (fit.max_db <= *limit) break;
    }
  }
  const double seconds = watch.seconds();
  for (const std::string& warning : fit.warnings) note("warning: " + warning);

  Json out = json_header("sections", from);
  out.update(fit.sections.to_json());
  out["fit"] = fit.report_json();
  out["timing_s"] = {{"compute", seconds}};
  write_file(line.output_path(), to_text(out));

  const bool met = !limit || fit.max_db <= *limit;
  Json summary = json_header("fit_summary", from);
  summary["sections"] = fit.sections.sections.size();
  summary["poles"] = fit.sections.pole_count();
  summary.update(fit.report_json());
  if (limit) summary["limit_met"] = met;
  summary["timing_s"] = {{"compute", seconds}};
  std::string text = summary_text(fit, options.real);
  if (!met) text += fmt::format("the limit of {} dB is NOT met\n", rounded_text(*limit));
  print_summary(line, text, summary);
  return met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
