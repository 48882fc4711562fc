#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hertz_values.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/bode_loop.hpp"
#include "cli/response_source.hpp"
#include "cli/shared_options.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/steep_flanks.hpp"
#include "synthesis/realise_search.hpp"
#include "tolerance/design.hpp"
#include "tolerance/margins.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::cli {
namespace {

/// What a design's response is multiplied with to be that of a loop.
struct LoopPlant {
  std::vector<Hertz> grid;
  std::vector<Complex> response;
};

std::vector<Complex> complex_response(const ResponseSource& source, const std::vector<Hertz>& grid) {
  const LevelAndPhase curves = source.on_grid(grid);
  if (curves.phase_deg.empty())
    throw InputError(source.stem + ": has no phase, so that its loop has no margins");
  std::vector<Complex> out;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (std::isnan(curves.magnitude_db[i]))
      throw InputError(fmt::format("{}: has no value at {} Hz", source.stem, rounded_text(grid[i].value)));
    out.push_back(std::polar(from_decibel(curves.magnitude_db[i]), to_radians(curves.phase_deg[i])));
  }
  return out;
}

std::string kept_text(const char* what, const std::vector<double>& least_first, std::optional<double> nominal,
                      const char* unit) {
  if (least_first.empty() || !nominal) return fmt::format("no {}", what);
  return fmt::format("{} {} {}, {} or more in 95 of 100 circuits", what, rounded_text(std::abs(*nominal), 4),
                     unit, rounded_text(tolerance::kept_by_95(least_first), 4));
}

/// With --margins: measured ones at their own points, others where the loop turns.
std::optional<LoopPlant> read_loop_plant(const CommandLine& line, const tolerance::Design& design,
                                         Provenance& from) {
  if (!line.has("margins")) return std::nullopt;
  constexpr double kBeyond = 10.0;  // the loop's crossings lie about the corners
  constexpr int kPoints = 400;
  constexpr double kMostChange = 0.05;
  std::vector<ResponseSource> sources;
  for (const std::string& file : line.get<std::vector<std::string>>("margins"))
    sources.push_back(load_response(file, {}, from));
  const ResponseSource plant = sources.size() == 1 ? sources.front() : series_of(sources);
  for (const ResponseSource& source : sources) {
    if (source.own_frequencies.empty()) continue;
    if (source.own_frequencies.size() < 2)
      throw InputError(source.stem + ": holds one point, so that its loop has no margins");
    return LoopPlant{source.own_frequencies, complex_response(plant, source.own_frequencies)};
  }
  const Band band{Hertz{design.band.from.value / kBeyond}, Hertz{design.band.to.value * kBeyond}};
  const auto loop = [&](Hertz f) { return design.wanted(f) * complex_response(plant, {f}).front(); };
  LoopPlant out{judging_grid(loop, band, kPoints, kMostChange), {}};
  out.response = complex_response(plant, out.grid);
  return out;
}

/// The margins of the design's loop into json["margins"]; returns the lines of the summary.
std::string study_margins(const CommandLine& line, const tolerance::Design& design, const LoopPlant& plant,
                          const tolerance::Options& options, Json& json) {
  const tolerance::LoopStudy study = tolerance::study_loop(design, options, plant.grid, plant.response);
  json["margins"] = tolerance::to_json(study);
  const auto* phase = study.nominal.least_phase_margin();
  const auto* gain = study.nominal.least_gain_margin();
  const auto value = [](const auto* crossing, auto member) {
    return crossing != nullptr ? std::optional<double>(crossing->*member) : std::nullopt;
  };
  return fmt::format("  as a loop with {}:\n    {}\n    {}\n    {} of {} circuits unstable\n",
                     join(line.get<std::vector<std::string>>("margins"), ", "),
                     kept_text("phase margin", study.phase_margin_deg,
                               value(phase, &LoopMargins::GainCrossing::phase_margin_deg), "deg"),
                     kept_text("gain margin", study.gain_margin_db,
                               value(gain, &LoopMargins::PhaseCrossing::gain_margin_db), "dB"),
                     study.unstable == 0 ? std::string("none") : fmt::format("{}", study.unstable),
                     options.samples);
}

