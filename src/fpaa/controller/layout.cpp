#include "fpaa/controller/branches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/filter_stage.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/controller/io.hpp"
#include "fpaa/controller/scale.hpp"
#include "fpaa/plan/assembly.hpp"
#include "fpaa/plan/plan_graph.hpp"
#include "fpaa/streams/lookup_stage.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::fpaa {
namespace {

using Direction = Disturbance::Branch;

/// A delay is a tenth of a period at the bandwidth.
constexpr double kPeriodsOfDelay = 10.0;
/// Of the slope detector's high pass: long enough for a slow reference to lift it over the comparator's
/// hysteresis, short against half a period of a fast one.
constexpr double kSlopeTimeConstant = 50e-6;
constexpr int kSlopeGain = 15;

/// Clock cycles that a way of making the powers takes.
double polynomial_cycles(PolynomialBy by) {
  static constexpr double kCycles[] = {0.0, 2.0, 1.0};  // outside, multipliers, lookup
  return kCycles[static_cast<std::size_t>(by)];
}

/// The CAMs of one variant, in signal order.
class ControllerLayout {
 public:
  ControllerLayout(ControllerVariant& variant, const Disturbance& disturbance,
                   const BranchPlans& compensators, const ControllerOptions& options)
      : out_(variant),
        branches_(variant, disturbance, compensators, options),
        compensators_(compensators),
        options_(options),
        board_(board_by_name(options.board)) {}

  /// Throws DesignError: a branch that cannot be made at all.
  void collect() {
    out_.outside.push_back({OutsidePart::Kind::reference, "r", {}, 0.0});
    add_slope_detector();
    switch (out_.structure) {
      case ControllerStructure::loop:
        add_pass("", "OutputHold", "r");
        break;
      case ControllerStructure::open:
        add_pass("", "r", "r");
        break;
      case ControllerStructure::delayed:
        add_delayed_pass("", "r");
        break;
      case ControllerStructure::two_pass:
        add_delayed_pass("First", "r");
        add_delayed_pass("", "FirstOutputHold");
        break;
    }
  }

  /// Holds where a half-cycle output leaves its chip or its clock change the placement: repeats until none is
  /// new.
  void place() {
    do {
      std::vector<PlaceNeed> needs;
      for (const ControllerCam& cam : out_.cams) needs.push_back({cam.resources, cam.group});
      const std::vector<Place> places = value_or_throw(fpaa::place(needs, board_));
      for (std::size_t i = 0; i < out_.cams.size(); ++i) {
        out_.cams[i].chip = places[i].chip;
        out_.cams[i].cab = places[i].cab;
      }
    } while (add_missing_hold());
    put_tables_where_bytes_are_known();
  }

 private:
  bool switches_outside() const { return out_.by == PolynomialBy::outside || options_.outside_switch; }

  /// CABs are alike: each chip's look-up stage changes places with whatever stands in the CAB for which its
  /// bytes are known.
  void put_tables_where_bytes_are_known() {
    for (const ControllerCam& table : std::vector<ControllerCam>(out_.cams)) {
      if (table.cam != &transfer_function_cam()) continue;
      for (ControllerCam& cam : out_.cams) {
        if (cam.chip != table.chip) continue;
        if (cam.cab == table.cab) {
          cam.cab = an231::kLookupCab;
        } else if (cam.cab == an231::kLookupCab) {
          cam.cab = table.cab;
        }
      }
    }
  }

  ControllerCam& add(const std::string& name, const Cam& cam, const std::string& option,
                     std::vector<std::string> inputs, CamValues requested = {}) {
    out_.cams.push_back(made(name, cam, option, std::move(inputs), std::move(requested)));
    return out_.cams.back();
  }

  ControllerCam made(const std::string& name, const Cam& cam, const std::string& option,
                     std::vector<std::string> inputs, CamValues requested) const {
    ControllerCam made = branches_.cam(name, cam, std::move(inputs));
    made.option = option;
    made.requested = std::move(requested);
    made.realised = made.requested;
    made.group = group_;
    return made;
  }

  /// A FilterBilinear at the reference.
  ControllerCam filtered(const std::string& name, std::vector<double> capacitors) const {
    const Cam& cam = *cam_registry().find("FilterBilinear");
    ControllerCam out = made(name, cam, "", {"r"}, {});
    cam.place({.c = std::move(capacitors)}, out);
    return out;
  }

  /// The sign of the reference's slope: a high pass, a gain that may clip, a comparator. Off the board
  /// where the switch stands there too.
  void add_slope_detector() {
    if (switches_outside()) return;
    const double clock = options_.fast_clock.value;
    const int cd = std::clamp(nearest_whole<int>(kSlopeTimeConstant * clock), 1, kMostUnits);
    out_.cams.push_back(
        filtered("SlopeFilter", {0, static_cast<double>(kMostUnits), 1, static_cast<double>(cd)}));
    ControllerCam& gain = add("SlopeGain", gain_hold_cam(), "Inverting", {"SlopeFilter"});
    gain.weights = {-kSlopeGain};
    set_weights(gain, 1.0);
  }

