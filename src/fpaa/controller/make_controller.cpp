#include "fpaa/controller/controller.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "fpaa/controller/branches.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr ControllerStructure kStructures[] = {ControllerStructure::loop, ControllerStructure::two_pass,
                                               ControllerStructure::delayed, ControllerStructure::open};

bool may_be_taken(const ControllerVariant& v, const ControllerOptions& options) {
  return (!options.polynomial || v.by == *options.polynomial) &&
         (!options.structure || v.structure == *options.structure);
}

/// The index of the first structure that works, with the most accurate polynomials of those that fit.
std::optional<std::size_t> most_accurate(const std::vector<ControllerVariant>& variants,
                                         const ControllerOptions& options) {
  for (const ControllerStructure structure : kStructures) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < variants.size(); ++i) {
      const ControllerVariant& v = variants[i];
      if (v.structure != structure || !v.fits() || !may_be_taken(v, options)) continue;
      if (!best || v.max_error_percent < variants[*best].max_error_percent) best = i;
    }
    if (best) return best;
  }
  return std::nullopt;
}

/// Why nothing was chosen: what each way lacks, or the one reason that they share.
Refusal why_none(const std::vector<ControllerVariant>& variants, const ControllerOptions& options) {
  std::vector<std::string> reasons;
  std::vector<std::string> names;
  for (const ControllerVariant& v : variants) {
    if (v.fits() || !may_be_taken(v, options)) continue;
    if (std::ranges::find(reasons, v.refusal->reason) != reasons.end()) continue;
    names.push_back(v.name());
    reasons.push_back(v.refusal->reason);
  }
  if (reasons.size() == 1) return {reasons.front()};
  for (std::size_t i = 0; i < reasons.size(); ++i) reasons[i] = fmt::format("{}: {}", names[i], reasons[i]);
  return {"no way of making the controller fits the board: " + join(reasons, "; ")};
}

std::string why_chosen(const Controller& controller, const ControllerOptions& options) {
  const ControllerVariant& best = controller.best();
  if (options.polynomial && options.structure) return fmt::format("'{}' was asked for", best.name());
  std::vector<std::string> others;
  for (const ControllerVariant& v : controller.variants) {
    if (v.by == best.by || v.structure != best.structure) continue;
    others.push_back(
        v.fits() ? fmt::format("'{}' is off by {} %", to_string(v.by), rounded_text(v.max_error_percent, 2))
                 : fmt::format("'{}' does not fit", to_string(v.by)));
  }
  return fmt::format("'{}' has the least worst error of those that fit: {} % of the stroke ({})", best.name(),
                     rounded_text(best.max_error_percent, 2), join(others, ", "));
}

std::vector<std::string> controller_assumptions(const ControllerOptions& options) {
  return {
      "The switched bytes of Multiplier, Comparator and GainSwitch are not publicly known: these CAMs are placed in "
      "the vendor's tool by the build sheet; their capacitors and clocks can be set by update streams. Those of "
      "TransferFunction are copied from public streams, its converter without being understood.",
      "TransferFunction and Multiplier are taken to show each result for a whole cycle, one cycle late; GainSwitch "
      "likewise, signal and control alike.",
      "GainSwitch is given a CAB of its own: its capacitor count is not publicly known.",
      "An amplitude gain is a Multiplier CAM with a control voltage: the numbers of GainVoltageControlled "
      "are not publicly known.",
      "The slope detector's high pass is the pole-zero stage without its Ca branch.",
      fmt::format(
          "Each AD835 with its scaling is taken to have a gain error of {} % after trimming; measure yours.",
          rounded_text(options.outside_error_percent)),
      "The chips' clocks have their edges at the same time (one master clock, one release of reset): chips that are "
      "not aligned add up to one clock period a crossing.",
      "Op-amps settle within half a clock period and have no offset: their figures are not publicly known.",
      "I/O cells are counted as one a signal; which pins of the chips the board connects is left to the "
      "wiring."};
}

}  // namespace

const char* to_string(PolynomialBy by) {
  static constexpr const char* kNames[] = {"outside", "multipliers", "lookup"};
  return kNames[static_cast<std::size_t>(by)];
}

const char* to_string(ControllerStructure structure) {
  static constexpr const char* kNames[] = {"loop", "two-pass", "delayed", "open"};
  return kNames[static_cast<std::size_t>(structure)];
}

const char* equation(ControllerStructure structure) {
  static constexpr const char* kNames[] = {"v = r - K d(v)", "v = r - K d(r - K d(r)), reference delayed",
                                           "v = r - K d(r), reference delayed", "v = r - K d(r)"};
  return kNames[static_cast<std::size_t>(structure)];
}

std::string ControllerVariant::name() const {
  return fmt::format("{}, {}", to_string(by), to_string(structure));
}

int ControllerVariant::outside_multipliers() const {
  return static_cast<int>(std::ranges::count_if(
      outside, [](const OutsidePart& p) { return p.kind == OutsidePart::Kind::multiplier; }));
}

ControllerVariant ControllerVariant::at(const Disturbance& disturbance, Hertz operating) const {
  ControllerVariant out = *this;
  for (ControllerCam& cam : out.cams) {
    if (!cam.scheduled) continue;
    set_weights(cam, disturbance.rate_gain(*cam.scheduled, operating));
  }
  return out;
}

const ControllerCam* ControllerVariant::find(std::string_view cam) const {
  const auto at = std::ranges::find(cams, cam, &ControllerCam::name);
  return at == cams.end() ? nullptr : &*at;
}

const OutsidePart* ControllerVariant::find_outside(std::string_view part) const {
  const auto at = std::ranges::find(outside, part, &OutsidePart::name);
  return at == outside.end() ? nullptr : &*at;
}

Outcome<Controller> make_controller(const Disturbance& disturbance, const BranchPlans& compensators,
                                    const ControllerOptions& options) {
  const Outcome<const Board*> known_board = find_board(options.board);
  if (const Refusal* refusal = refusal_of(known_board)) return *refusal;
  const Board& board = *std::get<const Board*>(known_board);
  if (!find_clock(board, options.fast_clock)) {
    return Refusal{fmt::format("a fast clock of {} Hz is not in the tree, the nearest is {} Hz",
                               number_text(options.fast_clock.value),
                               number_text(nearest_clock(board, options.fast_clock).frequency.value))};
  }
  Controller out;
  for (const PolynomialBy by : {PolynomialBy::outside, PolynomialBy::multipliers, PolynomialBy::lookup}) {
    for (const ControllerStructure structure : kStructures) {
      out.variants.push_back(laid_out(by, structure, disturbance, compensators, options));
    }
  }
  const auto chosen = most_accurate(out.variants, options);
  if (!chosen) return why_none(out.variants, options);
  out.chosen = *chosen;
  out.why = why_chosen(out, options);
  out.assumptions = controller_assumptions(options);
  return out;
}

}  // namespace bodesmith::fpaa
