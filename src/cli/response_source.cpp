#include "cli/response_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "chain/model_file.hpp"
#include "cli/shared_options.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "lti/cascade.hpp"
#include "lti/fractional_transfer.hpp"
#include "lti/judge_responses.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/ngspice/plain_netlist.hpp"
#include "schematic/writers/spice_library.hpp"
#include "signal/bode_points.hpp"
#include "signal/csv.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::cli {
namespace {

using Evaluate = std::function<std::vector<Complex>(const std::vector<Hertz>&)>;

/// A magnitude of 0 or a pole on the axis has no dB; what is no number at all was beyond double precision.
LevelAndPhase require_numbers(LevelAndPhase curves, const std::string& stem, const std::vector<Hertz>& grid) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (std::isnan(curves.magnitude_db[i]))
      throw InputError(fmt::format("{}: has no response at {} Hz that double precision can hold", stem,
                                   rounded_text(grid[i].value)));
  }
  return curves;
}

/// The curves at these frequencies, the phase unwrapped over as many between them as it takes: some 50 to a decade, and halvings
/// wherever it still turns by more than a sixth of a turn at once.
LevelAndPhase curves_of(const Evaluate& evaluate, const std::vector<Hertz>& grid) {
  constexpr double kLargestStep = 0.046;  // of ln f
  constexpr int kHalvings = 12;
  struct Known {
    Complex value;
    std::size_t place = 0;
  };
  std::map<double, Known> all;
  std::vector<Hertz> fresh = grid;
  for (std::size_t i = 1; i < grid.size(); ++i) {
    const double apart = std::log(grid[i].value / grid[i - 1].value);
    const int pieces = whole_number(std::ceil(apart / kLargestStep), 1);
    for (int k = 1; k < pieces; ++k) fresh.push_back({grid[i - 1].value * std::exp(apart * k / pieces)});
  }
  for (int round = 0; round <= kHalvings && !fresh.empty(); ++round) {
    const auto values = evaluate(fresh);
    for (std::size_t i = 0; i < fresh.size(); ++i) all[fresh[i].value].value = values[i];
    fresh.clear();
    for (auto a = all.begin(), b = std::next(a); b != all.end(); a = b++) {
      if (std::abs(std::arg(b->second.value / a->second.value)) > std::numbers::pi / 3.0)
        fresh.push_back({std::sqrt(a->first * b->first)});
    }
  }
  std::vector<Complex> values;
  for (auto& [f, known] : all) {
    known.place = values.size();
    values.push_back(known.value);
  }
  const LevelAndPhase curves = level_and_phase(values);
  LevelAndPhase out;
  for (const Hertz f : grid) {
    const std::size_t place = all.at(f.value).place;
    out.magnitude_db.push_back(curves.magnitude_db[place]);
    out.phase_deg.push_back(curves.phase_deg[place]);
  }
  return out;
}

void set_evaluation(ResponseSource& source, Evaluate evaluate) {
  source.on_grid = [evaluate, stem = source.stem](const std::vector<Hertz>& grid) {
    return require_numbers(curves_of(evaluate, grid), stem, grid);
  };
  source.response = std::move(evaluate);
}

Sections without_delay(Sections sections) {
  sections.delay_s = 0.0;
  return sections;
}

void set_sections(ResponseSource& source, const Sections& sections) {
  source.sections = sections;
  set_evaluation(source, [sections](const std::vector<Hertz>& grid) { return responses(sections, grid); });
  // However far the points of a grid are apart: the delay turns the phase by many turns between them.
  source.on_grid = [rational = without_delay(sections), delay_s = sections.delay_s,
                    stem = source.stem](const std::vector<Hertz>& grid) {
    LevelAndPhase curves = require_numbers(level_and_phase(rational, grid), stem, grid);
    for (std::size_t i = 0; i < grid.size(); ++i) curves.phase_deg[i] -= 360.0 * grid[i].value * delay_s;
    return curves;
  };
}