  /// v = r - K d(argument), the reference delayed as long as the disturbance by a low pass.
  void add_delayed_pass(const std::string& prefix, const std::string& argument) {
    const std::string delay = prefix + "ReferenceDelay";
    add_pass(prefix, argument, delay);
    // -1/(1 + n (1 - 1/z)) is late by n cycles. It inverts, so that the sum's own input does so without
    // delay.
    const double cycles = age(prefix + "Output", 1) * options_.fast_clock.value;
    const double cout = std::max(1, whole_number<int>(kMostUnits / std::max(1.0, cycles)));
    ControllerCam filter = filtered(delay, {cout, 0, cout, std::round(cycles * cout)});
    filter.group = out_.find(prefix + "Output")->group;
    const auto output = std::ranges::find(out_.cams, prefix + "Output", &ControllerCam::name);
    out_.cams.insert(output, std::move(filter));
  }

  /// Both branches of K d(argument), the switch between them, and the difference from the reference, held.
  void add_pass(const std::string& prefix, const std::string& argument, const std::string& reference) {
    const BranchInputs inputs = branches_.add_powers(out_.cams, prefix, argument, ++group_);
    // Sums that only the switch reads stay with it.
    const bool sums_late = out_.by == PolynomialBy::multipliers && compensators_ == BranchPlans{};
    if (sums_late) ++group_;
    std::array<std::string, 2> last;
    for (const Direction branch : kBranches) {
      const std::size_t b = branch_index(branch);
      if (!sums_late) ++group_;
      last[b] = branches_.add_branch(out_.cams, prefix, branch, inputs, group_);
      if (compensators_[b] != nullptr) last[b] = add_compensator(prefix, branch, *compensators_[b], last[b]);
    }
    // A table's gain stays with the switch that reads it.
    if (!switches_outside() && !sums_late && out_.by != PolynomialBy::lookup) ++group_;
    add_switch_and_difference(prefix, last, reference);
  }

  void add_switch_and_difference(const std::string& prefix, const std::array<std::string, 2>& last,
                                 const std::string& reference) {
    const std::string chosen = prefix + "Branch";
    if (switches_outside()) {
      out_.outside.push_back({OutsidePart::Kind::switched, chosen, {last[0], last[1]}, 0.0});
    } else {
      const std::string slope = prefix + "Slope";
      add(slope, comparator_cam(), "Signal Ground", {"SlopeGain"}, {{"hysteresis_v", 0.01}});
      add(chosen, gain_switch_cam(), "Dual Input", {last[0], last[1], slope},
          {{"gain_1", 1.0}, {"gain_2", 1.0}});
    }
    const std::string name = prefix + "Output";
    ControllerCam& sum = add(name, sum_diff_cam(), "2 inputs", {reference, chosen});
    sum.weights = {reference == "r" ? 1.0 : -1.0, -branches_.output_weight()};
    set_weights_first_exact(sum);
    // A half-cycle CAM needs it before a bypass output; it is the one hold of the loop.
    out_.drive = name + "Hold";
    add(out_.drive, hold_cam(), "", {name});
  }

  std::string add_compensator(const std::string& prefix, Direction branch, const Plan& plan,
                              const std::string& input) {
    const PlanGraph graph = value_or_throw(plan_graph(plan));
    const std::string before = prefix + ControllerBranches::name_of(branch);
    const auto name_of = [&](const PlanGraph::Source& source) {
      return source.node ? before + graph.nodes[*source.node].cam->name : input;
    };
    for (const PlanGraph::PlanNode& node : graph.nodes) {
      ControllerCam filter;
      static_cast<PlacedCam&>(filter) = *node.cam;
      filter.name = before + node.cam->name;
      filter.inputs.resize(node.inputs.size());
      for (const PlanGraph::Input& in : node.inputs) {
        if (in.number > filter.inputs.size())
          throw DesignError(
              fmt::format("{} of the compensator has an input that nothing is wired to", node.name));
        filter.inputs[in.number - 1] = name_of(in.from);
      }
      filter.group = ++group_;
      out_.cams.push_back(std::move(filter));
    }
    return name_of(graph.output);
  }

  /// Whether a half-cycle output goes to a CAM of another chip or clock that cannot take it, or off the
  /// board.
  bool leaves_unheld(const ControllerCam& source) const {
    if (!source.cam->facts().half_cycle_output) return false;
    const auto reads = [&](const std::vector<std::string>& inputs) {
      return std::ranges::find(inputs, source.name) != inputs.end();
    };
    return std::ranges::any_of(out_.cams,
                               [&](const ControllerCam& c) {
                                 return reads(c.inputs) && !c.cam->facts().takes_half_cycle_anywhere &&
                                        (c.chip != source.chip || c.clock_a != source.clock_a);
                               }) ||
           std::ranges::any_of(out_.outside, [&](const OutsidePart& p) { return reads(p.inputs); });
  }

