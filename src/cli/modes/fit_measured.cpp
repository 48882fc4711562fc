#include <fmt/format.h>

#include <cmath>
#include <string>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "fit/measured/measured_fit.hpp"

namespace bodesmith::cli {
namespace {

std::string spread_text(double deviation) {
  return std::isfinite(deviation) ? rounded_text(deviation, 2) : "undetermined";
}

std::string root_line(const char* what, const MeasuredFit::Root& root) {
  std::string text = fmt::format("  {} {} Hz ± {}", what, rounded_text(root.frequency.value, 6),
                                 spread_text(root.frequency_deviation.value));
  if (root.pair) {
    text += fmt::format(", damping {} ± {}", rounded_text(root.damping), spread_text(root.damping_deviation));
  } else if (root.frequency.value < 0.0) {
    text += " (right half plane)";
  }
  return text + "\n";
}

std::string orders_text(const MeasuredFit& fit) {
  std::string text;
  for (const MeasuredFit::Order& tried : fit.orders) {
    text += fmt::format("  order {:<2}  held-out error {} of the noise, {} standard errors above the best\n",
                        tried.order, rounded_text(std::sqrt(tried.held_out)),
                        rounded_text(tried.against_best, 2));
  }
  return text;
}

std::string measured_summary(const MeasuredFit& fit) {
  std::string text = fmt::format("order {}: rms {} dB ({} %), largest {} dB; noise about {} %\n", fit.order,
                                 rounded_text(fit.rms_db, 3), rounded_text(fit.rms_percent, 3),
                                 rounded_text(fit.max_db, 3), rounded_text(fit.noise_percent, 3));
  for (const MeasuredFit::Root& pole : fit.poles) text += root_line(pole.pair ? "poles" : "pole ", pole);
  for (const MeasuredFit::Root& zero : fit.zeros) text += root_line(zero.pair ? "zeros" : "zero ", zero);
  if (fit.delay_s > 0.0) {
    text += fmt::format("  delay {} ± {}\n", engineering_text(fit.delay_s, "s", 4),
                        engineering_text(fit.delay_deviation_s, "s", 2));
  }
  return text + orders_text(fit);
}

}  // namespace

void add_measured_options(CommandLine& line) {
  line.option<int>("highest-order", "without --order: the choice by held-out points ends here", 16);
  line.flag("no-delay", "no pure delay in the model");
}

int fit_to_measurement(const CommandLine& line) {
  MeasuredFitOptions options;
  if (line.has("order"))
    options.order = line.integer("order", 1, 60);
  else
    options.max_order = line.integer("highest-order", 1, 60);
  options.delay = !line.has("no-delay");
  const std::optional<double> limit = line.maybe_positive("max-error-db");
  Provenance from;
  const FrequencyRecord record = FrequencyRecord::read_csv(line.get<std::string>("measured"), from);
  const Stopwatch watch;
  const MeasuredFit fit = fit_measured(record, options);
  const double seconds = watch.seconds();
  warn_each(fit.warnings);

  Json out = fit.sections.to_json();
  out["fit"] = fit.report_json();
  write_file(line.output_path(), to_text(timed_document("sections", from, out, seconds)));
  const bool met = !limit || fit.max_db <= *limit;
  Json summary = {{"sections", fit.sections.sections.size()}};
  summary.update(fit.report_json());
  if (limit) summary["limit_met"] = met;
  std::string text = measured_summary(fit);
  if (!met) text += limit_not_met(*limit, "dB");
  return print_summary(line, text, timed_document("fit_summary", from, summary, seconds), met);
}

}  // namespace bodesmith::cli
