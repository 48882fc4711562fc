#include "project/filter_project.hpp"

#include <array>

#include <fmt/format.h>

#include "base/text.hpp"
#include "project/tables.hpp"
#include "synthesis/circuit.hpp"

namespace bodesmith::project {
namespace {
namespace fs = std::filesystem;

using FilterFit = FilterProject::Fit;

FilterFit read_filter_fit(const Node& node) {
  node.allow_only(
      {"method", "max_error_db", "order", "beta_max", "real", "relative_degree", "max_corner_hz", "base_hz"});
  FilterFit out;
  if (node.has("method"))
    out.method = one_of(node.at("method"), FilterFit::Method::automatic, FilterFit::Method::interpolate,
                        FilterFit::Method::bounded, FilterFit::Method::direct);
  if (node.has("max_error_db")) out.max_error_db = node.at("max_error_db").positive();
  if (node.has("order")) out.order = static_cast<int>(node.at("order").integer(1, 12));
  if (node.has("beta_max")) out.beta_max = node.at("beta_max").positive();
  out.real = node.boolean_or("real", false);
  if (node.has("relative_degree"))
    out.relative_degree = static_cast<int>(node.at("relative_degree").integer(0, out.order.value_or(12)));
  if (node.has("max_corner_hz")) out.max_corner = Hertz{node.at("max_corner_hz").positive()};
  if (node.has("base_hz")) out.base = Hertz{node.at("base_hz").positive()};
  return out;
}

/// One of points, sections, fractional.
void read_filter_target(const Node& node, const fs::path& folder, Provenance& from, FilterProject& out) {
  node.allow_only({"points", "sections", "fractional", "from_hz", "to_hz"});
  const bool band = node.has("from_hz") && node.has("to_hz");
  if (node.has("from_hz") != node.has("to_hz"))
    node.fail("has one end of a band, expected from_hz and to_hz");
  if (node.has("points") + node.has("sections") + node.has("fractional") != 1)
    node.fail("expected one of points, sections and fractional, or points with a disturbance");
  if (node.has("points")) {
    out.points = BodePoints::read_csv(file_at(node, "points", folder), from);
    out.target_file = node.at("points").string();
    out.band = {out.points->points.front().frequency, out.points->points.back().frequency};
  } else if (node.has("sections")) {
    out.sections = Sections::read(file_at(node, "sections", folder), from);
    out.target_file = node.at("sections").string();
    out.band = synthesis::judged_band(*out.sections);
  } else {
    out.fractional = FractionalTransfer::read(file_at(node, "fractional", folder), from);
    out.target_file = node.at("fractional").string();
    if (!band) node.at("fractional").fail("needs from_hz and to_hz, the band it is approximated over");
  }
  if (band) {
    out.band = {Hertz{node.at("from_hz").positive()}, Hertz{node.at("to_hz").positive()}};
    if (!(out.band.from < out.band.to)) node.at("to_hz").fail("is not above from_hz");
  }
}

double tolerance_percent(const Node& node) {
  const double out = node.positive();
  if (!(out < 100.0)) node.fail(fmt::format("is {}, expected less than 100", rounded_text(out)));
  return out;
}

tolerance::Spread read_spread(const Node& node) {
  node.allow_only({"resistor_percent", "capacitor_percent"});
  tolerance::Spread out;
  if (node.has("resistor_percent")) out.resistor_percent = tolerance_percent(node.at("resistor_percent"));
  if (node.has("capacitor_percent")) out.capacitor_percent = tolerance_percent(node.at("capacitor_percent"));
  return out;
}

}  // namespace

std::string_view to_string(FilterProject::Fit::Method method) {
  constexpr std::array kWords = {"automatic", "interpolate", "bounded", "direct"};
  return kWords.at(static_cast<std::size_t>(method));
}

FilterProject FilterProject::from_document(const Node& node, const fs::path& path, Provenance& from) {
  node.expect_schema("project");
  node.allow_only({"schema", "name", "target", "fit", "approximate", "hardware", "tolerances", "limits"});
  FilterProject out;
  out.name = node.string_or("name", path.stem().string());
  read_filter_target(node.at("target"), path.parent_path(), from, out);
  if (node.has("fit")) out.fit = read_filter_fit(node.at("fit"));
  if (node.has("approximate")) out.approximate = read_approximate(node.at("approximate"));
  if (node.has("hardware")) {
    const Node hardware = node.at("hardware");
    hardware.allow_only({"fpaa", "circuit"});
    if (hardware.has("fpaa")) out.fpaa = read_fpaa(hardware.at("fpaa"));
    if (hardware.has("circuit")) out.circuit = read_circuit(hardware.at("circuit"));
  }
  if (node.has("tolerances")) out.spread = read_spread(node.at("tolerances"));
  if (node.has("limits")) out.limits = read_limits(node.at("limits"), true);
  return out;
}

std::optional<std::complex<double>> FilterProject::target_response(RadPerSecond w) const {
  if (sections) return sections->response(w);
  if (fractional) return fractional->response(w);
  return std::nullopt;
}

}  // namespace bodesmith::project
