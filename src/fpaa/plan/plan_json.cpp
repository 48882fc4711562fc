// plan.json, bodesmith.fpaa_plan/1: writing and reading back.
#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/plan_graph.hpp"

namespace bodesmith::fpaa {
namespace {

Json total_json(const PlanTotal& total) {
  return {{"p95_percent", total.p95_percent},           {"at_input_v", total.at_input_v},
          {"designed_percent", total.designed_percent}, {"mismatch_p95_percent", total.mismatch_p95_percent},
          {"noise_percent", total.noise_percent},       {"offset_percent", total.offset_percent},
          {"from_bound_db", total.from_bound_db},       {"image_percent", total.image_percent}};
}

PlanTotal total_from(const Node& node) {
  return {node.at("p95_percent").number(),      node.at("at_input_v").number(),
          node.at("designed_percent").number(), node.at("mismatch_p95_percent").number(),
          node.at("noise_percent").number(),    node.at("offset_percent").number(),
          node.number_or("from_bound_db", 0.0), node.number_or("image_percent", 0.0)};
}

Json trade_off_json(const std::vector<TradeOff>& curve) {
  Json out = Json::array();
  for (const TradeOff& at : curve) {
    out.push_back({{"at_input_v", at.at_input_v},
                   {"designed_percent", at.designed_percent},
                   {"p95_percent", at.p95_percent},
                   {"opamps", at.opamps},
                   {"chosen", at.chosen}});
  }
  return out;
}

std::vector<TradeOff> trade_off_from(const Node& plan) {
  std::vector<TradeOff> out;
  if (!plan.has("trade_off")) return out;
  for (const Node& at : plan.at("trade_off").items()) {
    out.push_back({at.at("at_input_v").number(), at.at("designed_percent").number(),
                   at.at("p95_percent").number(), static_cast<int>(at.at("opamps").integer(0, 1000)),
                   at.boolean_or("chosen", false)});
  }
  return out;
}

Json image_json(const ImageLine& image) {
  return {
      {"signal_hz", image.signal.value}, {"line_hz", image.line.value}, {"magnitude_db", image.magnitude_db}};
}

std::optional<ImageLine> image_from(const Node& node, const char* key) {
  if (!node.has(key)) return std::nullopt;
  const Node image = node.at(key);
  return ImageLine{
      {image.at("signal_hz").number()}, {image.at("line_hz").number()}, image.at("magnitude_db").number()};
}

PlanError error_from(const Node& node) {
  PlanError out;
  const std::vector<double> band = node.at("band_hz").numbers();
  if (band.size() != 2) node.at("band_hz").fail("expected [from, to]");
  out.band = {Hertz{band[0]}, Hertz{band[1]}};
  out.max_magnitude_db = node.at("max_magnitude_db").number();
  out.max_phase_deg = node.at("max_phase_deg").number();
  out.max_complex_percent = node.at("max_complex_percent").number();
  out.worst = {node.number_or("worst_hz", 0.0)};
  return out;
}

Json cam_json(const PlacedCam& cam) {
  Json out;
  out["name"] = cam.name;
  out["cam"] = cam.cam_name();
  out["option"] = cam.option;
  out["cab"] = cam.cab;
  out["clock_a_hz"] = cam.clock_a.value;
  out["chip_clock"] = cam.clock_index;
  out["phase"] = cam.phase;
  out["requested"] = cam.requested.to_json();
  out["realised"] = cam.realised.to_json();
  out["capacitors"] = Json::object();
  for (const Capacitor& c : cam.capacitors) out["capacitors"][c.name] = c.units;
  out["z_numerator"] = cam.z.numerators[0];
  if (cam.input_count() > 1) out["z_numerators"] = cam.z.numerators;
  out["z_denominator"] = cam.z.denominator;
  out["delay_cycles"] = cam.delay_cycles;
  out["resources"] = {{"opamps", cam.resources.opamps},
                      {"capacitors", cam.resources.capacitors},
                      {"comparators", cam.resources.comparators}};
  return out;
}

Resources resources_from(const Node& node) {
  Resources out;
  out.opamps = static_cast<int>(node.at("opamps").integer(0, 1000));
  out.capacitors = static_cast<int>(node.at("capacitors").integer(0, 1000));
  out.comparators = static_cast<int>(node.at("comparators").integer(0, 1000));
  return out;
}

const Cam& cam_type_from(const Node& node) {
  const std::string name = node.string();
  if (const Cam* cam = cam_registry().find(name)) return *cam;
  node.fail(fmt::format("is '{}', expected a CAM of the library: {}", name, cam_registry().names()));
}

/// `z_numerators`, one an input; a CAM with one input may have `z_numerator` alone.
std::vector<std::vector<double>> numerators_from(const Node& node) {
  const bool all = node.has("z_numerators");
  std::vector<std::vector<double>> out;
  for (const Node& list : all ? node.at("z_numerators").items() : std::vector{node.at("z_numerator")}) {
    out.push_back(list.numbers());
    if (out.back().empty()) list.fail("is empty, expected [b0, b1, ...]");
  }
  if (out.empty()) node.at("z_numerators").fail("is empty, expected one [b0, b1, ...] an input");
  return out;
}

PlacedCam cam_from(const Node& node, Hertz master_clock) {
  PlacedCam cam;
  cam.name = node.at("name").string();
  cam.cam = &cam_type_from(node.at("cam"));
  cam.option = node.string_or("option", "");
  cam.cab = static_cast<int>(node.at("cab").integer(1, kCabs));
  cam.clock_a = {node.at("clock_a_hz").positive()};
  if (cam.clock_a > master_clock)
    node.at("clock_a_hz")
        .fail(fmt::format("is {}, expected at most the master clock's {:g}", cam.clock_a.value,
                          master_clock.value));
  cam.clock_index =
      node.has("chip_clock") ? static_cast<int>(node.at("chip_clock").integer(0, kClocks - 1)) : 0;
  cam.phase = node.has("phase") ? static_cast<int>(node.at("phase").integer(1, 2)) : 1;
  if (node.has("requested")) cam.requested = CamValues::from_node(node.at("requested"));
  if (node.has("realised")) cam.realised = CamValues::from_node(node.at("realised"));
  for (const auto& [name, value] : node.at("capacitors").members()) {
    cam.capacitors.push_back({name, static_cast<int>(value.integer(0, 2 * kMostUnits))});
  }
  cam.z.numerators = numerators_from(node);
  cam.z.denominator = node.at("z_denominator").numbers();
  if (cam.z.denominator.empty() || cam.z.denominator[0] == 0.0) {
    node.at("z_denominator").fail("expected [a0, a1, ...] with a0 other than 0");
  }
  cam.delay_cycles = node.has("delay_cycles") ? node.at("delay_cycles").non_negative() : 0.0;
  if (node.has("resources")) cam.resources = resources_from(node.at("resources"));
  return cam;
}

ClockPlan clocks_from(const Node& chip) {
  ClockPlan out;
  if (!chip.has("clock_divisors")) return out;
  const Node node = chip.at("clock_divisors");
  const auto divisor = [&](const Node& value) {
    const int d = static_cast<int>(value.integer(1, kLargestDivisor));
    if (!is_legal_divisor(d)) value.fail(fmt::format("is {}, expected 1 or an even number up to 510", d));
    return d;
  };
  out.sys1_divisor = divisor(node.at("sys1"));
  out.sys2_divisor = divisor(node.at("sys2"));
  for (int k = 0; k < kClocks; ++k) {
    const std::string key = fmt::format("clock{}", k);
    if (!node.has(key)) break;
    out.clocks.push_back(
        {static_cast<int>(node.at(key).at("system").integer(1, 2)), divisor(node.at(key).at("divisor"))});
  }
  return out;
}

Json chip_json(const ChipPlan& chip) {
  Json out;
  out["chip"] = chip.chip;
  out["master_clock_hz"] = chip.master_clock.value;
  Json clocks = Json::object();
  clocks["sys1_hz"] = chip.master_clock.value / chip.clocks.sys1_divisor;
  clocks["sys2_hz"] = chip.master_clock.value / chip.clocks.sys2_divisor;
  Json divisors = Json::object();
  divisors["sys1"] = chip.clocks.sys1_divisor;
  divisors["sys2"] = chip.clocks.sys2_divisor;
  for (std::size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
    clocks[fmt::format("clock{}_hz", k)] = chip.clocks.frequency(chip.master_clock, k).value;
    divisors[fmt::format("clock{}", k)] = {{"system", chip.clocks.clocks[k].system},
                                           {"divisor", chip.clocks.clocks[k].divisor}};
  }
  out["clocks_hz"] = clocks;
  out["clock_divisors"] = divisors;
  out["cams"] = Json::array();
  for (const PlacedCam& cam : chip.cams) out["cams"].push_back(cam_json(cam));
  if (!chip.pins.empty()) out["pins"] = chip.pins;
  const Resources sum = chip.resources();
  out["resources"] = {
      {"opamps", sum.opamps}, {"capacitors", sum.capacitors}, {"comparators", sum.comparators}};
  return out;
}

ChipPlan chip_from(const Node& node, const Board& board) {
  ChipPlan out;
  out.chip = static_cast<int>(node.at("chip").integer(1, board.chips));
  out.master_clock = {node.at("master_clock_hz").positive()};
  out.clocks = clocks_from(node);
  for (const Node& cam : node.at("cams").items()) out.cams.push_back(cam_from(cam, board.master_clock));
  if (node.has("pins")) {
    for (const auto& [pin, cell] : node.at("pins").members()) out.pins[pin] = cell.string();
  }
  return out;
}

Json wires_json(const std::vector<Wire>& wires) {
  Json out = Json::array();
  for (const Wire& wire : wires) {
    out.push_back({{"from", wire.from}, {"to", wire.to}, {"input", wire.input}});
  }
  return out;
}

/// `wires`; a plan without them is one path, each pin and CAM of its signal path wired to the next.
std::vector<Wire> wires_from(const Node& plan) {
  std::vector<Wire> out;
  if (plan.has("wires")) {
    for (const Node& item : plan.at("wires").items()) {
      const int input = item.has("input") ? static_cast<int>(item.at("input").integer(1, 100)) : 1;
      out.push_back({item.at("from").string(), item.at("to").string(), input});
    }
    return out;
  }
  std::string last;
  for (const Node& item : plan.at("signal_path").items()) {
    std::string next = item.string();
    if (!last.empty()) out.push_back({.from = last, .to = next});
    last = std::move(next);
  }
  return out;
}

std::vector<std::string> lines_from(const Node& node, const char* key) {
  std::vector<std::string> out;
  if (!node.has(key)) return out;
  for (const Node& item : node.at(key).items()) out.push_back(item.string());
  return out;
}

/// A wire to what is not there, or a second one to one input, is the file's fault.
void check_wires(const Plan& plan, const Node& node) {
  const Outcome<PlanGraph> graph = plan_graph(plan);
  if (const Refusal* refusal = refusal_of(graph)) {
    node.at(node.has("wires") ? "wires" : "signal_path").fail(refusal->reason);
  }
}

}  // namespace

Json PlanError::to_json() const {
  return {{"band_hz", {band.from.value, band.to.value}},
          {"max_magnitude_db", max_magnitude_db},
          {"max_phase_deg", max_phase_deg},
          {"max_complex_percent", max_complex_percent},
          {"worst_hz", worst.value}};
}

Json Plan::to_json() const {
  Json out;
  out["board"] = board;
  out["chips"] = Json::array();
  for (const ChipPlan& chip : chips) out["chips"].push_back(chip_json(chip));
  out["wires"] = wires_json(wires);
  out["signal_path"] = signal_path();
  out["error"] = error.to_json();
  out["error_with_delays"] = error_with_delays.to_json();
  if (total) out["total"] = total_json(*total);
  out["mismatch"] = mismatch.to_json();
  if (!slow.is_at_once()) out["slow"] = slow.to_json();
  if (!trade_off.empty()) out["trade_off"] = trade_off_json(trade_off);
  out["largest_input_v"] = max_input_v;
  out["largest_step_v"] = max_step_v;
  if (image) out["largest_image"] = image_json(*image);
  if (image_in_band) out["largest_image_in_band"] = image_json(*image_in_band);
  if (!topology.empty()) out["topology"] = topology;
  out["assumptions"] = assumptions;
  out["notes"] = notes;
  return out;
}

Plan Plan::from_node(const Node& node) {
  node.expect_schema("fpaa_plan");
  Plan out;
  out.board = node.at("board").string();
  const Outcome<const Board*> facts = find_board(out.board);
  if (const Refusal* refusal = refusal_of(facts)) node.at("board").fail(refusal->reason);
  for (const Node& item : node.at("chips").items()) {
    out.chips.push_back(chip_from(item, *std::get<const Board*>(facts)));
  }
  out.wires = wires_from(node);
  check_wires(out, node);
  out.error = error_from(node.at("error"));
  if (node.has("error_with_delays")) out.error_with_delays = error_from(node.at("error_with_delays"));
  if (node.has("total")) out.total = total_from(node.at("total"));
  if (node.has("mismatch")) out.mismatch = MismatchModel::from_node(node.at("mismatch"), {});
  if (node.has("slow")) out.slow = SlowParts::from_node(node.at("slow"));
  out.trade_off = trade_off_from(node);
  out.max_input_v = node.number_or("largest_input_v", 0.0);
  out.max_step_v = node.number_or("largest_step_v", 0.0);
  out.image = image_from(node, "largest_image");
  out.image_in_band = image_from(node, "largest_image_in_band");
  out.topology = node.string_or("topology", "");
  out.assumptions = lines_from(node, "assumptions");
  out.notes = lines_from(node, "notes");
  return out;
}

Plan Plan::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

}  // namespace bodesmith::fpaa