void declare_yield(CommandLine& line) {
  line.positional("SECTIONS.json|circuit.json|NETLIST.sub|PLAN.json…", 1, -1);
  line.flag("in-series", "the SECTIONS.json one after the other as one design (default: designs to compare)");
  line.output("yield.json (percentiles per frequency, ranking of the parts, what to buy)", true);
  line.seed();
  const tolerance::Spread s;
  line.option<std::uint64_t>("samples", "number of circuits drawn (default: 100000; of boards 10000)");
  line.option<std::string>(
      "distribution",
      "uniform within the tolerance, gaussian (tolerance = --sigmas standard deviations), or "
      "corners",
      "uniform");
  line.option<double>("sigmas", "number of standard deviations that a tolerance stands for", s.sigmas);
  add_tolerance_options(line);
  add_mismatch_options(line);
  line.option<std::string>("sections", "FPAA: deviations of the board as it runs from these sections");
  line.option<double>("temperature-low-c", "lowest temperature; each circuit drawn is at one of its own",
                      25.0);
  line.option<double>("temperature-high-c", "highest temperature; parts have their nominal values at 25",
                      25.0);
  line.option<double>("resistor-ppm", "temperature coefficient, +- ppm/K", s.resistor_ppm_per_k);
  line.option<double>("capacitor-ppm", "temperature coefficient, +- ppm/K", s.capacitor_ppm_per_k);
  line.option<int>("count", "number of frequencies, evenly spaced in log frequency", 60);
  line.band(
      "lowest frequency (default: the band in which the first design states its error, else its corners)",
      "highest frequency");
  line.option<double>("limit-db",
                      "count the circuits that stay within this, and say which tolerances to buy for it");
  line.option<double>("limit-deg", "the same for the phase");
  line.list<std::string>(
      "margins", "PLANT...: margins of the loop of the design and these in series, over its tolerances");
  line.option<double>("min-yield-percent", "exit with 1 when fewer circuits stay within the limits");
  line.group("The circuit of SECTIONS.json (circuit.json is taken as it was built)");
  add_circuit_options(line);
  add_parts_options(line);
  line.option<int>("threads", "0: all cores (one per process under mpirun)", 0);
}

/// What is not asked for is as the design states it.
tolerance::Spread read_spread(const CommandLine& line, const tolerance::Design& design) {
  using Kind = tolerance::Spread::Kind;
  tolerance::Spread s(design);
  s.kind = line.choice("distribution", {Kind::uniform, Kind::gaussian, Kind::corners});
  s.sigmas = line.positive("sigmas");
  static_cast<schematic::Tolerances&>(s) = read_tolerances(line, s);
  s.mismatch = read_mismatch(line, s.mismatch);
  s.temperature_low_c = line.get<double>("temperature-low-c");
  s.temperature_high_c = line.get<double>("temperature-high-c");
  s.resistor_ppm_per_k = line.get<double>("resistor-ppm");
  s.capacitor_ppm_per_k = line.get<double>("capacitor-ppm");
  for (const char* option : {"resistor-ppm", "capacitor-ppm"}) {
    if (line.has(option) && s.temperature_low_c == 25.0 && s.temperature_high_c == 25.0)
      line.fail(fmt::format(
          "--{} does nothing at 25 degrees, expected --temperature-low-c or --temperature-high-c", option));
  }
  return s;
}

tolerance::Options read_yield_options(const CommandLine& line) {
  tolerance::Options options;
  options.seed = line.seed_value();
  options.threads = line.integer("threads", 0, 1024);
  options.limit_db = line.maybe_positive("limit-db");
  options.limit_deg = line.maybe_positive("limit-deg");
  if (line.has("min-yield-percent") && !options.limit_db && !options.limit_deg) {
    line.fail("--min-yield-percent needs --limit-db or --limit-deg");
  }
  return options;
}

