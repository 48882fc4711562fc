// An FPAA plan's streams, and its trim by what was measured on the built board.
#include <numbers>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "circuit_options.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "fpaa/streams/stream_output.hpp"
#include "fpaa/trim/trim.hpp"
#include "functions.hpp"
#include "records.hpp"

namespace bodesmith::python {
namespace {

fpaa::MeasuredBoard measured_board(const Call& call) {
  const BodePoints points = points_of(call);
  fpaa::MeasuredBoard out;
  for (const BodePoint& p : points.points) {
    out.grid.push_back(p.frequency);
    out.gain.push_back(p.gain);
    if (p.phase_deg) out.phase_rad.push_back(*p.phase_deg * std::numbers::pi / 180.0);
  }
  if (const auto percent = maybe_positive(call.options, "measurement_percent"))
    out.deviation = *percent / 100.0;
  return out;
}

/// Of the sections, of the plan as it was designed, or of the plan itself with exact capacitors.
std::vector<std::complex<double>> trim_target(const Node& o, const fpaa::Plan& plan,
                                              const std::vector<Hertz>& grid) {
  if (o.has("sections") && o.has("target")) o.at("target").fail("cannot be combined with sections");
  if (o.has("sections")) {
    const Sections sections = Sections::from_node(o.at("sections"));
    std::vector<std::complex<double>> out;
    for (const Hertz f : grid) out.push_back(sections.response(f.rad_s()));
    return out;
  }
  // The board refers to its plan, which must not be a temporary.
  const fpaa::Plan target = o.has("target") ? fpaa::Plan::from_node(o.at("target")) : plan;
  const fpaa::DrawnBoard board(target, grid);
  return board.response(board.nominal_units());
}

}  // namespace

Answer plan_streams(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"plan", "pins"});
  fpaa::Plan plan = fpaa::Plan::from_node(o.at("plan"));
  std::map<std::string, int> cells;
  if (o.has("pins")) {
    for (const auto& [pin, cell] : o.at("pins").members()) cells[pin] = static_cast<int>(cell.integer(1, 7));
  }
  const Stopwatch watch;
  const auto streams = value_or_throw(fpaa::an231::plan_streams(plan, cells));
  const double difference = fpaa::an231::check_streams(plan, streams);
  Answer out;
  out.result = fpaa::an231::stream_json(streams, difference);
  out.result["timing_s"] = {{"compute", watch.seconds()}};
  const OutputSet files = fpaa::an231::stream_files(plan, streams, "plan.json");
  for (const auto& path : files.paths()) out.files[path.string()] = *files.content(path);
  // Bytes are no text: packets.bin is chipN.ahf in another form.
  out.files.erase("packets.bin");
  return out;
}

Answer trim_plan(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"plan", "sections", "target", "measurement_percent", "unit_array", "samples", "band_hz",
                "seed", "unit_capacitor_percent", "systematic_units"});
  const fpaa::Plan plan = fpaa::Plan::from_node(o.at("plan"));
  fpaa::TrimOptions options;
  options.mismatch = fpaa::MismatchModel::from_node(o, plan.mismatch);
  options.seed = seed_of(o);
  options.samples = integer_or(o, "samples", options.samples, 20, 100000);
  options.band = maybe_band(o);
  options.array = choice(o, "unit_array", {fpaa::UnitArray::binary, fpaa::UnitArray::nested});
  const fpaa::MeasuredBoard measured = measured_board(call);
  const std::vector<Hertz> grid = fpaa::trim_grid(plan, options);
  const auto wanted = trim_target(o, plan, grid);
  const Stopwatch watch;
  const fpaa::Trim trim = fpaa::trim_board(plan, wanted, grid, measured, options);
  Answer out;
  Json body = trim.plan.to_json();
  body["trim"] = trim.to_json();
  out.result = document("fpaa_plan", body, watch.seconds());
  out.files["build_sheet.md"] = fpaa::build_sheet_markdown(trim.plan);
  return out;
}

}  // namespace bodesmith::python
