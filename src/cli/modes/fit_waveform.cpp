#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "fit/waveform/waveform_fit.hpp"

namespace bodesmith::cli {
namespace {

/// What the fit makes smallest.
enum class Norm { rms, worst };

std::string_view to_string(Norm norm) {
  return norm == Norm::worst ? "worst" : "rms";
}

std::string waveform_summary(const WaveformFit& fit, const WaveformFitOptions& options) {
  std::string text = fmt::format("{} sections in the {} path; waveform error in percent of range:\n",
                                 fit.sections.sections.size(), to_string(options.path));
  text += fmt::format("  {:<34} {:>8} {:>8}", "", "rms", "worst");
  for (const WaveformErrorPoint& point : fit.error.points)
    text += fmt::format(" {:>8}", rounded_text(point.frequency.value) + " Hz");
  text += "\n";
  const auto row = [&text](const std::string& name, const WaveformError& error) {
    if (error.points.empty()) return;
    text += fmt::format("  {:<34} {:>8.3f} {:>8.3f}", name, error.rms_percent, error.worst_percent);
    for (const WaveformErrorPoint& point : error.points) text += fmt::format(" {:>8.3f}", point.rms_percent);
    text += "\n";
  };
  row("these sections", fit.error);
  row(fmt::format("best fixed gain ({})", rounded_text(fit.constant_gain)), fit.constant);
  row("no rate compensation", fit.none);
  row("magnitude-only cascade (eq. 18)", fit.magnitude_only);
  text += fmt::format(
      "no linear filter of any order goes below {} % ({}); a gain set by the measured frequency does\n",
      rounded_text(fit.lower_bound_percent, 3), options.worst ? "worst" : "rms");
  text += "between the operating frequencies:";
  for (std::size_t i = 0; i < fit.between.points.size(); ++i) {
    text +=
        fmt::format("  {} Hz {:.3f} (none {:.3f})", rounded_text(fit.between.points[i].frequency.value, 3),
                    fit.between.points[i].rms_percent, fit.between_none.points[i].rms_percent);
  }
  return text + "\n";
}

std::vector<Hertz> read_operating(const CommandLine& line) {
  std::vector<Hertz> out;
  for (const double f : line.all<double>("operating-hz")) {
    if (!(f > 0.0)) line.fail(fmt::format("--operating-hz has {}, expected frequencies above 0", f));
    out.push_back(Hertz{f});
  }
  return out;
}

}  // namespace

void add_waveform_options(CommandLine& line) {
  line.option<std::string>("norm", "rms: over the operating frequencies; worst: the worst of them", "rms");
  line.option<std::string>(
      "branch",
      "whole (after the branch switch), ascending or descending (that polynomial's own path); "
      "default: the one that needs a compensator");
  line.list<double>("operating-hz", "operating frequencies instead of the rate table's");
}

namespace {

/// No branch changes with the frequency: what would compensate it is a gain of 1.
int write_plain_gain(const CommandLine& line, const Provenance& from) {
  const Sections sections;
  write_file(line.output_path(), to_text(timed_document("sections", from, sections.to_json(), 0.0)));
  return print_summary(line, "the rate gains of both branches are 1: no filter is needed, its gain is 1\n",
                       timed_document("fit_summary", from, {{"sections", 0}, {"needed", false}}, 0.0));
}

}  // namespace

int fit_to_waveform(const CommandLine& line) {
  WaveformFitOptions options;
  if (line.has("order")) options.order = line.get<int>("order");
  options.seed = line.seed_value();
  const Norm norm = line.choice("norm", {Norm::rms, Norm::worst});
  options.worst = norm == Norm::worst;
  options.operating = read_operating(line);
  Provenance from;
  const Disturbance disturbance = Disturbance::read(line.get<std::string>("waveform"), from);
  const bool constant = disturbance.is_static(Disturbance::Branch::ascending) &&
                        disturbance.is_static(Disturbance::Branch::descending);
  if (constant && !line.has("branch")) return write_plain_gain(line, from);
  options.path =
      line.has("branch")
          ? line.choice("branch", {DrivenPath::whole, DrivenPath::ascending, DrivenPath::descending})
          : path_to_compensate(disturbance);
  const Stopwatch watch;
  const WaveformFit fit = fit_waveform(disturbance, options);
  const double seconds = watch.seconds();
  warn_each(fit.warnings);

  Json report = {{"branch", to_string(options.path)}, {"norm", to_string(norm)}};
  report.update(fit.report_json());
  Json out = fit.sections.to_json();
  out["waveform_fit"] = report;
  write_file(line.output_path(), to_text(timed_document("sections", from, out, seconds)));

  Json summary = {{"sections", fit.sections.sections.size()}};
  summary.update(report);
  return print_summary(line, waveform_summary(fit, options),
                       timed_document("fit_summary", from, summary, seconds));
}

}  // namespace bodesmith::cli
