#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"

namespace bodesmith::cli {

int run_fit(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fit", "bodesmith fit gains.csv -o cascade.json",
      "Fits a cascade of fractional lead-lags to target gains; or, with --direct, integer sections\n"
      "directly to them; or, with --waveform, sections for the compensating waveform of a disturbance;\n"
      "or, with --measured, a model of a measured complex response:\n"
      "  bodesmith fit gains.csv --direct --order 4 -o sections.json\n"
      "  bodesmith fit --waveform disturbance.json --order 2 -o sections.json\n"
      "  bodesmith fit --measured response.csv -o sections.json");
  line.flag("direct", "integer sections directly to the points");
  line.option<std::string>("waveform", "a disturbance.json: sections that minimise the waveform error");
  line.option<std::string>("measured",
                           "a measured response (frequency_hz,magnitude_db,phase_deg): its model");
  line.option<int>("order", "poles, with --direct (1 to 12), --waveform (1 to 6) or --measured");
  line.flag("real", "real poles and zeros only");
  line.option<double>(
      "max-error-db",
      "exit with 1 when the error at a point is larger; --direct without --order takes the "
      "smallest order that meets it, and points that cannot be interpolated get the fewest bands or "
      "sections, whichever takes fewer poles");
  line.positional("POINTS.csv", 0, 1);
  line.output("file for the cascade or the sections");
  line.seed();
  line.group("To a cascade");
  add_cascade_options(line);
  line.group("With --direct");
  add_direct_options(line);
  line.group("With --waveform");
  add_waveform_options(line);
  line.group("With --measured");
  add_measured_options(line);
  line.reads_measurements();
  if (!line.parse(arguments)) return kDone;
  if (line.has("measured")) {
    if (line.has("direct") || line.has("waveform"))
      line.fail("--measured cannot be combined with another kind of fit");
    if (!line.files().empty()) line.fail("--measured takes its response file and no POINTS.csv");
    for (const char* other : {"To a cascade", "With --direct", "With --waveform"}) line.refuse_group(other);
    return fit_to_measurement(line);
  }
  if (line.has("waveform")) {
    if (line.has("direct")) line.fail("--direct and --waveform cannot be combined");
    if (!line.files().empty()) line.fail("--waveform takes its disturbance file and no POINTS.csv");
    for (const char* other : {"To a cascade", "With --direct", "With --measured"}) line.refuse_group(other);
    return fit_to_waveform(line);
  }
  for (const char* other : {"With --waveform", "With --measured"}) line.refuse_group(other);
  if (line.files().empty()) line.fail("POINTS.csv is missing");
  if (line.has("direct")) {
    line.refuse_group("To a cascade");
    return fit_to_sections(line);
  }
  // With a limit sections are made where a cascade cannot be.
  if (!line.has("max-error-db")) line.refuse_group("With --direct");
  for (const char* option : {"order", "real"}) {
    if (line.has(option)) line.fail(std::string("--") + option + " needs --direct, --waveform or --measured");
  }
  return fit_to_cascade(line);
}

}  // namespace bodesmith::cli