/// As many as asked for; else finer where the response turns fast.
std::vector<Hertz> read_grid(const CommandLine& line, const tolerance::Design& design) {
  const Band& corners = design.band;
  const int count = line.integer("count", 1, 100000);
  const Hertz low{line.has("from-hz") ? line.positive("from-hz") : corners.from.value};
  const Hertz high{line.has("to-hz") ? line.positive("to-hz") : corners.to.value};
  if (count == 1) return {low};
  return line.has("count") ? log_grid({low, high}, count) : judging_grid(design.wanted, {low, high}, count);
}

/// The op-amp circuit that `spice` would make of the sections.
tolerance::Design design_of_sections(const CommandLine& line, const Sections& sections,
                                     const std::string& name, Provenance& from) {
  synthesis::RealiseOptions options = read_parts_options(line, from);
  if (!line.has("capacitor-series") && !line.has("stock"))
    options.capacitors = synthesis::Series::named("E12");
  const synthesis::BuildChoice choice = design_circuit(line, sections, options, from);
  tolerance::Design out = tolerance::design_of_circuit(
      choice.best.made.circuit, sections, name,
      line.has("opamp") ? tolerance::OpAmps::as_built : tolerance::OpAmps::ideal);
  for (const std::string& reason : choice.passed_over)
    out.notes.push_back(fmt::format("{}: {}; designed as {}", name, reason, choice.best.how));
  return out;
}

tolerance::Design read_design(const CommandLine& line, const std::string& file, Provenance& from) {
  if (is_netlist(file)) return tolerance::design_of_netlist(read_netlist(file, from), file);
  const Node node = read_document(file, from);
  if (node.kind() == Node::Kind::object && node.string_or("schema", "") == "bodesmith.fpaa_plan/1") {
    std::optional<Sections> wanted;
    if (line.has("sections")) wanted = Sections::read(line.get<std::string>("sections"), from);
    return tolerance::design_of_plan(node, file, wanted);
  }
  if (node.kind() == Node::Kind::object && node.string_or("schema", "") == "bodesmith.circuit/1")
    return tolerance::design_of_file(node, file, tolerance::OpAmps::as_built);
  const Sections sections = sections_of(node, std::filesystem::path(file).parent_path(), from);
  return design_of_sections(line, rational_part(sections, node.file()), file, from);
}

std::vector<tolerance::Design> read_designs(const CommandLine& line, Provenance& from) {
  const std::vector<std::string> files = line.files();
  if (line.has("in-series"))
    return {design_of_sections(line, read_rational_series(files, from), join(files, ", "), from)};
  std::vector<tolerance::Design> out;
  for (const std::string& file : files) out.push_back(read_design(line, file, from));
  return out;
}

std::vector<Hertz> leave_out_nulls(const CommandLine& line, const std::vector<tolerance::Design>& designs,
                                   std::vector<Hertz>& grid) {
  const Hertz first = grid.front();
  std::vector<Hertz> out = tolerance::leave_out_nulls(designs, grid);
  if (grid.empty())
    throw InputError(fmt::format("{}: the response is 0 at {} and every other frequency asked for",
                                 line.files()[0], engineering_text(first.value, "Hz", 4)));
  return out;
}

double yield_percent(const tolerance::Result& result) {
  return 100.0 * static_cast<double>(result.within) / static_cast<double>(result.samples);
}

