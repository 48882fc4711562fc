#include "cli/simulate_modes.hpp"
#include "signal/columns.hpp"
#include "simulate/references.hpp"

namespace bodesmith::cli {
namespace {

simulate::ReferenceSpec read_reference(const CommandLine& line) {
  simulate::ReferenceSpec spec;
  spec.kind = line.get<std::string>("reference");
  spec.frequency = Hertz{line.positive("frequency-hz")};
  spec.last = Hertz{line.positive("last-hz")};
  spec.amplitude = line.positive("amplitude");
  spec.offset = line.maybe<double>("offset").value_or(spec.amplitude);
  spec.duration_s = line.positive("duration-s");
  spec.step_s = line.positive("step-s");
  spec.steps = line.get<int>("steps");
  spec.seed = line.seed_value();
  return spec;
}

}  // namespace

void add_input_options(CommandLine& line) {
  line.option<std::string>(
      "input", "CSV with time_s, u (in a loop: time_s, r); if it has a y, the result is compared with it");
  line.option<double>("fundamental-hz", "of a periodic --input (default: detected)");
  line.option<std::string>(
      "reference",
      "instead of --input: triangle, sine, stair, multisine, chirp or complex (the compound "
      "trajectory of 'Modeling and Control of Piezoelectric Hysteresis')");
  line.option<double>("frequency-hz", "of the reference; of a chirp's or multisine's lowest end", 1.0);
  line.option<double>("last-hz", "highest frequency of a chirp or multisine", 100.0);
  line.option<double>("amplitude", "half the height of the reference", 0.5);
  line.option<double>("offset", "middle of the reference (default: the amplitude, so that it starts at 0)");
  line.option<double>("duration-s", "length of the reference", 1.0);
  line.option<double>("step-s", "time between its samples", 1e-3);
  line.option<int>("steps", "levels of a stair", 10);
}

SimulationInput read_input(const CommandLine& line, bool loop, Provenance& from) {
  if (line.has("input") == line.has("reference")) line.fail("expected either --input or --reference");
  SimulationInput out;
  if (const auto fundamental = line.maybe_positive("fundamental-hz")) out.fundamental = Hertz{*fundamental};
  if (line.has("input")) {
    const std::string path = line.get<std::string>("input");
    out.record =
        loop ? TimeRecord::read_csv_column(path, from, column::reference) : TimeRecord::read_csv(path, from);
    return out;
  }
  if (out.fundamental) line.fail("--fundamental-hz belongs to --input; a reference has its --frequency-hz");
  const simulate::ReferenceSpec spec = read_reference(line);
  out.record = simulate::make_reference(spec);
  out.fundamental = simulate::fundamental_of(spec);
  return out;
}

}  // namespace bodesmith::cli