  /// Puts a Hold behind the first CAM that needs one; false when none does.
  bool add_missing_hold() {
    const auto source =
        std::ranges::find_if(out_.cams, [&](const ControllerCam& cam) { return leaves_unheld(cam); });
    if (source == out_.cams.end()) return false;
    const std::string name = source->name;
    const std::string hold = name + "Hold";
    for (ControllerCam& cam : out_.cams) {
      if (cam.cam->facts().takes_half_cycle_anywhere) continue;
      std::replace(cam.inputs.begin(), cam.inputs.end(), name, hold);
    }
    for (OutsidePart& part : out_.outside) std::replace(part.inputs.begin(), part.inputs.end(), name, hold);
    ControllerCam cam = made(hold, hold_cam(), "", {name}, {});
    cam.clock_a = source->clock_a;
    cam.group = source->group;
    out_.cams.insert(source + 1, std::move(cam));
    return true;
  }

 public:
  /// Age of what stands at an input of a CAM when it is read, seconds after the reference had it; along the
  /// longest way, and no further back than the polynomials' argument.
  double age(const std::string& reader, std::size_t input, int depth = 0) const {
    const ControllerCam* cam = out_.find(reader);
    const std::string& source = cam->inputs[input];
    const bool late = input < cam->late.size() && cam->late[input];
    const double half = 0.5 / cam->clock_a.value;
    double out = late ? half : 0.0;
    if (source == out_.drive || depth > kMostDepth) return out;
    return out + age_of(source, *cam, late, depth);
  }

 private:
  static constexpr int kMostDepth = 64;

  double age_of(const std::string& source, const ControllerCam& reader, bool late, int depth) const {
    double oldest = 0.0;
    if (const ControllerCam* from = out_.find(source)) {
      for (std::size_t i = 0; i < from->inputs.size(); ++i) {
        if (from->inputs[i] == "SlopeGain" || from->cam == &comparator_cam()) continue;
        oldest = std::max(oldest, age(source, i, depth + 1));
      }
      const double cycle = 1.0 / from->clock_a.value;
      oldest += from->delay_cycles * cycle;
      // It waits for the reader's edge where it changes in the other phase.
      if (from->clock_a == reader.clock_a) {
        const auto changes = nearest_whole<long>(2.0 * from->delay_cycles) + from->phase - 1;
        const long reads = reader.phase - 1 + (late ? 1 : 0);
        if ((changes - reads) % 2 != 0) oldest += 0.5 * cycle;
      }
      return oldest;
    }
    if (const OutsidePart* part = out_.find_outside(source)) {
      for (const std::string& input : part->inputs) {
        if (input != out_.drive) oldest = std::max(oldest, age_of(input, reader, late, depth + 1));
      }
    }
    return oldest;
  }

  ControllerVariant& out_;
  ControllerBranches branches_;
  const BranchPlans& compensators_;
  const ControllerOptions& options_;
  const Board& board_;
  int group_ = 0;
};

/// What the loop needs to settle: |K d'| below 1.
std::optional<Refusal> check_contraction(ControllerStructure structure, const DriveRange& range) {
  if (structure != ControllerStructure::loop || range.contraction.factor < 1.0) return std::nullopt;
  const Contraction& c = range.contraction;
  return Refusal{fmt::format(
      "the loop v = r - K d(v) does not settle: |K d'| is {} at x = {} of the {} branch (rate gain {}), expected "
      "below 1; a disturbance {} times as large would do, or the structure two-pass, which has no loop",
      rounded_text(c.factor, 3), rounded_text(c.x, 3),
      c.branch == Direction::ascending ? "ascending" : "descending", rounded_text(c.gain, 3),
      rounded_text(std::floor(99.0 / c.factor) / 100.0, 3))};
}

}  // namespace

ControllerVariant laid_out(PolynomialBy by, ControllerStructure structure, const Disturbance& disturbance,
                           const BranchPlans& compensators, const ControllerOptions& options) {
  const Board& board = board_by_name(options.board);
  ControllerVariant out;
  out.by = by;
  out.structure = structure;
  out.board = board.name;
  const DriveRange range = drive_range(disturbance, compensators);
  out.contraction = range.contraction.factor;
  out.scale = volt_scale(range, by != PolynomialBy::outside);
  const double cycles = polynomial_cycles(by);
  out.bandwidth_hz = cycles == 0.0 ? schematic::MultiplierModel().bandwidth.value
                                   : options.fast_clock.value / (kPeriodsOfDelay * cycles);
  out.refusal = check_contraction(structure, range);
  if (!out.fits()) return out;

  ControllerLayout layout(out, disturbance, compensators, options);
  try {
    layout.collect();
    layout.place();
    check_controller_io(out);
  } catch (const DesignError& refused) {
    out.refusal = Refusal{refused.what()};
  }
  for (const ControllerCam& cam : out.cams) {
    out.resources += cam.resources;
    out.chips = std::max(out.chips, cam.chip);
  }
  if (out.fits()) {
    out.delay_s = layout.age(out.drive, 0) + 0.5 / options.fast_clock.value;
    set_polynomial_error(out, disturbance);
  }
  return out;
}

}  // namespace bodesmith::fpaa