/// Linear in log frequency; NaN outside the rows.
double interpolate(const std::vector<double>& log_f, const std::vector<double>& value, double at) {
  const double slack = 1e-9;
  if (at < log_f.front() - slack || at > log_f.back() + slack) return NAN;
  const auto above = std::upper_bound(log_f.begin(), log_f.end(), at);
  if (above == log_f.begin()) return value.front();
  if (above == log_f.end()) return value.back();
  const auto i = static_cast<size_t>(above - log_f.begin());
  const double t = (at - log_f[i - 1]) / (log_f[i] - log_f[i - 1]);
  return value[i - 1] + t * (value[i] - value[i - 1]);
}

void load_measured(const std::filesystem::path& path, Provenance& from, ResponseSource& source) {
  const BodePoints points = BodePoints::read_csv(path, from);
  std::vector<double> log_f;
  std::vector<double> magnitude;
  std::vector<double> phase;
  for (const BodePoint& point : points.points) {
    source.own_frequencies.push_back(point.frequency);
    log_f.push_back(std::log(point.frequency.value));
    magnitude.push_back(to_decibel(point.gain));
    if (point.phase_deg) phase.push_back(*point.phase_deg);
  }
  source.band = Band{points.points.front().frequency, points.points.back().frequency};
  source.on_grid = [log_f, magnitude, phase](const std::vector<Hertz>& grid) {
    LevelAndPhase columns;
    for (const Hertz f : grid) {
      columns.magnitude_db.push_back(interpolate(log_f, magnitude, std::log(f.value)));
      if (!phase.empty()) columns.phase_deg.push_back(interpolate(log_f, phase, std::log(f.value)));
    }
    return columns;
  };
}

std::optional<Band> usable(const Band& band) {
  if (band.from.value > 0.0 && band.to >= band.from && std::isfinite(band.to.value)) return band;
  return std::nullopt;
}

void load_model(const Node& node, ResponseSource& source) {
  const chain::Chain chain = chain::model_from_node(node);
  const Node blocks = node.at("block");
  for (size_t i = 0; i < chain.blocks.size(); ++i) {
    if (!chain.blocks[i].response(RadPerSecond{1.0})) {
      blocks[i].fail(
          fmt::format("({}) has no frequency response: it is not linear", chain.blocks[i].type_name()));
    }
  }
  set_evaluation(source, at_each([chain](RadPerSecond w) { return *chain.response(w); }));
}

/// This program's own documents; everything else is measured or simulated.
bool is_document(const std::filesystem::path& path) {
  if (path.extension() == ".json" || path.extension() == ".toml") return true;
  std::error_code ignored;
  if (std::filesystem::is_fifo(path, ignored)) return false;  // what is read of it is gone
  std::ifstream in(path, std::ios::binary);
  char first = 0;
  while (in.get(first)) {
    if (!is_blank(first)) return first == '{';
  }
  return false;
}

/// Of FILE:CHOICE both, the choice in letters and digits.
std::string stem_of(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const std::size_t colon = name.find(':');
  std::string stem = std::filesystem::path(name.substr(0, colon)).stem().string();
  std::error_code ignored;
  if (colon == std::string::npos || std::filesystem::exists(path, ignored)) return path.stem().string();
  for (const char c : name.substr(colon)) {
    if (is_letter_or_digit(c)) {
      stem += c;
    } else if (stem.back() != '_') {
      stem += '_';
    }
  }
  while (stem.back() == '_') stem.pop_back();
  return stem;
}

/// `subcircuit` (empty: the top) from its first pin to its second.
schematic::Netlist two_port_of(const std::string& text, const std::string& file,
                               const std::string& subcircuit = "") {
  const schematic::SpiceLibrary library = schematic::read_spice(text, file);
  return library.two_port(subcircuit.empty() ? library.top : subcircuit);
}

