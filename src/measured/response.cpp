#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "faults/circuit_board.hpp"
#include "faults/plan_board.hpp"
#include "faults/report.hpp"
#include "measured/measured.hpp"
#include "signal/csv.hpp"
#include "signal/statistics.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/parts/series.hpp"

namespace bodesmith::measured {
namespace {
namespace fs = std::filesystem;

using faults::Board;
using faults::Diagnosis;
using schematic::Part;

std::vector<double> differences(const Eigen::VectorXcd& got, const Eigen::VectorXcd& wanted) {
  std::vector<double> out;
  for (Eigen::Index k = 0; k < got.size(); ++k) out.push_back(100.0 * std::abs(got(k) / wanted(k) - 1.0));
  return out;
}

double worst(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

/// The circuit with the values that a finding gives its parts.
synthesis::Circuit with_values(synthesis::Circuit out, const faults::Finding& finding) {
  for (std::size_t i = 0; i < finding.faults.size(); ++i) {
    const faults::FaultSize size = finding.faults[i]->size(finding.sizes[i]);
    if (!size.key.starts_with("value_")) continue;
    for (const std::size_t part : finding.faults[i]->replaces) out.parts[part].realised = size.value;
  }
  return out;
}

/// The part that rework solders across another, of a preferred value; written next to that one, in its group. (A library does not ask
/// which parts a stage counts as its own.)
synthesis::Circuit with_part_across(synthesis::Circuit out, const faults::Rework::Across& across) {
  Part more = out.parts[across.part];
  const bool resistor = more.kind == Part::Kind::resistor;
  more.wanted = across.value;
  more.series = resistor ? "E96" : "E12";
  more.realised = synthesis::Series::named(more.series).nearest(across.value);
  more.role = "across " + more.name;
  more.name = (resistor ? "Rx_" : "Cx_") + more.name;
  out.parts.insert(out.parts.begin() + static_cast<std::ptrdiff_t>(across.part) + 1, std::move(more));
  return out;
}

std::string library(const synthesis::Circuit& circuit, const std::string& title) {
  return schematic::spice_text(synthesis::compensator_library(circuit, title));
}

/// next/ of a circuit: as it was found, and mended by one more part or by exchanging what is wrong.
void add_next(const synthesis::Circuit& circuit, const Board& board, const Diagnosis& d, GapPicture& picture,
              Measured& out, OutputSet& next) {
  const auto rivals = std::span(d.suspects).first(d.tied);
  next.add("as_built.sub", library(with_values(circuit, rivals.front().best), "what was built, as measured"));
  out.next_name = "response_percent";
  picture.before = faults::differences_percent(board, board.good_response());
  out.before_percent = worst(picture.before);
  picture.after.assign(picture.before.size(), 0.0);
  synthesis::Circuit mended = circuit;
  const auto across =
      std::find_if(d.rework.begin(), d.rework.end(), [](const auto& r) { return r.across.has_value(); });
  if (across != d.rework.end()) {
    mended = with_part_across(circuit, *across->across);
    const Part& more = mended.parts[across->across->part + 1];
    const double factor = more.realised / circuit.parts[across->across->part].realised;
    const faults::Effect change = board.in_parallel(across->across->part, factor);
    for (const faults::Suspect& rival : rivals) {
      const auto left =
          differences(board.response(joined(rival.best.effect(), change)), board.good_response());
      if (worst(left) > worst(picture.after)) picture.after = left;
    }
    out.next.push_back(fmt::format("{} across {}",
                                   engineering_text(more.realised, more.name[0] == 'R' ? "Ω" : "F"),
                                   circuit.parts[across->across->part].name));
  } else if (!d.rework.empty()) {
    out.next.push_back(d.rework.front().text);
  }
  out.after_percent = worst(picture.after);
  next.add("compensator.sub", library(mended, "what was built, mended"));
  out.next.push_back(
      fmt::format("response {} -> {} % from the design at worst, predicted: next/compensator.sub",
                  rounded_text(out.before_percent, 3), rounded_text(out.after_percent, 2)));
}

}  // namespace

Measured measured_response(const fs::path& data, const fs::path& folder, const gap::SearchOptions& options,
                           OutputSet& measured, OutputSet& next) {
  Measured out;
  faults::Spread spread;
  faults::Measurement channels;
  channels.channels.push_back(faults::read_channel(data, "out", out.from));
  std::optional<synthesis::Circuit> circuit;
  std::unique_ptr<Board> made;
  Diagnosis found;
  const fs::path of_circuit = folder / "spice/circuit.json", of_board = folder / "fpaa/plan.json";
  fs::path design;
  faults::DiagnosisOptions asked;
  asked.stop = [&options] { return options.stopped(); };
  const auto noise_percent = [&found] { return 100.0 * std::hypot(found.noise.gain, found.noise.phase); };
  // Of circuit and board the one that makes the measurement more probable.
  const auto consider = [&](std::unique_ptr<Board> one, const fs::path& file, const char* name) {
    Diagnosis d = faults::diagnose_board(*one, asked);
    if (made && !(d.log_evidence > found.log_evidence)) return;
    made = std::move(one);
    found = std::move(d);
    design = file;
    out.of = name;
  };
  if (fs::exists(of_circuit)) {
    circuit = synthesis::CircuitFile::from_node(read_document(of_circuit, out.from)).circuit;
    spread = faults::Spread(circuit->tolerances);
    consider(std::make_unique<faults::CircuitBoard>(*circuit, channels, spread), of_circuit, "the circuit");
  }
  if (fs::exists(of_board)) {
    const fpaa::Plan plan = fpaa::Plan::read(of_board, out.from);
    spread.mismatch = plan.mismatch;
    consider(std::make_unique<faults::PlanBoard>(plan, channels, spread), of_board, "the board");
  }
  if (!made) {
    throw InputError(data.string(), 0,
                     "is a frequency response, and " + folder.string() +
                         " has neither a circuit nor a board, expected a time record");
  }
  if (design == of_board) circuit.reset();
  const Board& board = *made;
  out.verdict = faults::to_string(found.verdict);
  const bool named = found.verdict == faults::Verdict::one_fault ||
                     found.verdict == faults::Verdict::two_faults || found.verdict == faults::Verdict::tie;
  for (std::size_t i = 0; named && i < found.tied; ++i) {
    const faults::Finding& one = found.suspects[i].best;
    for (std::size_t k = 0; k < one.faults.size(); ++k)
      out.found.push_back((i == 0 ? "" : "or ") + one.faults[k]->words(one.sizes[k]) +
                          fmt::format(" (probability {})", rounded_text(found.suspects[i].probability, 2)));
    if (found.tied > 1) out.tied.push_back(found.suspects[i].site);
  }
  for (const std::string& step : faults::next_steps(found)) {
    if (!step.starts_with("rework"))
      out.advice += (out.advice.empty() ? "" : "; ") + step;  // those are `next`
  }
  const Eigen::VectorXcd good = board.good_response();
  const Eigen::VectorXcd best =
      found.suspects.empty() || !named ? good : board.response(found.suspects.front().best.effect());
  GapPicture picture{"frequency, Hz",
                     true,
                     {},
                     faults::differences_percent(board, good),
                     faults::differences_percent(board, best),
                     {},
                     {},
                     "Response from the design, %"};
  out.gap_percent = rms(picture.gap);
  out.left_percent = rms(picture.left);
  out.noise_percent = noise_percent();
  const faults::Channel& channel = board.measured().channels.front();
  std::vector<double> wanted_db, measured_db;
  for (std::size_t k = 0; k < channel.grid.size(); ++k) {
    picture.x.push_back(channel.grid[k].value);
    measured_db.push_back(channel.log_gain[k] * kDecibelPerNeper);
    wanted_db.push_back(to_decibel(std::abs(good(static_cast<Eigen::Index>(k)))));
  }
  CsvWriter table;
  table.add("frequency_hz", picture.x);
  table.add("measured_db", measured_db);
  table.add("predicted_db", wanted_db);
  table.add("difference_percent", picture.gap);
  table.add("with_what_was_found_percent", picture.left);
  measured.add("comparison.csv", table.text());
  Json json = json_header("faults", out.from);
  json.update(faults::to_json(found, board, spread, asked.priors));
  measured.add("faults.json", to_text(json));
  measured.add("report.html", faults::report_page(found, board, design.string()));
  if (!named) return out;
  if (circuit) {
    add_next(*circuit, board, found, picture, out, next);
  } else {
    for (const faults::Rework& one : found.rework) out.next.push_back(one.text);
  }
  next.add("gap.svg", picture.svg());
  return out;
}

}  // namespace bodesmith::measured
