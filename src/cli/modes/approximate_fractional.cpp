#include <fmt/format.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "project/design/fractional_fit.hpp"

namespace bodesmith::cli {
namespace {

std::string integrator_text(const project::FractionalFit& made) {
  const double power = made.stability.powers_of_s;
  const int kept = made.poles_at_zero;
  std::string text = fmt::format("; contains an integrator of order {}", rounded_text(power));
  if (kept > 0) return text + fmt::format(", kept as {} pole{} at 0", kept, kept == 1 ? "" : "s");
  return text +
         fmt::format(
             ", which these sections make down to {}: at rest their gain is {} dB (--keep-integrator: a pole at 0)",
             engineering_text(made.lowest_pole().value, "Hz"),
             rounded_text(to_decibel(std::abs(made.fit.sections.dc_gain())), 3));
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

std::string fractional_summary(const project::FractionalFit& made, const Band& band) {
  const DirectFit& fit = made.fit;
  std::string text =
      fmt::format("{} sections, {} poles: {} dB and {} deg over {} to {}\n", fit.sections.sections.size(),
                  fit.sections.pole_count(), rounded_text(fit.max_db, 3), rounded_text(fit.max_phase_deg, 3),
                  engineering_text(band.from.value, "Hz"), engineering_text(band.to.value, "Hz"));
  text += "stable by the argument principle";
  if (made.stability.matignon_count)
    text += fmt::format("; Matignon counts {} unstable poles", *made.stability.matignon_count);
  if (made.stability.powers_of_s > 0.0) text += integrator_text(made);
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
  project::FractionalFitOptions options;
  options.band = *band;
  options.max_error_db = line.maybe_positive("max-error-db");
  if (line.has("order")) options.order = line.get<int>("order");
  options.max_order = line.get<int>("max-order");
  options.direct.real = line.has("real");
  options.keep_integrator = line.has("keep-integrator");
  options.direct.seed = line.seed_value();
  Provenance from;
  const std::string file = line.files().front();
  const FractionalTransfer transfer = FractionalTransfer::read(file, from);
  const Stopwatch watch;
  const project::FractionalFit made = project::fit_fractional(transfer, file, options);
  const double seconds = watch.seconds();
  const bool met = made.within(options.max_error_db);

  const Json report = made.report_json();
  Json out = made.fit.sections.to_json();
  out["approximation"] = report;
  write_file(line.output_path(), to_text(timed_document("sections", from, out, seconds)));

  Json summary = {{"sections", made.fit.sections.sections.size()}, {"poles", made.fit.sections.pole_count()}};
  summary.update(report);
  summary["limit_met"] = met;
  std::string text = fractional_summary(made, *band);
  if (!met) text += limit_not_met(*options.max_error_db, "dB");
  return print_summary(line, text, timed_document("approximate_summary", from, summary, seconds), met);
}

}  // namespace bodesmith::cli
