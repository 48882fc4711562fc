#include "project/project.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "approximate/method.hpp"
#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/device/board.hpp"
#include "numeric/quadratic_roots.hpp"
#include "project/track_file.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/parts/series.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::project {
namespace fs = std::filesystem;

namespace {

/// A file that the project names, which must exist: the error names the project's line.
fs::path file_at(const Node& table, std::string_view key, const fs::path& folder) {
  const Node node = table.at(key);
  const fs::path path = folder / node.string();
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored))
    node.fail(fmt::format("names {}, which does not exist", path.string()));
  return path;
}

/// The name at `key`, or `otherwise`. `check` throws for one that is not known: then the error names the project's line.
template <class Check>
std::string known_name(const Node& table, std::string_view key, const std::string& otherwise,
                       const Check& check) {
  if (!table.has(key)) return otherwise;
  const Node node = table.at(key);
  try {
    check(node.string());
  } catch (const InputError& error) {
    if (!error.file().empty()) throw;
    node.fail(fmt::format("cannot be taken: {}", error.what()));
  }
  return node.string();
}

ApproximationOptions read_approximate(const Node& node) {
  node.allow_only({"method", "order", "max_error_db"});
  ApproximationOptions out;
  out.method =
      known_name(node, "method", out.method, [](const std::string& name) { method_registry().get(name); });
  if (node.has("order")) out.order = static_cast<int>(node.at("order").integer(1, 12));
  if (node.has("max_error_db")) out.max_error_db = node.at("max_error_db").positive();
  if (out.order && out.max_error_db) node.fail("has both order and max_error_db, expected one of them");
  return out;
}

fpaa::PlanOptions read_fpaa(const Node& node) {
  node.allow_only({"board", "clock_hz"});
  fpaa::PlanOptions out;
  out.board = known_name(node, "board", out.board,
                         [](const std::string& name) { value_or_throw(fpaa::find_board(name)); });
  if (node.has("clock_hz")) out.clock = Hertz{node.at("clock_hz").positive()};
  return out;
}

Project::Circuit read_circuit(const Node& node) {
  node.allow_only({"realization", "resistors", "capacitors"});
  Project::Circuit circuit;
  const auto series = [](const std::string& name) { synthesis::Series::named(name); };
  circuit.realisation = known_name(node, "realization", circuit.realisation, [](const std::string& name) {
    synthesis::realisation_registry().get(name);
  });
  circuit.resistors = known_name(node, "resistors", circuit.resistors, series);
  circuit.capacitors = known_name(node, "capacitors", circuit.capacitors, series);
  return circuit;
}

Project::Limits read_limits(const Node& node, bool stage) {
  if (stage && node.has("yield_db"))
    node.at("yield_db")
        .fail("is for projects without a disturbance; here controller/trim.md has the effect of the parts");
  for (const char* key : {"tracking_percent", "agreement_percent"}) {
    if (!stage && node.has(key)) node.at(key).fail("is for projects with a disturbance, which track");
  }
  node.allow_only({"fit_db", "points_db", "approximation_db", "fpaa_percent", "circuit_db",
                   "tracking_percent", "agreement_percent", "yield_db"});
  const auto limit = [&node](std::string_view key) -> std::optional<double> {
    if (!node.has(key)) return std::nullopt;
    return node.at(key).positive();
  };
  return {limit("fit_db"),     limit("points_db"),        limit("approximation_db"),  limit("fpaa_percent"),
          limit("circuit_db"), limit("tracking_percent"), limit("agreement_percent"), limit("yield_db")};
}

/// Roots of s^2 + c1 s + c0.
std::vector<Complex> quadratic_roots(const Node& node) {
  const std::vector<double> c = node.numbers();
  if (c.size() != 2) node.fail(fmt::format("has {} numbers, expected [c1, c0] of s^2 + c1 s + c0", c.size()));
  if (!(c[0] > 0.0) || !(c[1] > 0.0))
    node.fail("has roots in the right half plane, expected c1 and c0 above 0");
  if (!std::isfinite(c[0] * c[0]))
    node.fail("has roots beyond what can be computed, expected c1 below 1e154");
  return bodesmith::quadratic_roots(c[1], c[0], 1.0);
}

