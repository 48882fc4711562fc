#include "fpaa/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cams/cam_type.hpp"
#include "fpaa/placement.hpp"
#include "fpaa/polynomial_error.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kOutsideBandwidthHz = 250e6;  // AD835
constexpr int kSarRatio = 16;                  // ClockB / ClockA

/// Collects the CAMs of one variant in signal order.
class Builder {
 public:
  Builder(const Disturbance& disturbance, const ControllerOptions& options) : d_(disturbance), o_(options) {}

  ControllerVariant build(PolynomialBy by, const Plan* ascending, const Plan* descending) {
    ControllerVariant out;
    out.by = by;
    const PolynomialError error = polynomial_error(d_, by, o_.outside_error_percent);
    out.max_error_percent = error.max_percent;
    out.rms_error_percent = error.rms_percent;
    out.outside_multipliers = by == PolynomialBy::outside ? 2 : 0;
    cams_.clear();
    std::vector<std::string> powers = {"x", "x2", "x3"};
    double polynomial_cycles = 0.0;
    if (by == PolynomialBy::multipliers) {
      const Json third = {{"scale_per_v", 1.0 / 3.0}};
      add("Square", "Multiplier", "Sample and Hold Off", {"x", "x"}, third);
      add("Cube", "Multiplier", "Sample and Hold Off", {"Square", "x_late"}, third);
      // x, x^2 and x^3 must be of the same instant: one Hold for each cycle that the multipliers take.
      add("x_late", "Hold", "", {"x"});
      add("x_later", "Hold", "", {"x_late"});
      cams_.back().phase = 2;  // two Holds in series need opposite phases
      add("Square_late", "Hold", "", {"Square"});
      powers = {"x_later", "Square_late", "Cube"};
      polynomial_cycles = 2.0;
    }
    if (by == PolynomialBy::lookup) polynomial_cycles = 1.0;
    out.bandwidth_hz =
        polynomial_cycles == 0.0 ? kOutsideBandwidthHz : o_.fast_clock.value / (10.0 * polynomial_cycles);
    const std::string up = branch("Ascending", Disturbance::Branch::ascending, by, powers, ascending);
    const std::string down = branch("Descending", Disturbance::Branch::descending, by, powers, descending);
    add("Slope", "Comparator", "Signal Ground", {"slope"}, {{"hysteresis_v", 0.01}});
    add("Branch", "GainSwitch", "Dual Input", {up, down, "Slope"}, {{"gain_1", 1.0}, {"gain_2", 1.0}});
    add("Output", "SumDiff", "2 inputs", {"r", "Branch"}, {{"gain_1", 1.0}, {"gain_2", -1.0}});
    cams_.back().resources.capacitors = 3;
    add("OutputHold", "Hold", "", {"Output"});  // a half-cycle CAM needs it before a bypass output
    place(out);
    return out;
  }

 private:
  void add(const std::string& name, const std::string& cam, const std::string& option,
           std::vector<std::string> inputs, Json parameters = Json::object()) {
    const CamType& type = cam_type(cam);
    ControllerCam out;
    out.name = name;
    out.cam = cam;
    out.option = option;
    out.inputs = std::move(inputs);
    out.parameters = std::move(parameters);
    out.clock_a = o_.fast_clock;
    out.delay_cycles = cam == "SumDiff" ? 0.5 : type.delay_cycles;
    out.half_cycle = type.half_cycle_output;
    // A CAM whose resources are not publicly known gets a CAB of its own.
    const Board& board = board_by_name(o_.board);
    out.resources =
        type.resources.value_or(Resources{board.per_cab.opamps, board.per_cab.capacitors, 1, 0, 0});
    cams_.push_back(std::move(out));
  }

  std::string branch(const std::string& name, Disturbance::Branch which, PolynomialBy by,
                     const std::vector<std::string>& powers, const Plan* compensator) {
    const auto& a = d_.coefficients(which);
    std::string last = name + "Sum";
    if (by == PolynomialBy::lookup) {
      last = name + "Table";
      add(last, "TransferFunction", "", {"x"});
    } else {
      add(last, "SumDiff", "3 inputs", powers, {{"gain_1", a[0]}, {"gain_2", a[1]}, {"gain_3", a[2]}});
      cams_.back().resources.capacitors = 4;
    }
    add(name + "Amplitude", "Multiplier", "Sample and Hold Off", {last, "amplitude_" + name},
        {{"scale_per_v", 1.0 / 3.0}});
    last = name + "Amplitude";
    if (compensator == nullptr) return last;
    for (const PlacedCam* cam : compensator->cams()) {
      ControllerCam filter;
      filter.name = name + cam->name;
      filter.cam = cam->cam;
      filter.option = cam->option;
      filter.inputs = {last};
      filter.parameters = cam->realised;
      filter.clock_a = cam->clock_a;
      filter.delay_cycles =
          cam->output_hold ? 0.5 : cam->delay_cycles;  // a held output is late by half a period
      filter.resources = cam->resources;
      cams_.push_back(filter);
      last = filter.name;
    }
    return last;
  }