std::string describe(const tolerance::Design& design, const tolerance::Result& result,
                     const tolerance::Options& options, bool asked_band) {
  std::string text = fmt::format(
      "{}: {}{} parts, {} circuits, deviations from {}\n"
      "  95 of 100 circuits within {} dB, {} deg, {} % complex\n"
      "  (median {} dB, largest {} dB; all parts at their limits {} dB)\n"
      "  at worst over {} frequencies from {} to {} ({})\n",
      result.name, design.poles > 0 ? fmt::format("{} poles, ", design.poles) : "", design.parts.size(),
      result.samples, design.reference_name == "sections" ? "the sections" : "its own nominal response",
      rounded_text(result.worst_db.quantile(0.95), 3), rounded_text(result.worst_deg.quantile(0.95), 3),
      rounded_text(result.worst_percent.quantile(0.95), 3), rounded_text(result.worst_db.quantile(0.5), 3),
      rounded_text(result.worst_db.max, 3), rounded_text(result.worst_case_db, 3), result.grid.size(),
      engineering_text(result.grid.front().value, "Hz", 4),
      engineering_text(result.grid.back().value, "Hz", 4), asked_band ? "as asked" : design.band_name);
  if (options.limit_db || options.limit_deg) {
    text += fmt::format("  within the limits: {} %\n", rounded_text(yield_percent(result), 5));
  }
  if (result.grid.size() > 1 && has_flanks(design.wanted, {result.grid.front(), result.grid.back()}))
    text += fmt::format("  {}\n", kFlanksText);
  text += "  parts that matter most, by their share of the variance:";
  for (std::size_t i = 0; i < std::min<std::size_t>(4, result.ranking.size()); ++i) {
    const tolerance::PartRank& rank = result.ranking[i];
    text += fmt::format("{} {} {} %", i == 0 ? "" : ",", rank.part, rounded_text(100.0 * rank.share, 3));
  }
  return text + "\n";
}

std::string purchase_text(const std::vector<tolerance::Purchase>& all, double limit_db) {
  if (all.empty() || !all[0].meets) {
    return fmt::format("  no tolerance on the list keeps 95 % of the circuits within {} dB\n",
                       rounded_text(limit_db));
  }
  return fmt::format("  to keep 95 % within {} dB, buy {} % resistors and {} % capacitors ({} dB)\n",
                     rounded_text(limit_db), rounded_text(all[0].resistor_percent),
                     rounded_text(all[0].capacitor_percent), rounded_text(all[0].worst_db_95, 3));
}

/// One design in yield.json, and its lines of the summary.
Json design_json(const CommandLine& line, const tolerance::Design& design, const tolerance::Result& result,
                 const tolerance::Options& options, const std::optional<LoopPlant>& plant,
                 std::string& text) {
  const bool asked_band = line.has("from-hz") || line.has("to-hz");
  Json out = to_json(result, options);
  out["poles"] = design.poles;
  out["parts"] = design.parts.size();
  out["reference"] = design.reference_name;
  out["band_hz"] = {result.grid.front().value, result.grid.back().value};
  out["band"] = asked_band ? "as asked" : design.band_name;
  text += describe(design, result, options, asked_band);
  if (options.limit_db && design.reference_name == "sections") {
    const std::vector<tolerance::Purchase> buy =
        tolerance::tolerances_to_buy(design, options, *options.limit_db);
    out["to_buy"] = tolerance::to_json(buy);
    text += purchase_text(buy, *options.limit_db);
  }
  if (plant) text += study_margins(line, design, *plant, options, out);
  return out;
}

Json settings_json(const tolerance::Options& options) {
  const tolerance::Spread& s = options.spread;
  return {{"distribution", to_string(s.kind)},
          {"seed", options.seed},
          {"resistor_percent", s.resistor_percent},
          {"capacitor_percent", s.capacitor_percent},
          {"unit_capacitor_percent", s.mismatch.unit_percent},
          {"systematic_units", s.mismatch.systematic_units},
          {"temperature_c", {s.temperature_low_c, s.temperature_high_c}},
          {"designs", Json::array()}};
}

/// The results of all designs, in their order; only the leader of the team has complete ones.
std::vector<tolerance::Result> run_designs(const CommandLine& line,
                                           const std::vector<tolerance::Design>& designs,
                                           const std::vector<tolerance::Options>& of_each, const Team& team) {
  std::vector<tolerance::Result> results;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    tolerance::Options options = of_each[i];
    if (line.has("output"))
      options.checkpoint = line.output_path().string() + fmt::format(".checkpoint{}", i + 1);
    Progress progress("yield of " + designs[i].name);
    if (team.leads()) options.progress = [&progress](double fraction) { progress.at(fraction); };
    results.push_back(tolerance::run_monte_carlo(designs[i], options, team));
  }
  return results;
}

