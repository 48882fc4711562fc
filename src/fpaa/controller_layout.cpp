#include "fpaa/controller_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/comparator.hpp"
#include "fpaa/cams/gain_switch.hpp"
#include "fpaa/cams/hold.hpp"
#include "fpaa/cams/multiplier.hpp"
#include "fpaa/cams/sum_diff.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/placement.hpp"
#include "fpaa/polynomial_error.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kOutsideBandwidthHz = 250e6;  ///< AD835
/// A delay is a tenth of a period at the bandwidth.
constexpr double kPeriodsOfDelay = 10.0;
/// X Y/3 keeps a product of full-scale voltages at full scale.
constexpr Multiplier kFullScaleMultiplier{.scale_per_v = 1.0 / 3.0};
/// The CAM whose output leaves the board.
constexpr const char* kOutput = "OutputHold";

/// Clock cycles that a way of making the powers takes.
double polynomial_cycles(PolynomialBy by) {
  switch (by) {
    case PolynomialBy::outside:
      return 0.0;
    case PolynomialBy::multipliers:
      return 2.0;
    case PolynomialBy::lookup:
      break;
  }
  return 1.0;
}

/// The CAMs of one variant, in signal order.
class ControllerLayout {
 public:
  ControllerLayout(PolynomialBy by, const Disturbance& disturbance, const ControllerOptions& options)
      : by_(by), disturbance_(disturbance), options_(options), board_(board_by_name(options.board)) {}

  void collect(const Plan* ascending, const Plan* descending) {
    const std::vector<std::string> powers = add_powers();
    const std::string up = add_branch("Ascending", Disturbance::Branch::ascending, powers, ascending);
    const std::string down = add_branch("Descending", Disturbance::Branch::descending, powers, descending);
    add("Slope", comparator_cam(), ComparatorSpec::kSignalGround, {"slope"},
        ComparatorSpec{.hysteresis_v = 0.01}.values());
    add("Branch", gain_switch_cam(), GainSwitchSpec::kDualInput, {up, down, "Slope"},
        GainSwitchSpec{}.values());
    const SumDiffSpec difference{{1.0, -1.0}};
    add("Output", sum_diff_cam(), difference.option(), {"r", "Branch"}, difference.values());
    add(kOutput, hold_cam(), "", {"Output"});  // a half-cycle CAM needs it before a bypass output
  }

  /// Holds where a half-cycle output leaves its chip or its clock change the placement: repeats until none is
  /// new.
  std::optional<Refusal> place() {
    do {
      std::vector<Resources> needs;
      for (const ControllerCam& cam : cams_) needs.push_back(cam.resources);
      const Outcome<std::vector<Place>> placed = place_in_order(needs, board_);
      if (const Refusal* refusal = refusal_of(placed)) return *refusal;
      const std::vector<Place>& places = std::get<std::vector<Place>>(placed);
      for (std::size_t i = 0; i < cams_.size(); ++i) {
        cams_[i].chip = places[i].chip;
        cams_[i].cab = places[i].cab;
      }
    } while (add_missing_hold());
    return std::nullopt;
  }

  /// I/O cells used, of each chip, counted up to the first chip that has too few.
  std::vector<int> io_cells() const {
    std::vector<int> out;
    for (int chip = 1; chip <= board_.chips; ++chip) {
      if (!out.empty() && out.back() > board_.io_cells_per_chip) break;
      std::set<std::string> entering;
      std::set<std::string> leaving;
      for (const ControllerCam& cam : cams_) {
        for (const std::string& input : cam.inputs) {
          const ControllerCam* source = find(input);
          if (cam.chip == chip && (source == nullptr || source->chip != chip)) entering.insert(input);
          if (cam.chip != chip && source != nullptr && source->chip == chip) leaving.insert(input);
        }
        if (cam.chip == chip && cam.name == kOutput) leaving.insert(cam.name);
      }
      out.push_back(static_cast<int>(entering.size() + leaving.size()));
    }
    out.resize(static_cast<std::size_t>(board_.chips), 0);
    return out;
  }