/// What this program can solve itself: a netlist of known elements that includes no file.
std::optional<schematic::Netlist> own_netlist(const std::string& text, const std::string& file,
                                              const std::string& subcircuit) {
  for (const std::string_view line : split(text, '\n')) {
    if (ngspice::include_line(line)) return std::nullopt;
  }
  try {
    return two_port_of(text, file, subcircuit);
  } catch (const InputError&) {
  }
  return std::nullopt;
}

}  // namespace

bool is_netlist(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  for (const char* known : {".sub", ".lib", ".cir", ".net", ".sp"}) {
    if (ending == known) return true;
  }
  return false;
}

schematic::Netlist read_netlist(const std::filesystem::path& path, Provenance& from) {
  return two_port_of(from.read(path), path.string());
}

bool is_own_document(const std::filesystem::path& path) {
  return !is_netlist(path) && is_document(path);
}

bool is_design(const std::filesystem::path& path) {
  return is_netlist(path) || is_document(path);
}

ResponseSource load_response(const std::filesystem::path& path, const ResponseOptions& options,
                             Provenance& from) {
  ResponseSource source;
  source.stem = stem_of(path);
  const std::string ending = path.extension().string();
  if (is_netlist(path)) {
    const std::string text = from.read(path);
    const bool is_library = ending == ".sub" || ending == ".lib";
    set_evaluation(source, [=, name = options.subcircuit](const std::vector<Hertz>& grid) {
      try {
        return is_library ? ngspice::run_ac_of_sub(path, grid, name) : ngspice::run_ac_of_deck(path, grid);
      } catch (const InputError&) {
        // There is no ngspice, or an op-amp is known here by its type alone.
        const auto own = own_netlist(text, path.string(), name);
        if (!own) throw;
        return schematic::network_response(*own, grid);
      }
    });
    return source;
  }
  if (!is_document(path)) {
    load_measured(path, from, source);
    return source;
  }
  const Node node = read_document(path, from);
  if (node.kind() != Node::Kind::object || !node.has("schema")) {
    throw InputError(path.string(), node.line(),
                     "has no \"schema\", expected a bodesmith file, a .sub or a .csv");
  }
  const std::string schema = node.at("schema").string();
  if (schema == "bodesmith.cascade/1") {
    const Cascade cascade = Cascade::from_node(node);
    source.band = usable(cascade.corner_band());
    set_evaluation(source, at_each([cascade](RadPerSecond w) { return cascade.response(w); }));
  } else if (schema == "bodesmith.sections/1" || schema == "bodesmith.controller/1") {
    const Sections sections = sections_of(node, path.parent_path(), from);
    source.band = usable(sections.corner_band());
    set_sections(source, sections);
  } else if (schema == "bodesmith.fpaa_plan/1") {
    const auto plan = std::make_shared<const fpaa::Plan>(fpaa::Plan::from_node(node));
    const auto board = std::make_shared<const fpaa::SwitchedBoard>(*plan);
    source.band = usable(plan->error.band);
    set_evaluation(source, at_each([plan, board, runs = options.as_it_runs](RadPerSecond w) {
                     return runs ? board->gain(w) : board->sampled(w);
                   }));
  } else if (schema == "bodesmith.circuit/1") {
    const synthesis::CircuitFile file = synthesis::CircuitFile::from_node(node);
    source.band = usable(file.band);
    set_evaluation(source, [built = file.circuit](const std::vector<Hertz>& grid) {
      return schematic::network_response(built, grid);
    });
  } else if (schema == "bodesmith.fractional/1") {
    const FractionalTransfer transfer = FractionalTransfer::from_node(node);
    set_evaluation(source, at_each([transfer](RadPerSecond w) { return transfer.response(w); }));
  } else if (schema == "bodesmith.model/1") {
    load_model(node, source);
  } else {
    node.at("schema").fail(
        fmt::format("is \"{}\", which has no frequency response; expected a cascade, sections, a "
                    "circuit, a controller, a fractional transfer, an FPAA plan or a model",
                    schema));
  }
  source.quick = true;
  return source;
}

}  // namespace bodesmith::cli