/// Of a stage: the gains of its disturbance over frequency.
Project::Target read_stage_target(const Node& node, const fs::path& folder, Provenance& from) {
  node.allow_only({"points", "disturbance", "branch", "base_hz"});
  Project::Target target;
  target.points = BodePoints::read_csv(file_at(node, "points", folder), from);
  target.disturbance = Disturbance::read(file_at(node, "disturbance", folder), from);
  if (node.has("branch") && node.at("branch").one_of({"ascending", "descending"}) == "ascending") {
    target.branch = Disturbance::Branch::ascending;
  }
  target.base =
      node.has("base_hz") ? Hertz{node.at("base_hz").positive()} : target.points.points.front().frequency;
  return target;
}

/// One of points, sections, fractional.
Project::Target read_response_target(const Node& node, const fs::path& folder, Provenance& from) {
  node.allow_only({"points", "sections", "fractional", "from_hz", "to_hz"});
  const bool band = node.has("from_hz") && node.has("to_hz");
  if (node.has("from_hz") != node.has("to_hz"))
    node.fail("has one end of a band, expected from_hz and to_hz");
  if (node.has("points") + node.has("sections") + node.has("fractional") != 1)
    node.fail("expected one of points, sections and fractional, or points with a disturbance");
  const char* key = node.has("points") ? "points" : node.has("sections") ? "sections" : "fractional";
  const fs::path file = file_at(node, key, folder);
  Project::Target target;
  target.file = node.at(key).string();
  if (node.has("points")) {
    target.points = BodePoints::read_csv(file, from);
    target.base = target.points.points.front().frequency;
    target.band = {target.base, target.points.points.back().frequency};
  } else if (node.has("sections")) {
    target.sections = Sections::read(file, from);
    target.band = synthesis::judged_band(*target.sections);
  } else {
    target.fractional = FractionalTransfer::read(file, from);
    if (!band) node.at(key).fail("needs from_hz and to_hz, the band it is approximated over");
  }
  if (band) {
    target.band = {Hertz{node.at("from_hz").positive()}, Hertz{node.at("to_hz").positive()}};
    if (!(target.band.from < target.band.to)) node.at("to_hz").fail("is not above from_hz");
  }
  return target;
}

using Method = Project::Fit::Method;

void read_fit(const Node& node, bool stage, Project& out) {
  Project::Fit& fit = out.fit;
  if (stage) {
    node.allow_only({"method", "beta_max", "beta_positive"});
    if (node.has("method")) fit.method = one_of(node.at("method"), Method::interpolate, Method::bounded);
  } else {
    node.allow_only({"method", "max_error_db", "order", "beta_max", "real", "relative_degree",
                     "max_corner_hz", "base_hz"});
    if (node.has("method"))
      fit.method =
          one_of(node.at("method"), Method::automatic, Method::interpolate, Method::bounded, Method::direct);
  }
  fit.beta_max = node.has("beta_max") ? node.at("beta_max").positive() : stage ? 2.0 : 5.0;
  fit.beta_positive = node.boolean_or("beta_positive", false);
  if (fit.beta_positive && fit.method != Method::bounded)
    node.at("beta_positive").fail("needs method = \"bounded\"");
  if (node.has("max_error_db")) fit.max_error_db = node.at("max_error_db").positive();
  if (node.has("order")) fit.order = static_cast<int>(node.at("order").integer(1, 12));
  fit.direct.real = node.boolean_or("real", false);
  if (node.has("relative_degree"))
    fit.direct.relative_degree =
        static_cast<int>(node.at("relative_degree").integer(0, fit.order.value_or(12)));
  if (node.has("max_corner_hz")) fit.direct.max_corner = Hertz{node.at("max_corner_hz").positive()};
  if (node.has("base_hz")) out.target.base = Hertz{node.at("base_hz").positive()};
}

