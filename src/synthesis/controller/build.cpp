#include "synthesis/controller/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/opamp_library.hpp"
#include "synthesis/controller/at_rest.hpp"

namespace bodesmith::controller {
namespace {

constexpr int kPoints = 2000;
/// The least stroke lies so far below the table's that no resistor of its divider raises it above.
constexpr double kBelow = 0.98;

}  // namespace

Options::Options()
    : opamp(schematic::OpAmpLibrary::built_in().named("OPA2140")),
      fast_opamp(schematic::OpAmpLibrary::built_in().named("AD8066")) {}

std::string_view to_string(Form form) {
  constexpr std::array kWords = {"seed", "two-pass", "self-fed"};
  return kWords.at(static_cast<std::size_t>(form));
}

Form form_named(const std::string& name) {
  if (name == "seed" || name == "one-pass") return Form::one_pass;
  if (name == "two-pass") return Form::two_pass;
  if (name == "self-fed") return Form::self_fed;
  throw InputError(fmt::format("unknown form \"{}\", expected seed, two-pass or self-fed", name));
}

double AnalogController::rated_gain(Disturbance::Branch which, Hertz frequency) const {
  return rates ? disturbance.rate_gain(which, frequency) : 1.0;
}

double AnalogController::amplitude_gain(Disturbance::Branch which, double alpha) const {
  return stroke ? disturbance.amplitude.at(which, alpha) : 1.0;
}

Builder::Builder(const Disturbance& disturbance, const Options& options)
    : GeneratorMaker(out_, options_.resistors, options_.capacitors, {"ascending", "descending"}),
      disturbance_(disturbance),
      options_(options) {
  out_.form = options.form;
  out_.disturbance = disturbance;
  out_.multiplier = options.multiplier;
  out_.opamp = options.opamp;
  out_.fast_opamp = options.fast_opamp;
  out_.analog_switch = options.analog_switch;
  out_.tracked = options.tracked;
  out_.reference_stroke = options.reference_stroke;
  out_.rates = options.rates;
  if (!disturbance.amplitude.alpha.empty() && !options.full_stroke) {
    out_.stroke = AnalogController::Stroke{};
    out_.stroke->least = kBelow * strokes().front();
    out_.reference_stroke = 1.0;  // the slope is that of the reference over its stroke
  }
}

/// Greatest or least rate gain of a branch; 1 without them.
double Builder::gain_limit(std::size_t b, bool greatest) const {
  const std::vector<double>& k = disturbance_.rate.of(kBranches[b]);
  if (!options_.rates || k.empty()) return 1.0;
  return greatest ? *std::max_element(k.begin(), k.end()) : *std::min_element(k.begin(), k.end());
}

void Builder::check_gains() {
  const auto check = [&](std::size_t b, const char* what, double least, double most, BranchGain& gain) {
    gain = BranchGain::between(least, most, out_.multiplier);
    if (gain.direct == 1.0) return most;
    throw DesignError(fmt::format(
        "the {} gains of the {} branch lie between {} and {}, expected above 0 and so near to each other that the {}'s {} "
        "V are enough to change them",
        what, name(b), rounded_text(least), rounded_text(most), out_.multiplier.name,
        rounded_text(out_.multiplier.greatest_input_v)));
  };
  for (std::size_t b = 0; b < 2; ++b) {
    greatest_gain_[b] = check(b, "rate", gain_limit(b, false), gain_limit(b, true), out_.rate[b]);
    if (!out_.stroke) continue;
    const std::vector<double> gains = stroke_gains(b);
    const auto [least, most] = std::minmax_element(gains.begin(), gains.end());
    greatest_amplitude_[b] = check(b, "amplitude", *least, *most, out_.amplitude[b]);
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
          const double gain = k * disturbance_.slope(kBranches[b], w);
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
          r = w + k * disturbance_.value(kBranches[b], w);
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

AnalogController Builder::build() {
  check_gains();
  check_polynomials();
  scale_branches();
  const double swing = std::min(options_.least_swing, options_.reference_stroke);
  slope_sign("r", out_.stroke ? std::min(out_.stroke->least, swing) : swing, options_.lowest);
  if (out_.stroke) stroke_hold();
  rate_gains();
  if (out_.stroke) amplitude_gains();
  switch (out_.form) {
    case Form::one_pass:
      pass("r", "v", 1);
      break;
    case Form::two_pass:
      pass("r", "w", 1);
      pass("w", "v", 2);
      break;
    case Form::self_fed:
      pass("v", "v", 1);
      break;
  }
  const std::size_t levels = add_group("levels of the switch's control", Purpose::branch_switch);
  out_.comparators = {{levels, "so", "up"}};
  out_.gates = {{levels, "down", {}, {"up"}}};
  generator::arrange(out_);
  out_.max_error_percent = generator_error_percent(out_);
  return std::move(out_);
}

AnalogController make_controller(const Disturbance& disturbance, const Options& options) {
  AnalogController out = Builder(disturbance, options).build();
  if (!disturbance.amplitude.alpha.empty() && !out.stroke)
    out.warnings.push_back("for full strokes only: the disturbance's amplitude gains are not built");
  return out;
}

}  // namespace bodesmith::controller
