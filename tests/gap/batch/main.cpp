// gap_batch: hides effects in many cases, lets the search name them, prints what became of each and the
// confusion tables of docs/gap.md. Built on request only (cmake --build build --target gap_batch).
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/program_options.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "gap/cases/case_list.hpp"
#include "gap/cases/solve.hpp"
#include "gap/cases/tables.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;
using bodesmith::InputError;
using bodesmith::Json;
using hidden::Kind;
using hidden::Outcome;
using hidden::Specification;
using hidden::World;

std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> out;
  for (const auto word : bodesmith::split(list, ','))
    if (!bodesmith::trim(word).empty()) out.emplace_back(bodesmith::trim(word));
  return out;
}

struct Settings {
  hidden::CaseOptions cases;
  hidden::SolveOptions solve;
  int jobs = 1;
  std::size_t rows = 0;
  std::vector<std::string> bases, effects, kinds;
  std::string only, output, records;
  bool list = false, tables = false;
};

World world_of(const std::string& name) {
  for (const World w : {World::formulas, World::responses, World::ngspice})
    if (name == hidden::to_string(w)) return w;
  throw InputError(fmt::format("--worlds {}: is not one of formulas, responses, ngspice", name));
}

/// Empty help: run. Otherwise the text to print.
Settings read_settings(int argc, char** argv, std::string& help) {
  Settings s;
  std::string worlds, sizes, bases, effects, kinds;
  po::options_description options("Options");
  auto add = options.add_options();
  add("help,h", "this text");
  add("worlds", po::value(&worlds)->default_value("formulas"),
      "who makes the records: formulas,responses,ngspice");
  add("bases", po::value(&bases), "only these base chains, e.g. gain,resonator");
  add("effects", po::value(&effects),
      "only these hidden things, e.g. creep,backlash (controls and outsiders too)");
  add("kinds", po::value(&kinds), "only these: effect,pair,control,outside");
  add("sizes", po::value(&sizes)->default_value("5"), "of the effect over the noise, e.g. 3,5,10,50");
  add("repeats", po::value(&s.cases.repeats)->default_value(1), "variants of each case");
  add("seed", po::value(&s.cases.seed)->default_value(1), "of everything that is drawn");
  add("pairs", po::value(&s.cases.pairs)->default_value(12), "pairs of effects, at ten times the noise");
  add("controls", po::value(&s.cases.controls)->default_value(0.5), "controls per effect case");
  add("outside", po::value(&s.cases.outside)->default_value(1), "times each thing outside the catalogue");
  add("rows", po::value(&s.rows)->default_value(0), "of the records to fit; 0: drawn, 2000 to 20000");
  add("only", po::value(&s.only), "only cases whose line's key contains this (see --list)");
  add("threads", po::value(&s.solve.threads)->default_value(1), "of one search");
  add("jobs", po::value(&s.jobs)->default_value(2), "cases at a time");
  add("max-seconds", po::value(&s.solve.max_seconds)->default_value(0.0),
      "stop a search after these (0: never)");
  add("explain", po::bool_switch(&s.solve.explain), "print every ranking");
  add("list", po::bool_switch(&s.list), "print the cases' keys and stop");
  add("tables", po::bool_switch(&s.tables), "only the tables of what the --output file holds already");
  add("records", po::value(&s.records),
      "write model and records of each case into folders here, and do not search");
  add("output,o", po::value(&s.output),
      "a file of results, one a line; what is in it already is not run again");
  po::variables_map map;
  try {
    po::store(po::parse_command_line(argc, argv, options), map);
    po::notify(map);
  } catch (const po::error& e) {
    throw InputError(e.what());
  }
  if (map.count("help") > 0) {
    std::ostringstream text;
    text << "Example: gap_batch --worlds formulas,responses --sizes 3,5,10,50 --repeats 2 -o results.jsonl\n"
         << options;
    help = text.str();
    return s;
  }
  s.cases.worlds.clear();
  for (const auto& w : words(worlds)) s.cases.worlds.push_back(world_of(w));
  s.cases.ratios.clear();
  for (const auto& w : words(sizes)) {
    double value = 0.0;
    if (!bodesmith::parse_number(w, value) || !(value > 0.0))
      throw InputError(fmt::format("--sizes {}: is not a number above 0", w));
    s.cases.ratios.push_back(value);
  }
  s.bases = words(bases);
  s.effects = words(effects);
  s.kinds = words(kinds);
  if (s.jobs < 1 || s.solve.threads < 1 || s.cases.repeats < 1)
    throw InputError("--jobs, --threads and --repeats: expected at least 1");
  if (s.solve.explain) s.jobs = 1;  // rankings of two cases would mix
  return s;
}

bool among(const std::vector<std::string>& list, const std::string& word) {
  return list.empty() || std::find(list.begin(), list.end(), word) != list.end();
}

bool wanted(const Settings& s, const Specification& c) {
  const bool effect =
      s.effects.empty() ||
      std::any_of(c.what.begin(), c.what.end(), [&](const std::string& w) { return among(s.effects, w); });
  return effect && among(s.bases, c.base) && among(s.kinds, hidden::to_string(c.kind)) &&
         c.key().find(s.only) != std::string::npos;
}

Json to_json(const Outcome& o) {
  return {{"key", o.specification.key()},
          {"verdict", o.verdict},
          {"named", o.named},
          {"tied", o.tied},
          {"closure", o.closure},
          {"noise_share", o.noise_share},
          {"samples", o.samples},
          {"seconds", o.seconds},
          {"right", o.right},
          {"exact", o.exact}};
}