  /// The longest way from a signal from outside to any CAM's output, in seconds.
  double longest_delay() const {
    std::map<std::string, double> known;
    double out = 0.0;
    for (const ControllerCam& cam : cams_) out = std::max(out, delay_to(cam.name, known));
    return out;
  }

  const std::vector<ControllerCam>& cams() const { return cams_; }

 private:
  ControllerCam& add(const std::string& name, const Cam& cam, const std::string& option,
                     std::vector<std::string> inputs, CamValues parameters = {}) {
    cams_.push_back(made(name, cam, option, std::move(inputs), std::move(parameters)));
    return cams_.back();
  }

  ControllerCam made(const std::string& name, const Cam& cam, const std::string& option,
                     std::vector<std::string> inputs, CamValues parameters) const {
    ControllerCam out;
    out.name = name;
    out.cam = &cam;
    out.option = option;
    out.parameters = std::move(parameters);
    out.clock_a = options_.fast_clock;
    out.delay_cycles = cam.facts().delay_cycles;
    out.half_cycle = cam.facts().half_cycle_output;
    // A CAM whose resources are not publicly known gets a CAB of its own.
    const Resources whole_cab{board_.per_cab.opamps, board_.per_cab.capacitors, 1, 0, 0};
    out.resources = cam.resources(inputs.size()).value_or(whole_cab);
    out.inputs = std::move(inputs);
    return out;
  }

  /// x, x^2 and x^3 of the same instant, by name.
  std::vector<std::string> add_powers() {
    if (by_ != PolynomialBy::multipliers) return {"x", "x2", "x3"};
    const Multiplier& m = kFullScaleMultiplier;
    add("Square", multiplier_cam(), m.option(), {"x", "x"}, m.values());
    add("Cube", multiplier_cam(), m.option(), {"Square", "x_late"}, m.values());
    // One Hold for each cycle that the multipliers take.
    add("x_late", hold_cam(), "", {"x"});
    add("x_later", hold_cam(), "", {"x_late"}).phase = 2;  // two Holds in series need opposite phases
    add("Square_late", hold_cam(), "", {"Square"});
    return {"x_later", "Square_late", "Cube"};
  }

  /// A branch's polynomial, amplitude gain and compensator; the name of its last CAM.
  std::string add_branch(const std::string& name, Disturbance::Branch which,
                         const std::vector<std::string>& powers, const Plan* compensator) {
    const auto& a = disturbance_.coefficients(which);
    std::string last;
    if (by_ == PolynomialBy::lookup) {
      last = add(name + "Table", transfer_function_cam(), "", {"x"}).name;
    } else {
      const SumDiffSpec sum{{a[0], a[1], a[2]}};
      last = add(name + "Sum", sum_diff_cam(), sum.option(), powers, sum.values()).name;
    }
    const Multiplier& m = kFullScaleMultiplier;
    last =
        add(name + "Amplitude", multiplier_cam(), m.option(), {last, "amplitude_" + name}, m.values()).name;
    return compensator == nullptr ? last : add_compensator(name, *compensator, last);
  }

  std::string add_compensator(const std::string& branch, const Plan& plan, std::string last) {
    for (const PlacedCam* cam : plan.cams()) {
      ControllerCam filter;
      filter.name = branch + cam->name;
      filter.cam = cam->cam;
      filter.option = cam->option;
      filter.inputs = {last};
      filter.parameters = cam->realised;
      filter.clock_a = cam->clock_a;
      // A held output is late by half a period.
      filter.delay_cycles = cam->output_hold ? 0.5 : cam->delay_cycles;
      filter.resources = cam->resources;
      last = filter.name;
      cams_.push_back(std::move(filter));
    }
    return last;
  }

  const ControllerCam* find(const std::string& name) const {
    const auto at =
        std::find_if(cams_.begin(), cams_.end(), [&](const ControllerCam& c) { return c.name == name; });
    return at == cams_.end() ? nullptr : &*at;
  }

  /// Whether a half-cycle output goes to a CAM of another chip or clock that cannot take it.
  bool leaves_unheld(const ControllerCam& source) const {
    if (!source.half_cycle) return false;
    return std::any_of(cams_.begin(), cams_.end(), [&](const ControllerCam& c) {
      const bool reads = std::find(c.inputs.begin(), c.inputs.end(), source.name) != c.inputs.end();
      return reads && !c.cam->facts().takes_half_cycle_anywhere &&
             (c.chip != source.chip || c.clock_a != source.clock_a);
    });
  }