Project::Plant read_plant(const Node& node) {
  node.allow_only({"stroke_m", "amplifier_corner_hz", "resonance_hz", "damping_ratio", "damping_compensator",
                   "drive_range"});
  Project::Plant plant;
  plant.stroke_m = node.at("stroke_m").positive();
  if (node.has("amplifier_corner_hz"))
    plant.amplifier_corner = Hertz{node.at("amplifier_corner_hz").positive()};
  if (node.has("resonance_hz")) {
    plant.resonance = Hertz{node.at("resonance_hz").positive()};
    plant.damping_ratio = node.at("damping_ratio").positive();
  }
  if (node.has("damping_compensator")) {
    const Node damping = node.at("damping_compensator");
    damping.allow_only({"gain", "zeros", "poles"});
    Section section;
    section.gain = damping.at("gain").positive();
    section.zeros = quadratic_roots(damping.at("zeros"));
    section.poles = quadratic_roots(damping.at("poles"));
    plant.damping_compensator = section;
  }
  if (node.has("drive_range")) {
    const std::vector<double> range = node.at("drive_range").numbers();
    if (range.size() != 2 || !(range[0] < range[1]))
      node.at("drive_range").fail("is no range, expected [lowest, highest] drive in full strokes");
    plant.drive_range = {range[0], range[1]};
  }
  return plant;
}

Project::Choice read_choice(const Node& node) {
  using Choice = Project::Choice;
  node.allow_only({"by"});
  return one_of(node.at("by"), Choice::tracking, Choice::as_asked, Choice::fewest_sections, Choice::waveform);
}

Project::Controller read_controller(const Node& node) {
  node.allow_only({"form", "errors", "allow_unstable"});
  Project::Controller out;
  if (node.has("errors")) out.errors = generator::PartErrors::from_node(node.at("errors"));
  if (node.has("allow_unstable")) out.allow_unstable = node.at("allow_unstable").boolean();
  if (node.has("form")) out.form = node.at("form").one_of({"self-fed", "two-pass", "seed"});
  return out;
}

void read_hardware(const Node& node, bool stage, Project& out) {
  if (stage) {
    node.allow_only({"fpaa", "circuit", "controller"});
  } else {
    node.allow_only({"fpaa", "circuit"});
  }
  if (node.has("fpaa")) out.fpaa = read_fpaa(node.at("fpaa"));
  if (node.has("circuit")) out.circuit = read_circuit(node.at("circuit"));
  if (!node.has("controller")) return;
  out.controller = read_controller(node.at("controller"));
  if (!out.circuit) node.at("controller").fail("needs [hardware.circuit], whose parts it is made of");
}

}  // namespace

std::string_view to_string(Project::Choice choice) {
  constexpr std::array kWords = {"tracking", "as_asked", "fewest_sections", "waveform"};
  return kWords.at(static_cast<std::size_t>(choice));
}

std::string_view to_string(Project::Fit::Method method) {
  constexpr std::array kWords = {"automatic", "interpolate", "bounded", "direct"};
  return kWords.at(static_cast<std::size_t>(method));
}

ProjectSource ProjectSource::read(const fs::path& file) {
  Provenance from;
  const Node document = read_document(file, from);
  document.expect_schema("project");
  return {file, document, std::move(from), {}};
}

Project ProjectSource::project(Provenance& names) const {
  const Node& node = document;
  const fs::path folder = file.parent_path();
  const bool stage = node.has("track") || node.has("plant") ||
                     (node.has("target") && node.at("target").kind() == Node::Kind::object &&
                      node.at("target").has("disturbance"));
  if (stage) {
    node.allow_only(
        {"schema", "name", "target", "fit", "approximate", "choose", "hardware", "plant", "track", "limits"});
  } else {
    node.allow_only({"schema", "name", "target", "fit", "approximate", "hardware", "tolerances", "limits"});
  }
  Project out;
  out.name = node.string_or("name", file.stem().string());
  out.deadline = deadline;
  out.target = (stage ? read_stage_target : read_response_target)(node.at("target"), folder, names);
  if (node.has("fit")) read_fit(node.at("fit"), stage, out);
  if (node.has("approximate")) out.approximate = read_approximate(node.at("approximate"));
  // What will be tracked decides, unless [choose] says otherwise.
  if (node.has("choose")) out.choice = read_choice(node.at("choose"));
  if (node.has("hardware")) read_hardware(node.at("hardware"), stage, out);
  if (node.has("tolerances"))
    static_cast<schematic::Tolerances&>(out.spread) = synthesis::tolerances_from(node.at("tolerances"));
  if (stage) {
    out.plant = read_plant(node.at("plant"));
    out.track = read_track(node.at("track"));
    check_drive(out, node);
    if (out.choice == Project::Choice::tracking) check_loop(out, node, folder);
  }
  if (node.has("limits")) out.limits = read_limits(node.at("limits"), stage);
  return out;
}

}  // namespace bodesmith::project