/// Outcomes of an earlier run, by key. A last line that was cut off is left out.
std::map<std::string, Json> read_results(const std::string& file) {
  std::map<std::string, Json> out;
  if (file.empty() || !fs::exists(file)) return out;
  const std::string text = bodesmith::read_file(file);
  for (const auto line : bodesmith::split(text, '\n')) {
    const Json j = Json::parse(line, nullptr, false);
    if (!j.is_discarded() && j.contains("key")) out[j.at("key").get<std::string>()] = j;
  }
  return out;
}

Outcome from_json(const Specification& s, const Json& j) {
  Outcome o;
  o.specification = s;
  j.at("verdict").get_to(o.verdict);
  j.at("named").get_to(o.named);
  j.at("tied").get_to(o.tied);
  j.at("closure").get_to(o.closure);
  j.at("noise_share").get_to(o.noise_share);
  j.at("samples").get_to(o.samples);
  j.at("seconds").get_to(o.seconds);
  j.at("right").get_to(o.right);
  j.at("exact").get_to(o.exact);
  return o;
}

void write_records(const hidden::Case& c, const fs::path& folder) {
  fs::create_directories(folder);
  bodesmith::write_file(folder / "model.toml", c.model);
  for (const auto* side : {&c.train, &c.holdout}) {
    for (const auto& r : *side) {
      std::string text = "time_s,u,y\n";
      for (std::size_t i = 0; i < r.size(); ++i)
        text += fmt::format("{:.17g},{:.17g},{:.17g}\n", r.time_s(i), r.u[i], r.y[i]);
      bodesmith::write_file(folder / r.file, text);
    }
  }
  for (const auto* side : {&c.train_responses, &c.holdout_responses}) {
    for (const auto& r : *side) {
      std::string text = "frequency_hz,magnitude_db,phase_deg\n";
      for (std::size_t i = 0; i < r.frequency.size(); ++i)
        text += fmt::format("{:.17g},{:.17g},{:.17g}\n", r.frequency[i].value,
                            20.0 * std::log10(std::abs(r.response[i])),
                            std::arg(r.response[i]) * 180.0 / std::numbers::pi);
      bodesmith::write_file(folder / r.file, text);
    }
  }
}

/// Runs the cases, each printed when it is done. Those of an earlier run are taken from its file; after
/// Ctrl-C the rest is left out.
std::vector<Outcome> solve_all(const std::vector<Specification>& cases, const Settings& s) {
  const auto before = read_results(s.output);
  std::ofstream log;
  if (!s.output.empty()) {
    log.open(s.output, std::ios::app);
    if (!log) throw InputError(fmt::format("{}: cannot be written", s.output));
  }
  std::vector<std::optional<Outcome>> outcomes(cases.size());
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex printing;
  const bodesmith::Stopwatch watch;
  const auto solve_one = [&](std::size_t i) {
    const auto known = before.find(cases[i].key());
    if (known == before.end() && s.tables) return;
    std::string complaint;
    if (known != before.end()) {
      outcomes[i] = from_json(cases[i], known->second);
    } else {
      try {
        auto outcome = hidden::solve(hidden::make_case(cases[i]), s.solve);
        if (bodesmith::interrupted()) return;  // cut short: not a result
        outcomes[i] = std::move(outcome);
      } catch (const std::exception& e) {
        complaint = e.what();
      }
    }
    const std::lock_guard lock(printing);
    fmt::print("{}\n", outcomes[i] ? hidden::line_of(*outcomes[i])
                                   : fmt::format("ERR {}: {}", cases[i].key(), complaint));
    std::fflush(stdout);
    if (outcomes[i] && known == before.end() && log.is_open())
      log << to_json(*outcomes[i]).dump() << std::endl;
    fmt::print(stderr, "\r{} of {} cases, {:.0f} s ", ++done, cases.size(), watch.seconds());
  };
  const auto work = [&] {
    for (std::size_t i = next++; i < cases.size() && !bodesmith::interrupted(); i = next++) solve_one(i);
  };
  {
    std::vector<std::jthread> others;
    for (int k = 1; k < s.jobs; ++k) others.emplace_back(work);
    work();
  }
  fmt::print(stderr, "\n");
  std::vector<Outcome> all;
  for (auto& o : outcomes)
    if (o) all.push_back(std::move(*o));
  return all;
}

int run(const Settings& s) {
  std::vector<Specification> cases;
  bool spice = false;
  for (auto c : hidden::list_cases(s.cases)) {
    if (c.world != World::responses) c.rows = s.rows;
    if (!wanted(s, c)) continue;
    spice = spice || c.world == World::ngspice;
    cases.push_back(std::move(c));
  }
  if (cases.empty())
    throw InputError("no case is left, expected other --bases, --effects, --kinds or --only");
  if (s.list) {
    for (const auto& c : cases) fmt::print("{}\n", c.key());
    return 0;
  }
  if (spice && !bodesmith::ngspice::is_available())
    throw InputError(
        "--worlds ngspice: needs ngspice, which is not installed (Debian: apt-get install ngspice)");
  if (!s.records.empty()) {
    for (const auto& c : cases) {
      std::string name = c.key();
      std::replace(name.begin(), name.end(), ':', '_');
      write_records(hidden::make_case(c), fs::path(s.records) / name);
    }
    return 0;
  }
  bodesmith::catch_interrupts();
  const auto outcomes = solve_all(cases, s);
  if (!outcomes.empty()) fmt::print("\n{}", hidden::confusion_tables(outcomes));
  return outcomes.size() < cases.size() && !s.tables ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::string help;
    const Settings settings = read_settings(argc, argv, help);
    if (!help.empty()) {
      std::cout << help;
      return 0;
    }
    return run(settings);
  } catch (const InputError& e) {
    fmt::print(stderr, "gap_batch: {}\n", e.what());
    return 2;
  }
}
