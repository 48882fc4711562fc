#include <fmt/format.h>

#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/fit_modes.hpp"
#include "fit/waveform_fit.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

std::string path_name(DrivenPath path) {
  return path == DrivenPath::whole ? "whole" : path == DrivenPath::ascending ? "ascending" : "descending";
}

std::string summary_text(const WaveformFit& fit, const WaveformFitOptions& options) {
  std::string text = fmt::format("{} sections in the {} path; waveform error in percent of range:\n",
                                 fit.sections.sections.size(), path_name(options.path));
  text += fmt::format("  {:<34} {:>8} {:>8}", "", "rms", "worst");
  for (const WaveformErrorPoint& point : fit.error.points)
    text += fmt::format(" {:>8}", rounded_text(point.frequency.value) + " Hz");
  text += "\n";
  const auto row = [&](const std::string& name, const WaveformError& error) {
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
      "no linear filter of any order goes below {} % ({}); a gain set by the measured frequency would\n",
      rounded_text(fit.lower_bound_percent, 3), options.worst ? "worst" : "rms");
  text += "between the operating frequencies:";
  for (size_t i = 0; i < fit.between.points.size(); ++i) {
    text +=
        fmt::format("  {} Hz {:.3f} (none {:.3f})", rounded_text(fit.between.points[i].frequency.value, 3),
                    fit.between.points[i].rms_percent, fit.between_none.points[i].rms_percent);
  }
  return text + "\n";
}

}  // namespace

void add_waveform_options(po::options_description& options) {
  options.add_options()("norm", po::value<std::string>()->default_value("rms"),
                        "rms: over the operating frequencies; worst: the worst of them")(
      "branch", po::value<std::string>(),
      "whole (behind the branch switch), ascending or descending (that polynomial's own path); default: what "
      "needs it")("operating-hz", po::value<std::vector<double>>()->multitoken(),
                  "operating frequencies instead of the rate table's");
}

int fit_to_waveform(const CommandLine& line) {
  WaveformFitOptions options;
  if (line.has("order")) options.order = line.get<int>("order");
  options.seed = line.seed_value();
  // Real sections unless asked otherwise: they fit every realisation.
  options.real = !line.has("pairs");
  const std::string norm = line.get<std::string>("norm");
  if (norm != "rms" && norm != "worst") line.fail(fmt::format("--norm is '{}', expected rms or worst", norm));
  options.worst = norm == "worst";
  if (line.has("operating-hz")) {
    for (const double f : line.get<std::vector<double>>("operating-hz")) {
      if (!(f > 0.0)) line.fail(fmt::format("--operating-hz has {}, expected frequencies above 0", f));
      options.operating.push_back(Hertz{f});
    }
  }
  Provenance from;
  const Disturbance disturbance = Disturbance::read(line.get<std::string>("waveform"), from);
  if (line.has("branch")) {
    const std::string branch = line.get<std::string>("branch");
    if (branch == "whole")
      options.path = DrivenPath::whole;
    else if (branch == "ascending")
      options.path = DrivenPath::ascending;
    else if (branch == "descending")
      options.path = DrivenPath::descending;
    else
      line.fail(fmt::format("--branch is '{}', expected whole, ascending or descending", branch));
  } else {
    options.path = path_to_compensate(disturbance);
  }
  const Stopwatch watch;
  const WaveformFit fit = fit_waveform(disturbance, options);
  const double seconds = watch.seconds();
  for (const std::string& warning : fit.warnings) note("warning: " + warning);

  Json report;
  report["branch"] = path_name(options.path);
  report["norm"] = norm;
  report.update(fit.report_json());
  Json out = json_header("sections", from);
  out.update(fit.sections.to_json());
  out["waveform_fit"] = report;
  out["timing_s"] = {{"compute", seconds}};
  write_file(line.output_path(), to_text(out));

  Json summary = json_header("fit_summary", from);
  summary["sections"] = fit.sections.sections.size();
  summary.update(report);
  summary["timing_s"] = {{"compute", seconds}};
  print_summary(line, summary_text(fit, options), summary);
  return kDone;
}

}  // namespace bodesmith::cli