/// The design whose worst error in 95 of 100 circuits is smallest.
const tolerance::Result& best_design(const std::vector<tolerance::Result>& results) {
  return *std::ranges::min_element(results, [](const tolerance::Result& a, const tolerance::Result& b) {
    return a.worst_db.quantile(0.95) < b.worst_db.quantile(0.95);
  });
}

}  // namespace

int run_yield_controller(const std::vector<std::string>& arguments);

const std::vector<Command>& yield_verbs() {
  static const std::vector<Command> all = {
      {"controller", "what its parts do to the analog controller, with trims", run_yield_controller}};
  return all;
}

int run_yield(const std::vector<std::string>& arguments) {
  if (const Command* verb = find_command(yield_verbs(), arguments))
    return verb->run({arguments.begin() + 1, arguments.end()});
  CommandLine line(
      "yield", "bodesmith yield sections.json -o yield.json --limit-db 0.5",
      "What tolerances do to a design: Monte Carlo over op-amp RC parts or FPAA capacitors. With several files\n"
      "the designs are compared. Under `mpirun -n N` the work is shared; results do not depend on N.\n"
      "  bodesmith yield controller DISTURBANCE.json -o DIR   the same of the whole analog controller, with trims");
  declare_yield(line);
  if (!line.parse(arguments)) return kDone;
  tolerance::Options options = read_yield_options(line);
  const std::unique_ptr<Team> team = join_team();
  Provenance from;
  const std::vector<tolerance::Design> designs = read_designs(line, from);
  options.grid = read_grid(line, designs[0]);
  const std::vector<Hertz> nulls = leave_out_nulls(line, designs, options.grid);
  std::vector<std::optional<LoopPlant>> plants;
  for (const tolerance::Design& design : designs) plants.push_back(read_loop_plant(line, design, from));

  std::vector<tolerance::Options> of_each;
  for (const tolerance::Design& design : designs) {
    // What 95 % of 10 000 keep is known to a hundredth; a board takes a hundred times as long as a circuit.
    options.samples = line.maybe<std::uint64_t>("samples").value_or(design.board ? 10'000 : 100'000);
    options.spread = read_spread(line, design);
    options.job = job_text(options, from);
    of_each.push_back(options);
  }

  const Stopwatch watch;
  const std::vector<tolerance::Result> results = run_designs(line, designs, of_each, *team);
  if (!team->leads()) return kDone;
  Json json = json_header("yield", from);
  json.update(settings_json(of_each[0]));
  std::string text;
  double min_yield = 100.0;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    for (const std::string& one : designs[i].notes) note(one);
    json["designs"].push_back(design_json(line, designs[i], results[i], of_each[i], plants[i], text));
    min_yield = std::min(min_yield, yield_percent(results[i]));
  }
  if (!nulls.empty()) {
    std::string places = engineering_text(nulls.front().value, "Hz", 4);
    if (nulls.size() > 1)
      places = fmt::format("{} frequencies from {} to {}", nulls.size(), places,
                           engineering_text(nulls.back().value, "Hz", 4));
    json["left_out_hz"] = hertz_values(nulls);
    text += fmt::format("  left out where the response is below {} dB of its largest:\n    {}\n",
                        rounded_text(to_decibel(kJudgedFloor)), places);
  }
  if (designs.size() > 1) {
    const tolerance::Result& best = best_design(results);
    text += fmt::format("{} tolerates its parts best: {} dB in 95 of 100 circuits\n", best.name,
                        rounded_text(best.worst_db.quantile(0.95), 3));
    json["best"] = best.name;
  }
  const std::optional<double> required = line.maybe<double>("min-yield-percent");
  const bool met = !required || min_yield >= *required;
  if (!met) {
    text += fmt::format("the required yield of {} % is NOT met\n", rounded_text(*required));
    json["limit_missed"] = true;
  }
  json["timing_s"] = {{"compute", watch.seconds()}};
  if (line.has("output")) write_file(line.output_path(), to_text(json));
  return print_summary(line, text, json, met);
}

}  // namespace bodesmith::cli
