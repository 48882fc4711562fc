#include "cli/reference_options.hpp"
#include "cli/simulate_modes.hpp"
#include "signal/columns.hpp"
#include "simulate/references.hpp"

namespace bodesmith::cli {

void add_input_options(CommandLine& line) {
  line.option<std::string>(
      "input", "CSV with time_s, u (in a loop: time_s, r); if it has a y, the result is compared with it");
  line.option<double>("fundamental-hz", "of a periodic --input (default: detected)");
  line.option<std::string>(
      "reference",
      "instead of --input: triangle, sine, stair (or steps), multisine, chirp or complex (the compound "
      "trajectory of 'Modeling and Control of Piezoelectric Hysteresis')");
  add_reference_options(line, UsualLength::second);
}

SimulationInput read_input(const CommandLine& line, bool loop, Provenance& from) {
  if (line.has("input") == line.has("reference")) line.fail("expected either --input or --reference");
  SimulationInput out;
  if (const auto fundamental = line.maybe_positive("fundamental-hz")) out.fundamental = Hertz{*fundamental};
  if (line.has("input")) {
    const std::string path = line.get<std::string>("input");
    out.record =
        loop ? TimeRecord::read_csv_column(path, from, column::reference) : TimeRecord::read_csv(path, from);
    out.record.require_measured_sizes();
    if (out.fundamental && !(2.0 * out.fundamental->value * out.record.step_s < 1.0))
      line.fail("--fundamental-hz is not below half the sampling rate of " + path);
    return out;
  }
  if (out.fundamental) line.fail("--fundamental-hz belongs to --input; a reference has its --frequency-hz");
  const simulate::ReferenceSpec spec =
      read_reference_options(line, line.get<std::string>("reference"), UsualLength::second);
  out.record = simulate::make_reference(spec);
  out.fundamental = simulate::fundamental_of(spec);
  return out;
}

}  // namespace bodesmith::cli
