#include "project/project.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "approximate/method.hpp"
#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "fpaa/device/board.hpp"
#include "project/tables.hpp"
#include "project/track_file.hpp"
#include "synthesis/parts/series.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::project {
namespace fs = std::filesystem;

/// A file that the project names, which must exist: the error names the project's line.
fs::path file_at(const Node& table, std::string_view key, const fs::path& folder) {
  const Node node = table.at(key);
  const fs::path path = folder / node.string();
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored))
    node.fail(fmt::format("names {}, which does not exist", path.string()));
  return path;
}

namespace {

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

}  // namespace

Project::Approximate read_approximate(const Node& node) {
  node.allow_only({"method", "order", "max_error_db"});
  Project::Approximate out;
  out.method =
      known_name(node, "method", out.method, [](const std::string& name) { method_registry().get(name); });
  if (node.has("order")) out.order = static_cast<int>(node.at("order").integer(1, 12));
  if (node.has("max_error_db")) out.max_error_db = node.at("max_error_db").positive();
  if (out.order && out.max_error_db) node.fail("has both order and max_error_db, expected one of them");
  return out;
}

Project::Fpaa read_fpaa(const Node& node) {
  node.allow_only({"board", "clock_hz"});
  Project::Fpaa fpaa;
  fpaa.board = known_name(node, "board", fpaa.board,
                          [](const std::string& name) { value_or_throw(fpaa::find_board(name)); });
  if (node.has("clock_hz")) fpaa.clock = Hertz{node.at("clock_hz").positive()};
  return fpaa;
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

Project::Limits read_limits(const Node& node, bool tolerances) {
  if (!tolerances && node.has("yield_db"))
    node.at("yield_db")
        .fail("is for projects without a disturbance; here controller/trim.md says what parts do");
  for (const char* key : {"tracking_percent", "agreement_percent"}) {
    if (tolerances && node.has(key)) node.at(key).fail("is for projects with a disturbance, which track");
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

namespace {

/// Roots of s^2 + c1 s + c0.
std::vector<std::complex<double>> quadratic_roots(const Node& node) {
  const std::vector<double> c = node.numbers();
  if (c.size() != 2) node.fail(fmt::format("has {} numbers, expected [c1, c0] of s^2 + c1 s + c0", c.size()));
  if (!(c[0] > 0.0) || !(c[1] > 0.0))
    node.fail("has roots in the right half plane, expected c1 and c0 above 0");
  if (!std::isfinite(c[0] * c[0]))
    node.fail("has roots beyond what can be computed, expected c1 below 1e154");
  const std::complex<double> root = std::sqrt(std::complex<double>(c[0] * c[0] / 4.0 - c[1], 0.0));
  if (root.imag() != 0.0) return {{-c[0] / 2.0, root.imag()}, {-c[0] / 2.0, -root.imag()}};
  // The root farther out first, the other from the product: no cancellation.
  const double far = -(c[0] / 2.0 + root.real());
  return {{far, 0.0}, {c[1] / far, 0.0}};
}

Project::Target read_target(const Node& node, const fs::path& folder, Provenance& from) {
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

Project::Fit read_fit(const Node& node) {
  node.allow_only({"method", "beta_max", "beta_positive"});
  Project::Fit fit;
  fit.bounded = node.has("method") && node.at("method").one_of({"interpolate", "bounded"}) == "bounded";
  if (node.has("beta_max")) fit.beta_max = node.at("beta_max").positive();
  fit.beta_positive = node.boolean_or("beta_positive", false);
  if (fit.beta_positive && !fit.bounded) node.at("beta_positive").fail("needs method = \"bounded\"");
  return fit;
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
  if (node.has("errors")) out.errors = tolerance::PartErrors::from_node(node.at("errors"));
  if (node.has("allow_unstable")) out.allow_unstable = node.at("allow_unstable").boolean();
  if (node.has("form")) out.form = node.at("form").one_of({"self-fed", "two-pass", "seed"});
  return out;
}

}  // namespace

std::string_view to_string(Project::Choice choice) {
  constexpr std::array kWords = {"tracking", "as_asked", "fewest_sections", "waveform"};
  return kWords.at(static_cast<std::size_t>(choice));
}

Project Project::read(const fs::path& path, Provenance& from) {
  return from_document(read_document(path, from), path, from);
}

Project Project::from_document(const Node& node, const fs::path& path, Provenance& from) {
  node.expect_schema("project");
  node.allow_only(
      {"schema", "name", "target", "fit", "approximate", "choose", "hardware", "plant", "track", "limits"});
  Project project;
  project.name = node.string_or("name", path.stem().string());
  project.target = read_target(node.at("target"), path.parent_path(), from);
  if (node.has("fit")) project.fit = read_fit(node.at("fit"));
  // What will be tracked decides, unless [choose] says otherwise.
  if (node.has("approximate")) project.approximate = read_approximate(node.at("approximate"));
  if (node.has("choose")) project.choice = read_choice(node.at("choose"));
  if (node.has("hardware")) {
    const Node hardware = node.at("hardware");
    hardware.allow_only({"fpaa", "circuit", "controller"});
    if (hardware.has("fpaa")) project.fpaa = read_fpaa(hardware.at("fpaa"));
    if (hardware.has("circuit")) project.circuit = read_circuit(hardware.at("circuit"));
    if (hardware.has("controller")) {
      project.controller = read_controller(hardware.at("controller"));
      if (!project.circuit)
        hardware.at("controller").fail("needs [hardware.circuit], whose parts it is made of");
    }
  }
  project.plant = read_plant(node.at("plant"));
  project.track = read_track(node.at("track"));
  check_drive(project, node);
  if (project.choice == Choice::tracking) check_loop(project, node, path.parent_path());
  if (node.has("limits")) project.limits = read_limits(node.at("limits"), false);
  return project;
}

}  // namespace bodesmith::project