  const ControllerCam* find(const std::string& name) const {
    const auto at =
        std::find_if(cams_.begin(), cams_.end(), [&](const ControllerCam& c) { return c.name == name; });
    return at == cams_.end() ? nullptr : &*at;
  }

  void place(ControllerVariant& out) {
    const Board& board = board_by_name(o_.board);
    try {
      // Holds where a half-cycle output leaves its chip or its clock change the placement: repeat until none
      // is new.
      for (bool again = true; again;) {
        std::vector<Resources> needs;
        for (const ControllerCam& cam : cams_) needs.push_back(cam.resources);
        const std::vector<Place> places = place_in_order(needs, board);
        for (size_t i = 0; i < cams_.size(); ++i) {
          cams_[i].chip = places[i].chip;
          cams_[i].cab = places[i].cab;
        }
        again = add_missing_holds();
      }
      count_io(out, board);
      out.fits = true;
    } catch (const DesignError& error) {
      out.why_not = error.what();
    }
    out.cams = cams_;
    for (const ControllerCam& cam : cams_) {
      out.resources += cam.resources;
      out.chips = std::max(out.chips, cam.chip);
    }
    std::map<std::string, double> known;
    for (const ControllerCam& cam : cams_) out.delay_s = std::max(out.delay_s, delay_to(cam.name, known));
    if (out.by == PolynomialBy::outside) return;
    const double clock_b = kSarRatio * o_.fast_clock.value;
    if (out.fits && !find_clock(board, {clock_b})) {
      out.fits = false;
      out.why_not = fmt::format("ClockB = {} Hz is not in the clock tree", rounded_text(clock_b));
    }
  }

  bool add_missing_holds() {
    for (size_t i = 0; i < cams_.size(); ++i) {
      if (!cams_[i].half_cycle) continue;
      const ControllerCam source = cams_[i];
      const bool leaves = std::any_of(cams_.begin(), cams_.end(), [&](const ControllerCam& c) {
        const bool reads = std::find(c.inputs.begin(), c.inputs.end(), source.name) != c.inputs.end();
        return reads && c.cam != "Hold" && (c.chip != source.chip || c.clock_a != source.clock_a);
      });
      if (!leaves) continue;
      const std::string hold = source.name + "Hold";
      for (ControllerCam& cam : cams_) {
        if (cam.cam != "Hold") std::replace(cam.inputs.begin(), cam.inputs.end(), source.name, hold);
      }
      std::vector<ControllerCam> rest(cams_.begin() + static_cast<std::ptrdiff_t>(i) + 1, cams_.end());
      cams_.resize(i + 1);
      add(hold, "Hold", "", {source.name});
      cams_.insert(cams_.end(), rest.begin(), rest.end());
      return true;
    }
    return false;
  }

  void count_io(ControllerVariant& out, const Board& board) {
    out.io_cells.assign(static_cast<size_t>(board.chips), 0);
    for (int chip = 1; chip <= board.chips; ++chip) {
      std::set<std::string> in;
      std::set<std::string> leaving;
      for (const ControllerCam& cam : cams_) {
        for (const std::string& input : cam.inputs) {
          const ControllerCam* source = find(input);
          if (cam.chip == chip && (source == nullptr || source->chip != chip)) in.insert(input);
          if (cam.chip != chip && source != nullptr && source->chip == chip) leaving.insert(input);
        }
        if (cam.chip == chip && cam.name == "OutputHold") leaving.insert(cam.name);
      }
      const int cells = static_cast<int>(in.size() + leaving.size());
      out.io_cells[static_cast<size_t>(chip - 1)] = cells;
      if (cells > board.io_cells_per_chip) {
        throw DesignError(fmt::format(
            "chip {} needs {} I/O cells and has {}; expected fewer signals from outside (the polynomial by "
            "look-up "
            "needs only x), or a compensator of fewer sections so that a branch stays on one chip",
            chip, cells, board.io_cells_per_chip));
      }
    }
  }

  double delay_to(const std::string& name, std::map<std::string, double>& known) const {
    const ControllerCam* cam = find(name);
    if (cam == nullptr) return 0.0;
    if (const auto at = known.find(name); at != known.end()) return at->second;
    double before = 0.0;
    for (const std::string& input : cam->inputs) before = std::max(before, delay_to(input, known));
    return known[name] = before + cam->delay_cycles / cam->clock_a.value;
  }

  const Disturbance& d_;
  const ControllerOptions& o_;
  std::vector<ControllerCam> cams_;
};

}  // namespace

const char* word(PolynomialBy by) {
  switch (by) {
    case PolynomialBy::outside:
      return "outside";
    case PolynomialBy::multipliers:
      return "multipliers";
    case PolynomialBy::lookup:
      break;
  }
  return "lookup";
}

