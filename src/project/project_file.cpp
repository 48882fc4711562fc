#include "project/project_file.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/document.hpp"

namespace bodesmith::project {
namespace {
namespace fs = std::filesystem;

/// Roots of s^2 + c1 s + c0.
std::vector<std::complex<double>> quadratic_roots(const Node& node) {
  const std::vector<double> c = node.numbers();
  if (c.size() != 2) node.fail(fmt::format("has {} numbers, expected [c1, c0] of s^2 + c1 s + c0", c.size()));
  if (!(c[0] > 0.0) || !(c[1] > 0.0))
    node.fail("has roots in the right half plane, expected c1 and c0 above 0");
  const std::complex<double> root = std::sqrt(std::complex<double>(c[0] * c[0] / 4.0 - c[1], 0.0));
  if (root.imag() != 0.0) return {{-c[0] / 2.0, root.imag()}, {-c[0] / 2.0, -root.imag()}};
  // The root farther out first, the other from the product: no cancellation.
  const double far = -(c[0] / 2.0 + root.real());
  return {{far, 0.0}, {c[1] / far, 0.0}};
}

/// A path in the project, which must be readable: the complaint names the project's line.
fs::path file_at(const Node& table, std::string_view key, const fs::path& folder) {
  const Node node = table.at(key);
  const fs::path path = folder / node.string();
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored))
    node.fail(fmt::format("names {}, which is not there", path.string()));
  return path;
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

Project::Approximate read_approximate(const Node& node) {
  node.allow_only({"method", "order", "max_error_db"});
  Project::Approximate out;
  out.method = node.string_or("method", out.method);
  if (node.has("order")) out.order = static_cast<int>(node.at("order").integer(1, 12));
  if (node.has("max_error_db")) out.max_error_db = node.at("max_error_db").positive();
  if (out.order && out.max_error_db) node.fail("has both order and max_error_db, expected one of them");
  return out;
}

Project::Plant read_plant(const Node& node) {
  node.allow_only(
      {"stroke_m", "amplifier_corner_hz", "resonance_hz", "damping_ratio", "damping_compensator"});
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
  return plant;
}

Project::Track read_track(const Node& node) {
  node.allow_only({"waveform", "frequency_hz"});
  Project::Track track;
  track.sine = node.has("waveform") && node.at("waveform").one_of({"triangle", "sine"}) == "sine";
  for (const Node& item : node.at("frequency_hz").items()) track.frequency.push_back(Hertz{item.positive()});
  if (track.frequency.empty()) node.at("frequency_hz").fail("is empty, expected at least one frequency");
  return track;
}

std::optional<double> limit(const Node& node, std::string_view key) {
  if (!node.has(key)) return std::nullopt;
  return node.at(key).positive();
}

}  // namespace

Project Project::read(const fs::path& path, Provenance& from) {
  const Node node = read_document(path, from);
  node.expect_schema("project");
  node.allow_only(
      {"schema", "name", "target", "fit", "approximate", "choose", "hardware", "plant", "track", "limits"});
  const fs::path folder = path.parent_path();
  Project project;
  project.name = node.string_or("name", path.stem().string());
  project.target = read_target(node.at("target"), folder, from);
  if (node.has("fit")) project.fit = read_fit(node.at("fit"));
  if (node.has("approximate")) project.approximate = read_approximate(node.at("approximate"));
  // Who says nothing of how sections are made gets the fewest that do.
  if (!node.has("approximate")) project.choose = Choose::fewest_sections;
  if (node.has("choose")) {
    const Node choose = node.at("choose");
    choose.allow_only({"by"});
    const std::string by = choose.at("by").one_of({"as_asked", "fewest_sections", "waveform"});
    if (by == "fewest_sections") project.choose = Choose::fewest_sections;
    if (by == "waveform") project.choose = Choose::waveform;
  }
  if (node.has("hardware")) {
    const Node hardware = node.at("hardware");
    hardware.allow_only({"fpaa", "circuit"});
    if (hardware.has("fpaa")) {
      const Node fpaa = hardware.at("fpaa");
      fpaa.allow_only({"board", "clock_hz"});
      project.fpaa = Fpaa{};
      project.fpaa->board = fpaa.string_or("board", project.fpaa->board);
      if (fpaa.has("clock_hz")) project.fpaa->clock = Hertz{fpaa.at("clock_hz").positive()};
    }
    if (hardware.has("circuit")) {
      const Node circuit = hardware.at("circuit");
      circuit.allow_only({"realization", "resistors", "capacitors"});
      project.circuit = Circuit{};
      project.circuit->realization = circuit.string_or("realization", project.circuit->realization);
      project.circuit->resistors = circuit.string_or("resistors", project.circuit->resistors);
      project.circuit->capacitors = circuit.string_or("capacitors", project.circuit->capacitors);
    }
  }
  project.plant = read_plant(node.at("plant"));
  project.track = read_track(node.at("track"));
  if (node.has("limits")) {
    const Node limits = node.at("limits");
    limits.allow_only({"fit_db", "points_db", "approximation_db", "fpaa_percent", "circuit_db"});
    project.limits = {limit(limits, "fit_db"), limit(limits, "points_db"), limit(limits, "approximation_db"),
                      limit(limits, "fpaa_percent"), limit(limits, "circuit_db")};
  }
  return project;
}

}  // namespace bodesmith::project
