#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/modes/simulate_modes.hpp"
#include "cli/modes/simulate_pictures.hpp"
#include "simulate/sweep.hpp"

namespace bodesmith::cli {
namespace {

/// "1,10,100" as numbers above 0.
std::vector<double> number_list(const CommandLine& line, const std::string& option) {
  std::vector<double> out;
  const std::string text = line.get<std::string>(option);
  for (const std::string_view part : split(text, ',')) {
    double value = 0.0;
    if (!parse_quantity(trim(part), value) || !(value > 0.0)) {
      line.fail(fmt::format("--{} has '{}', expected numbers above 0 with commas between", option, part));
    }
    out.push_back(value);
  }
  return out;
}

simulate::SweepOptions read_sweep_options(const CommandLine& line,
                                          const std::optional<simulate::LoopSetup>& loop,
                                          const simulate::Options& simulation) {
  if (loop && loop->drive) line.fail("a sweep cannot use a drive from a file, expected a feedforward model");
  simulate::SweepOptions options;
  if (line.has("reference")) options.kind = line.get<std::string>("reference");
  for (const double f : number_list(line, "sweep-frequency-hz")) options.frequencies.push_back(Hertz{f});
  options.amplitudes = line.has("sweep-amplitude") ? number_list(line, "sweep-amplitude")
                                                   : std::vector<double>{line.positive("amplitude")};
  options.offset = line.maybe<double>("offset");
  options.periods = line.get<int>("periods");
  options.samples_per_period = line.get<int>("samples-per-period");
  options.simulation = simulation;
  options.loop = loop;
  const bool signals = line.has("spectra") || line.has("loops");
  if (signals && line.has("resume"))
    line.fail("--resume takes over rows without their signals, expected no --spectra and no --loops");
  options.keep_periods = signals || line.has("report");
  return options;
}

std::string sweep_table(const std::vector<simulate::SweepRow>& rows) {
  std::string text = fmt::format("{:>12} {:>10} {:>10} {:>10} {:>10} {:>9} {:>10}\n", "frequency_hz",
                                 "amplitude", "rms_%", "max_%", "loop_%", "gain_db", "phase_deg");
  for (const auto& r : rows) {
    text += fmt::format("{:>12} {:>10} {:>10} {:>10} {:>10} {:>9} {:>10}\n", rounded_text(r.frequency.value),
                        rounded_text(r.amplitude), rounded_text(r.rms_percent, 3),
                        rounded_text(r.max_percent, 3), rounded_text(r.loop_height_percent, 3),
                        rounded_text(r.gain_db, 3), rounded_text(r.phase_deg, 3));
  }
  return text;
}

void write_sweep(const CommandLine& line, const std::vector<simulate::SweepRow>& rows,
                 const std::string& key) {
  OutputSet out;
  out.add(line.output_path(), simulate::sweep_csv(rows, key));
  if (line.has("spectra")) out.add(line.get<std::string>("spectra"), simulate::sweep_spectra_csv(rows));
  if (line.has("loops")) out.add(line.get<std::string>("loops"), simulate::sweep_loops_csv(rows));
  if (line.has("report")) {
    const std::string file = line.get<std::string>("report");
    out.add(file, picture_of(rows, line.files()[0], file));
  }
  out.commit();
}

}  // namespace

void add_sweep_options(CommandLine& line) {
  line.option<std::string>(
      "sweep-frequency-hz",
      "a table of tracking figures instead, for these frequencies (1,10,100); -o is then that "
      "table");
  line.option<std::string>("sweep-amplitude", "and these amplitudes");
  line.option<int>("periods", "of each run; the last one counts", 3);
  line.option<int>("samples-per-period", "of each run", 1000);
  line.flag("resume", "take over the rows that the table at -o already has");
}

int simulate_sweep(const CommandLine& line, const chain::Chain& model,
                   const std::optional<simulate::LoopSetup>& loop, const Provenance& from,
                   const simulate::Options& simulation) {
  const simulate::SweepOptions options = read_sweep_options(line, loop, simulation);
  std::string hashes;
  for (const InputFile& file : from.inputs) hashes += file.sha256;
  const std::string key = simulate::sweep_key(hashes, options);
  std::vector<simulate::SweepRow> known;
  if (line.has("resume")) known = simulate::read_sweep_csv(line.output_path(), key);

  catch_interrupts();
  const Stopwatch watch;
  const auto rows = simulate::run_sweep(model, options, known);
  const double seconds = watch.seconds();
  if (rows.empty()) throw Interrupted();
  write_sweep(line, rows, key);
  const std::size_t total = options.frequencies.size() * options.amplitudes.size();
  if (rows.size() < total) {
    note(fmt::format("stopped after {} of {} runs; --resume continues from there", rows.size(), total));
  }
  Json json = json_header("sweep_summary", from);
  json["timing_s"] = {{"compute", seconds}};
  json["runs"] = rows.size();
  json["runs_taken_over"] = known.size();
  json["complete"] = rows.size() == total;
  return print_summary(line, sweep_table(rows), json);
}

}  // namespace bodesmith::cli
