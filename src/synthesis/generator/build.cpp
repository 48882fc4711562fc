#include "synthesis/generator/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/opamp_library.hpp"
#include "synthesis/generator/at_rest.hpp"

namespace bodesmith::generator {
namespace {

constexpr int kPoints = 2000;
/// The least stroke lies so far below the table's that no resistor of its divider raises it above.
constexpr double kBelow = 0.98;
/// Of the output amplifier's gain, V per unit of d.
constexpr double kGreatestScale = 50.0;

std::vector<std::string> names_of(const Input& input) {
  std::vector<std::string> out;
  for (const Polynomial& one : input.branches) out.push_back(one.name);
  return out;
}

}  // namespace

Options::Options(Form which) : form(which), fast_opamp(schematic::OpAmpLibrary::built_in().named("AD8066")) {
  if (form != Form::open) opamp = schematic::OpAmpLibrary::built_in().named("OPA2140");
}

Builder::Builder(const Input& input, const Options& options, int size, const Disturbance& disturbance)
    : GeneratorMaker(out_, options_.resistors, options_.capacitors, names_of(input)),
      input_(input),
      options_(options),
      size_(size) {
  out_.form = options.form;
  out_.disturbance = disturbance;
  out_.tolerances = options.tolerances;
  out_.multiplier = options.multiplier;
  out_.opamp = options.opamp;
  out_.other_opamps = {options.fast_opamp};
  out_.analog_switch = options.analog_switch.value_or(SwitchModel::for_branches(input.branches.size()));
  out_.group = size;
  for (const Polynomial& one : input.branches)
    out_.branches.push_back({one.name, one.coefficients, {}, {}, 1.0, 1.0, {}, {}, 0.0, 0.0});
  if (is_open()) {
    if (!input.alpha.empty()) out_.amplitude.emplace().alpha = input.alpha;
    return;
  }
  out_.tracked = options.tracked;
  out_.reference_stroke = options.reference_stroke;
  out_.rates = options.rates;
  if (!disturbance.amplitude.alpha.empty() && !options.full_stroke) {
    out_.stroke = DisturbanceCircuit::Stroke{};
    out_.stroke->least = kBelow * strokes().front();
    out_.reference_stroke = 1.0;  // the slope is that of the reference over its stroke
  }
}

/// Greatest or least rate gain of a branch; 1 without them.
double Builder::gain_limit(std::size_t b, bool greatest) const {
  if (is_open() || !options_.rates) return 1.0;
  const std::vector<double>& k = out_.disturbance.rate.of(kBranches[b]);
  if (k.empty()) return 1.0;
  return greatest ? *std::ranges::max_element(k) : *std::ranges::min_element(k);
}

std::vector<BranchGain*> Builder::gains(BranchGain Branch::*which) {
  std::vector<BranchGain*> out;
  for (Branch& one : out_.branches) out.push_back(&(one.*which));
  return out;
}

void Builder::check_gains() {
  const auto check = [&](const Branch& b, const char* what, double least, double most, BranchGain& gain) {
    gain = BranchGain::between(least, most, out_.multiplier);
    if (gain.direct == 1.0 || is_open()) return std::max(std::abs(least), std::abs(most));
    throw DesignError(fmt::format(
        "the {} gains of the {} branch lie between {} and {}, expected above 0 and so near to each other that the {}'s {} "
        "V are enough to change them",
        what, b.name, rounded_text(least), rounded_text(most), out_.multiplier.name,
        rounded_text(out_.multiplier.greatest_input_v)));
  };
  for (std::size_t b = 0; b < out_.branches.size(); ++b) {
    Branch& one = out_.branches[b];
    one.greatest_rate = check(one, "rate", gain_limit(b, false), gain_limit(b, true), one.rate);
    if (!out_.stroke && !out_.amplitude) continue;
    const std::vector<double> gains = stroke_gains(b);
    const auto [least, most] = std::minmax_element(gains.begin(), gains.end());
    one.greatest_amplitude = check(one, "amplitude", *least, *most, one.amplitude);
  }
}

/// Follows w + K g(alpha)/alpha d(w) = r/alpha, w = v/alpha, from 0 to 1 for the rate gains' ends and every stroke of the table:
/// the stage must have an inverse there.
void Builder::check_polynomials() {
  LoopFigures& loop = out_.loop;
  loop.least_slope = 1.0;
  for (std::size_t b = 0; b < 2; ++b) {
    for (const double alpha : strokes()) {
      for (const bool greatest : {false, true}) {
        const double k = gain_limit(b, greatest) * out_.amplitude_gain(kBranches[b], alpha) / alpha;
        double w = 0.0, r = 0.0;
        for (int i = 0; i < 64 * kPoints && r < 1.0; ++i) {
          const double gain = k * out_.disturbance.slope(kBranches[b], w);
          if (!(std::abs(gain) < 1.0)) {
            throw DesignError(fmt::format(
                "|K d'| of the {} branch is {} at v = {}{}, expected below 1: v = r - K d(v) cannot converge",
                name(b), rounded_text(std::abs(gain)), rounded_text(alpha * w, 3),
                out_.stroke ? fmt::format(" of a stroke of {}", rounded_text(alpha, 3)) : ""));
          }
          loop.greatest_gain = std::max(loop.greatest_gain, std::abs(gain));
          loop.least_slope = std::min(loop.least_slope, 1.0 + gain);
          loop.greatest_drive = std::max(loop.greatest_drive, w);
          w += 1.0 / kPoints;
          r = w + k * out_.disturbance.value(kBranches[b], w);
        }
      }
    }
  }
  const double supply = 0.95 * out_.opamp.swing_v;
  if (loop.greatest_drive > supply) {
    throw DesignError(fmt::format("the drive would reach {} V, beyond the {}'s {} V",
                                  rounded_text(loop.greatest_drive), out_.opamp.name, rounded_text(supply)));
  }
}

/// V per unit of K d at the switch: the greater branch uses the multipliers' range.
void Builder::scale_branches() {
  double greatest = 0.0;
  for (std::size_t b = 0; b < out_.branches.size(); ++b) {
    const Branch& one = out_.branches[b];
    greatest = std::max(greatest, one.greatest_rate * one.greatest_amplitude * peak_of(b));
  }
  if (!(greatest > 1e-4)) {
    throw DesignError(
        fmt::format("the disturbance is at most {} of the range: there is nothing to compensate",
                    rounded_text(greatest)));
  }
  out_.branch_gain = std::min(kRoom * out_.multiplier.greatest_input_v / greatest, kGreatestScale);
}

void Builder::warn_above(const std::string& name, double peak_v, const char* note) {
  if (peak_v > options_.full_scale_v * (1.0 + 1e-9)) {
    out_.warnings.push_back(fmt::format("{} reaches {} V, above the full scale of {} V{}", name,
                                        rounded_text(peak_v), rounded_text(options_.full_scale_v), note));
  }
}

/// Output amplifier: -(Rg/(Rin + Ron)), its gain such that the greatest node of the branches uses the full
/// scale.
void Builder::scale_branches_open() {
  double greatest = 0.0, most = 0.0;
  for (const Branch& b : out_.branches) {
    const double end = b.greatest_amplitude * peak(b.wanted);
    greatest = std::max({greatest, b.amplitude.at_rest * greatest_inside(b.wanted), end});
    most = std::max(most, end);
  }
  const double swing = 0.95 * options_.opamp.swing_v;
  if (most > swing) {
    throw DesignError(
        fmt::format("d(x) reaches {} and 1 V stands for d = 1: the output amplifier ends at {} V",
                    rounded_text(most), rounded_text(swing)));
  }
  warn_above("out", most, " (1 V is d = 1)");
  const double asked =
      greatest > 0.0 ? std::min(kRoom * options_.full_scale_v / greatest, kGreatestScale) : 1.0;
  const double on = out_.switched() ? out_.analog_switch.on_ohm : 0.0;
  input_ohm_ = options_.resistors.nearest(20e3);
  // Never above full scale: the next value up lowers the gain.
  feedback_ohm_ = options_.resistors.nearest_above((input_ohm_ + on) / asked);
  if (feedback_ohm_ > 10e6) {
    throw DesignError(
        fmt::format("the coefficients need nodes of {} V per volt of output, more than resistors up to 10 "
                    "Mohm can scale",
                    rounded_text(greatest)));
  }
  out_.branch_gain = (input_ohm_ + on) / feedback_ohm_;
}

DisturbanceCircuit Builder::build() {
  check_gains();
  if (is_open()) {
    if (out_.amplitude) amplitude_gains();
    pass("x", "out", 1);
    if (out_.switched()) {
      branch_switch();
      slope_sign("x", 1.0, options_.lowest);
      out_.comparators.push_back({group, "so", "branch"});
    }
    arrange(out_);
    return std::move(out_);
  }
  check_polynomials();
  scale_branches();
  const double swing = std::min(options_.least_swing, options_.reference_stroke);
  slope_sign("r", out_.stroke ? std::min(out_.stroke->least, swing) : swing, options_.lowest);
  if (out_.stroke) stroke_hold();
  rate_gains();
  if (out_.stroke) amplitude_gains();
  if (out_.form == Form::self_fed) {
    pass("v", "v", 1);
  } else {
    pass("r", out_.form == Form::two_pass ? "w" : "v", 1);
    if (out_.form == Form::two_pass) pass("w", "v", 2);
  }
  const std::size_t levels = add_group("levels of the switch's control", Purpose::branch_switch);
  out_.comparators = {{levels, "so", "up"}};
  out_.gates = {{levels, "down", {}, {"up"}}};
  arrange(out_);
  out_.max_error_percent = generator_error_percent(out_);
  return std::move(out_);
}

namespace {

/// With a gain curve as near to its table as is asked, or, of these doublings, the nearest that resistors make.
DisturbanceCircuit build_controller(const Disturbance& disturbance, Options options) {
  constexpr double kMostPercent = 1.0;  // of range: about what a stage is off without any rate gains
  const double asked = options.rate_tolerance_percent;
  for (;; options.rate_tolerance_percent *= 2.0) {
    try {
      DisturbanceCircuit out = Builder(Input::of(disturbance), options,
                                       static_cast<int>(disturbance.ascending.size()), disturbance)
                                   .build();
      if (options.rate_tolerance_percent > asked)
        out.warnings.push_back(fmt::format(
            "The table's gains change so steeply that no resistors make a curve within {} % of range of it: it follows within {} %",
            rounded_text(asked), rounded_text(options.rate_tolerance_percent)));
      return out;
    } catch (const TooSteep&) {
      if (2.0 * options.rate_tolerance_percent > kMostPercent) throw;
    }
  }
}

}  // namespace

DisturbanceCircuit make_controller(const Disturbance& disturbance, const Options& options) {
  DisturbanceCircuit out = build_controller(disturbance, options);
  if (!disturbance.amplitude.alpha.empty() && !out.stroke)
    out.warnings.push_back("for full strokes only: the disturbance's amplitude gains are not built");
  return out;
}

}  // namespace bodesmith::generator
