#include "fpaa/controller.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/controller_layout.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr PolynomialBy kPolynomialWays[] = {PolynomialBy::outside, PolynomialBy::multipliers,
                                            PolynomialBy::lookup};

/// The index of the most accurate variant that fits, of those that may be taken.
std::optional<std::size_t> most_accurate(const std::vector<ControllerVariant>& variants,
                                         std::optional<PolynomialBy> only) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const ControllerVariant& v = variants[i];
    if (!v.fits() || (only && v.by != *only)) continue;
    if (!best || v.max_error_percent < variants[*best].max_error_percent) best = i;
  }
  return best;
}

/// Why nothing was chosen: what each way lacks.
Refusal why_none(const std::vector<ControllerVariant>& variants, std::optional<PolynomialBy> only) {
  std::vector<std::string> reasons;
  for (const ControllerVariant& v : variants) {
    if (v.fits()) continue;
    if (only && v.by == *only) return *v.refusal;
    reasons.push_back(fmt::format("{}: {}", to_string(v.by), v.refusal->reason));
  }
  return {"no way of making the polynomials fits the board: " + join(reasons, "; ")};
}

std::string why_chosen(const Controller& controller, bool asked_for) {
  const ControllerVariant& best = controller.best();
  if (asked_for) return fmt::format("'{}' was asked for", to_string(best.by));
  std::vector<std::string> others;
  for (const ControllerVariant& v : controller.variants) {
    if (v.by == best.by) continue;
    others.push_back(
        v.fits() ? fmt::format("'{}' is off by {} %", to_string(v.by), rounded_text(v.max_error_percent, 2))
                 : fmt::format("'{}' does not fit", to_string(v.by)));
  }
  return fmt::format("'{}' has the least worst error of those that fit: {} % of the stroke ({})",
                     to_string(best.by), rounded_text(best.max_error_percent, 2), join(others, ", "));
}

std::vector<std::string> controller_assumptions(const ControllerOptions& options) {
  return {
      "The amplitude gain is a Multiplier CAM with a control voltage: the numbers of GainVoltageControlled "
      "are not publicly known.",
      "GainSwitch is given a CAB of its own: its capacitor count is not publicly known.",
      "The slope's sign comes from outside (the reference generator knows it): the Differentiator's numbers "
      "are not publicly known.",
      fmt::format("Each AD835 is taken to be off by {} % of its full scale after trimming; measure yours.",
                  rounded_text(options.outside_error_percent)),
      "I/O cells are counted as one a signal; which pins of the chips the board connects is left to the "
      "wiring."};
}

}  // namespace

const char* to_string(PolynomialBy by) {
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

Outcome<Controller> make_controller(const Disturbance& disturbance, const Plan* ascending,
                                    const Plan* descending, const ControllerOptions& options) {
  const Outcome<const Board*> known_board = find_board(options.board);
  if (const Refusal* refusal = refusal_of(known_board)) return *refusal;
  const Board& board = *std::get<const Board*>(known_board);
  if (!find_clock(board, options.fast_clock)) {
    return Refusal{fmt::format("a fast clock of {} Hz is not in the tree, the nearest is {} Hz",
                               number_text(options.fast_clock.value),
                               number_text(nearest_clock(board, options.fast_clock).frequency.value))};
  }
  Controller out;
  for (const PolynomialBy by : kPolynomialWays) {
    out.variants.push_back(laid_out(by, disturbance, ascending, descending, options));
  }
  const auto chosen = most_accurate(out.variants, options.polynomial);
  if (!chosen) return why_none(out.variants, options.polynomial);
  out.chosen = *chosen;
  out.why = why_chosen(out, options.polynomial.has_value());
  out.assumptions = controller_assumptions(options);
  return out;
}

}  // namespace bodesmith::fpaa
