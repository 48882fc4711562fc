#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/fit_modes.hpp"

namespace bodesmith::cli {

namespace po = boost::program_options;

int run_fit(const std::vector<std::string>& arguments) {
  CommandLine line(
      "fit", "bodesmith fit gains.csv -o cascade.json",
      "Finds a cascade of fractional lead-lags through wanted gains; or, with --direct, integer sections\n"
      "straight to them; or, with --waveform, sections for the compensating waveform of a disturbance:\n"
      "  bodesmith fit gains.csv --direct --order 4 -o sections.json\n"
      "  bodesmith fit --waveform disturbance.json --order 2 -o sections.json");
  line.options().add_options()("direct", "integer sections straight to the points")(
      "waveform", po::value<std::string>(), "a disturbance.json: sections that minimise the waveform error")(
      "order", po::value<int>(), "poles, with --direct (1 to 12) or --waveform (1 to 6)")(
      "real", "real poles and zeros only")(
      "max-error-db", po::value<double>(),
      "exit with 1 when a point is missed by more than this; --direct without "
      "--order takes the smallest order that keeps it");
  po::options_description cascade("To a cascade", 100);
  add_cascade_options(cascade);
  po::options_description direct("With --direct", 100);
  add_direct_options(direct);
  po::options_description waveform("With --waveform", 100);
  add_waveform_options(waveform);
  line.options().add(cascade).add(direct).add(waveform);
  line.positional("POINTS.csv", 0, 1);
  line.output("where the cascade or the sections go");
  line.seed();
  if (!line.parse(arguments)) return kDone;
  if (line.has("waveform")) {
    if (line.has("direct")) line.fail("--direct and --waveform exclude each other");
    if (!line.files().empty()) line.fail("--waveform takes its disturbance file and no POINTS.csv");
    return fit_to_waveform(line);
  }
  if (line.files().empty()) line.fail("POINTS.csv is missing");
  if (line.has("direct")) return fit_to_sections(line);
  for (const char* option : {"order", "real"}) {
    if (line.has(option)) line.fail(std::string("--") + option + " needs --direct or --waveform");
  }
  return fit_to_cascade(line);
}

}  // namespace bodesmith::cli