Controller make_controller(const Disturbance& disturbance, const Plan* ascending, const Plan* descending,
                           const ControllerOptions& options) {
  const Board& board = board_by_name(options.board);
  if (!find_clock(board, options.fast_clock)) {
    throw DesignError(fmt::format("a fast clock of {} Hz is not in the tree, the nearest is {} Hz",
                                  number_text(options.fast_clock.value),
                                  number_text(nearest_clock(board, options.fast_clock).frequency.value)));
  }
  Controller out;
  Builder builder(disturbance, options);
  int chosen = -1;
  for (const PolynomialBy by : {PolynomialBy::outside, PolynomialBy::multipliers, PolynomialBy::lookup}) {
    out.variants.push_back(builder.build(by, ascending, descending));
    const ControllerVariant& made = out.variants.back();
    const int index = static_cast<int>(out.variants.size()) - 1;
    if (options.polynomial ? by != *options.polynomial : false) continue;
    if (!made.fits) {
      if (options.polynomial) throw DesignError(made.why_not);
      continue;
    }
    if (chosen < 0 || made.max_error_percent < out.variants[static_cast<size_t>(chosen)].max_error_percent) {
      chosen = index;
    }
  }
  if (chosen < 0) {
    throw DesignError(fmt::format("no way of making the polynomials fits the board: outside: {}; look-up: {}",
                                  out.variants[0].why_not, out.variants[2].why_not));
  }
  out.chosen = chosen;
  const ControllerVariant& best = out.best();
  if (options.polynomial) {
    out.why = fmt::format("'{}' was asked for", word(best.by));
  } else {
    std::vector<std::string> others;
    for (const ControllerVariant& v : out.variants) {
      if (v.by == best.by) continue;
      others.push_back(
          v.fits ? fmt::format("'{}' is off by {} %", word(v.by), rounded_text(v.max_error_percent, 2))
                 : fmt::format("'{}' does not fit", word(v.by)));
    }
    out.why = fmt::format("'{}' has the least worst error of those that fit: {} % of the stroke ({})",
                          word(best.by), rounded_text(best.max_error_percent, 2), join(others, ", "));
  }
  out.assumptions = {
      "The amplitude gain is a Multiplier CAM with a control voltage: the numbers of GainVoltageControlled "
      "are not "
      "publicly known.",
      "GainSwitch is given a CAB of its own: its capacitor count is not publicly known.",
      "The slope's sign comes from outside (the reference generator knows it): the Differentiator's numbers "
      "are not "
      "publicly known.",
      fmt::format("Each AD835 is taken to be off by {} % of its full scale after trimming; measure yours.",
                  rounded_text(options.outside_error_percent)),
      "I/O cells are counted as one a signal; which pins of the chips the board connects is left to the "
      "wiring."};
  return out;
}

Json Controller::to_json() const {
  Json out;
  out["chosen"] = word(best().by);
  out["why"] = why;
  out["variants"] = Json::array();
  for (const ControllerVariant& v : variants) {
    Json item = {{"polynomial", word(v.by)},
                 {"fits", v.fits},
                 {"max_error_percent", v.max_error_percent},
                 {"rms_error_percent", v.rms_error_percent},
                 {"bandwidth_hz", v.bandwidth_hz},
                 {"delay_s", v.delay_s},
                 {"outside_multipliers", v.outside_multipliers},
                 {"chips", v.chips},
                 {"cams", v.cams.size()},
                 {"opamps", v.resources.opamps},
                 {"capacitors", v.resources.capacitors},
                 {"comparators", v.resources.comparators},
                 {"lookup_tables", v.resources.lookup_tables},
                 {"io_cells", v.io_cells}};
    if (!v.fits) item["why_not"] = v.why_not;
    out["variants"].push_back(item);
  }
  out["cams"] = Json::array();
  for (const ControllerCam& cam : best().cams) {
    out["cams"].push_back({{"name", cam.name},
                           {"cam", cam.cam},
                           {"option", cam.option},
                           {"chip", cam.chip},
                           {"cab", cam.cab},
                           {"clock_a_hz", cam.clock_a.value},
                           {"phase", cam.phase},
                           {"delay_cycles", cam.delay_cycles},
                           {"inputs", cam.inputs},
                           {"parameters", cam.parameters}});
  }
  out["assumptions"] = assumptions;
  return out;
}

std::string controller_sheet(const Controller& controller) {
  Json data = controller.to_json();
  for (Json& v : data["variants"]) {
    for (const char* key : {"max_error_percent", "rms_error_percent", "bandwidth_hz"}) {
      v[key] = rounded_text(v[key].get<double>(), 3);
    }
    v["delay_us"] = rounded_text(1e6 * v["delay_s"].get<double>(), 4);
  }
  for (Json& cam : data["cams"]) {
    std::vector<std::string> parts;
    for (const auto& [key, value] : cam["parameters"].items()) {
      if (value.is_number())
        parts.push_back(fmt::format("{} = {}", key, rounded_text(value.get<double>(), 6)));
    }
    cam["settings"] = join(parts, ", ");
    std::vector<std::string> from;
    for (const Json& input : cam["inputs"]) from.push_back(input.get<std::string>());
    cam["from"] = join(from, ", ");
    cam["clock"] = rounded_text(cam["clock_a_hz"].get<double>() / 1e3, 6);
  }
  return render_template("fpaa/controller.md", data);
}

}  // namespace bodesmith::fpaa
