// plan.json, bodesmith.fpaa_plan/1: writing and reading back.
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/json.hpp"
#include "fpaa/plan.hpp"

namespace bodesmith::fpaa {
namespace {

Json error_json(const PlanError& error) {
  return {{"band_hz", {error.band.from.value, error.band.to.value}},
          {"max_magnitude_db", error.max_magnitude_db},
          {"max_phase_deg", error.max_phase_deg},
          {"max_complex_percent", error.max_complex_percent},
          {"worst_hz", error.worst.value}};
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
  out["cam"] = cam.cam;
  out["option"] = cam.option;
  out["cab"] = cam.cab;
  out["clock_a_hz"] = cam.clock_a.value;
  out["chip_clock"] = cam.clock_index;
  out["phase"] = cam.phase;
  if (cam.section) out["section"] = *cam.section + 1;
  out["requested"] = cam.requested;
  out["realised"] = cam.realised;
  out["capacitors"] = Json::object();
  for (const Capacitor& c : cam.capacitors) out["capacitors"][c.name] = c.units;
  out["z_numerator"] = cam.z.numerator;
  out["z_denominator"] = cam.z.denominator;
  if (cam.own_error_percent) out["own_error_percent"] = *cam.own_error_percent;
  if (cam.least_own_error_percent) out["least_own_error_percent"] = *cam.least_own_error_percent;
  out["delay_cycles"] = cam.delay_cycles;
  out["output_hold"] = cam.output_hold;
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

/// Parameter objects hold numbers and words.
Json values_from(const Node& node) {
  Json out = Json::object();
  for (const auto& [key, value] : node.members()) {
    if (value.kind() == Node::Kind::string) {
      out[key] = value.string();
    } else {
      out[key] = value.number();
    }
  }
  return out;
}

PlacedCam cam_from(const Node& node, const Board& board) {
  PlacedCam cam;
  cam.name = node.at("name").string();
  cam.cam = node.at("cam").string();
  cam.option = node.string_or("option", "");
  cam.cab = static_cast<int>(node.at("cab").integer(1, board.cabs_per_chip));
  cam.clock_a = {node.at("clock_a_hz").positive()};
  cam.clock_index = node.has("chip_clock") ? static_cast<int>(node.at("chip_clock").integer(0, 5)) : 0;
  cam.phase = node.has("phase") ? static_cast<int>(node.at("phase").integer(1, 2)) : 1;
  if (node.has("section")) cam.section = static_cast<int>(node.at("section").integer(1, 1000000)) - 1;
  if (node.has("requested")) cam.requested = values_from(node.at("requested"));
  if (node.has("realised")) cam.realised = values_from(node.at("realised"));
  for (const auto& [name, value] : node.at("capacitors").members()) {
    cam.capacitors.push_back({name, static_cast<int>(value.integer(0, 2 * board.largest_capacitor))});
  }
  cam.z.numerator = node.at("z_numerator").numbers();
  cam.z.denominator = node.at("z_denominator").numbers();
  if (cam.z.numerator.empty()) node.at("z_numerator").fail("is empty, expected [b0, b1, ...]");
  if (cam.z.denominator.empty() || cam.z.denominator[0] == 0.0) {
    node.at("z_denominator").fail("expected [a0, a1, ...] with a0 other than 0");
  }
  if (node.has("own_error_percent")) cam.own_error_percent = node.at("own_error_percent").number();
  if (node.has("least_own_error_percent")) {
    cam.least_own_error_percent = node.at("least_own_error_percent").number();
  }
  cam.delay_cycles = node.has("delay_cycles") ? node.at("delay_cycles").non_negative() : 0.0;
  cam.output_hold = node.boolean_or("output_hold", false);
  if (node.has("resources")) cam.resources = resources_from(node.at("resources"));
  return cam;
}

ClockPlan clocks_from(const Node& chip, const Board& board) {
  ClockPlan out;
  if (!chip.has("clock_divisors")) return out;
  const Node node = chip.at("clock_divisors");
  const auto divisor = [&](const Node& value) {
    const int d = static_cast<int>(value.integer(1, 510));
    if (!is_legal_divisor(d)) value.fail(fmt::format("is {}, expected 1 or an even number up to 510", d));
    return d;
  };
  out.sys1_divisor = divisor(node.at("sys1"));
  out.sys2_divisor = divisor(node.at("sys2"));
  for (int k = 0; k < 6; ++k) {
    const std::string key = fmt::format("clock{}", k);
    if (!node.has(key)) break;
    out.clocks.push_back(
        {static_cast<int>(node.at(key).at("system").integer(1, 2)), divisor(node.at(key).at("divisor"))});
  }
  (void)board;
  return out;
}

}  // namespace

Json Plan::to_json() const {
  Json out;
  out["board"] = board;
  const Board& facts = board_by_name(board);
  out["chips"] = Json::array();
  for (const ChipPlan& chip : chips) {
    Json item;
    item["chip"] = chip.chip;
    item["master_clock_hz"] = chip.master_clock.value;
    Json clocks = Json::object();
    clocks["sys1_hz"] = chip.master_clock.value / chip.clocks.sys1_divisor;
    clocks["sys2_hz"] = chip.master_clock.value / chip.clocks.sys2_divisor;
    Json divisors = Json::object();
    divisors["sys1"] = chip.clocks.sys1_divisor;
    divisors["sys2"] = chip.clocks.sys2_divisor;
    for (size_t k = 0; k < chip.clocks.clocks.size(); ++k) {
      clocks[fmt::format("clock{}_hz", k)] = chip.clocks.frequency(facts, k).value;
      divisors[fmt::format("clock{}", k)] = {{"system", chip.clocks.clocks[k].system},
                                             {"divisor", chip.clocks.clocks[k].divisor}};
    }
    item["clocks_hz"] = clocks;
    item["clock_divisors"] = divisors;
    item["cams"] = Json::array();
    for (const PlacedCam& cam : chip.cams) item["cams"].push_back(cam_json(cam));
    const Resources sum = chip.resources();
    item["resources"] = {
        {"opamps", sum.opamps}, {"capacitors", sum.capacitors}, {"comparators", sum.comparators}};
    out["chips"].push_back(item);
  }
  out["signal_path"] = signal_path;
  out["error"] = error_json(error);
  out["error_with_delays"] = error_json(error_with_delays);
  out["largest_input_v"] = largest_input_v;
  out["assumptions"] = assumptions;
  out["notes"] = notes;
  return out;
}

Plan Plan::from_node(const Node& node) {
  node.expect_schema("fpaa_plan");
  Plan out;
  out.board = node.at("board").string();
  const Board* facts = nullptr;
  try {
    facts = &board_by_name(out.board);
  } catch (const DesignError& error) {
    node.at("board").fail(error.what());
  }
  for (const Node& item : node.at("chips").items()) {
    ChipPlan chip;
    chip.chip = static_cast<int>(item.at("chip").integer(1, facts->chips));
    chip.master_clock = {item.at("master_clock_hz").positive()};
    chip.clocks = clocks_from(item, *facts);
    for (const Node& cam : item.at("cams").items()) chip.cams.push_back(cam_from(cam, *facts));
    out.chips.push_back(std::move(chip));
  }
  for (const Node& item : node.at("signal_path").items()) out.signal_path.push_back(item.string());
  out.error = error_from(node.at("error"));
  if (node.has("error_with_delays")) out.error_with_delays = error_from(node.at("error_with_delays"));
  out.largest_input_v = node.number_or("largest_input_v", 0.0);
  const auto lines = [&](const char* key, std::vector<std::string>& to) {
    if (!node.has(key)) return;
    for (const Node& item : node.at(key).items()) to.push_back(item.string());
  };
  lines("assumptions", out.assumptions);
  lines("notes", out.notes);
  return out;
}

Plan Plan::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

}  // namespace bodesmith::fpaa