  /// Puts a Hold behind the first CAM that needs one; false when none does.
  bool add_missing_hold() {
    const auto source = std::find_if(cams_.begin(), cams_.end(),
                                     [&](const ControllerCam& cam) { return leaves_unheld(cam); });
    if (source == cams_.end()) return false;
    const std::string name = source->name;
    const std::string hold = name + "Hold";
    for (ControllerCam& cam : cams_) {
      if (cam.cam->facts().takes_half_cycle_anywhere) continue;
      std::replace(cam.inputs.begin(), cam.inputs.end(), name, hold);
    }
    cams_.insert(source + 1, made(hold, hold_cam(), "", {name}, {}));
    return true;
  }

  double delay_to(const std::string& name, std::map<std::string, double>& known) const {
    const ControllerCam* cam = find(name);
    if (cam == nullptr) return 0.0;
    if (const auto at = known.find(name); at != known.end()) return at->second;
    double before = 0.0;
    for (const std::string& input : cam->inputs) before = std::max(before, delay_to(input, known));
    return known[name] = before + cam->delay_cycles / cam->clock_a.value;
  }

  PolynomialBy by_;
  const Disturbance& disturbance_;
  const ControllerOptions& options_;
  const Board& board_;
  std::vector<ControllerCam> cams_;
};

std::optional<Refusal> check_io(const std::vector<int>& cells, const Board& board) {
  int chip = 0;
  for (const int used : cells) {
    ++chip;
    if (used <= board.io_cells_per_chip) continue;
    return Refusal{fmt::format(
        "chip {} needs {} I/O cells and has {}; expected fewer signals from outside (the polynomial by "
        "look-up needs only x), or a compensator of fewer sections so that a branch stays on one chip",
        chip, used, board.io_cells_per_chip)};
  }
  return std::nullopt;
}

/// Every ClockB that the CAMs of the fast clock need is in the tree.
std::optional<Refusal> check_clock_b(const std::vector<ControllerCam>& cams, Hertz fast_clock,
                                     const Board& board) {
  for (const ControllerCam& cam : cams) {
    const int ratio = cam.cam->facts().clock_b_ratio;
    if (ratio == 0) continue;
    const Hertz clock_b{ratio * fast_clock.value};
    if (find_clock(board, clock_b)) continue;
    return Refusal{fmt::format("ClockB = {} Hz is not in the clock tree", rounded_text(clock_b.value))};
  }
  return std::nullopt;
}

}  // namespace

ControllerVariant laid_out(PolynomialBy by, const Disturbance& disturbance, const Plan* ascending,
                           const Plan* descending, const ControllerOptions& options) {
  const Board& board = board_by_name(options.board);
  ControllerVariant out;
  out.by = by;
  const PolynomialError error = polynomial_error(disturbance, by, options.outside_error_percent);
  out.max_error_percent = error.max_percent;
  out.rms_error_percent = error.rms_percent;
  out.outside_multipliers = by == PolynomialBy::outside ? 2 : 0;
  const double cycles = polynomial_cycles(by);
  out.bandwidth_hz =
      cycles == 0.0 ? kOutsideBandwidthHz : options.fast_clock.value / (kPeriodsOfDelay * cycles);

  ControllerLayout layout(by, disturbance, options);
  layout.collect(ascending, descending);
  out.refusal = layout.place();
  if (out.fits()) {
    out.io_cells = layout.io_cells();
    out.refusal = check_io(out.io_cells, board);
  }
  out.cams = layout.cams();
  for (const ControllerCam& cam : out.cams) {
    out.resources += cam.resources;
    out.chips = std::max(out.chips, cam.chip);
  }
  out.delay_s = layout.longest_delay();
  if (by != PolynomialBy::outside && out.fits()) {
    out.refusal = check_clock_b(out.cams, options.fast_clock, board);
  }
  return out;
}

}  // namespace bodesmith::fpaa
