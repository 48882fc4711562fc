#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/build.hpp"

namespace bodesmith::multiplier_layout {
namespace {

/// g(alpha) = base + sum change_k max(0, alpha - at_k)
struct Bends {
  double base = 1.0;
  std::vector<double> change;  ///< one for each place of the table
};

Bends bends_of(const std::vector<double>& alpha, const std::vector<double>& gain) {
  Bends out;
  out.base = gain.front();
  double before = 0.0;
  for (size_t k = 0; k < alpha.size(); ++k) {
    const double after = k + 1 < alpha.size() ? (gain[k + 1] - gain[k]) / (alpha[k + 1] - alpha[k]) : 0.0;
    // Full stroke is the end of the pin's range: nothing to bend there.
    out.change.push_back(alpha[k] >= 1.0 ? 0.0 : after - before);
    before = after;
  }
  return out;
}

/// One term of a control voltage: what its node makes per volt of weight, and the weight wanted.
struct Term {
  std::string node, role;
  double weight = 0.0;  ///< of either sign
  std::function<double(double)> ramp;
};

/// Resistors F/R_k, all with one F, nearest in the series so that the greatest error over alpha is least.
struct Weights {
  double feedback = 0.0;
  std::vector<double> ohm;
  double error = 0.0;
};

Weights search(const std::vector<Term>& terms, const std::vector<double>& grid,
               const std::vector<double>& wanted, const circuit::Series& series) {
  double largest = 0.0;
  for (const Term& term : terms) largest = std::max(largest, std::abs(term.weight));
  std::vector<std::vector<double>> ramps;
  for (const Term& term : terms) {
    ramps.emplace_back();
    for (const double alpha : grid) ramps.back().push_back(term.ramp(alpha));
  }
  const auto error_of = [&](const Weights& w) {
    double worst = 0.0;
    for (size_t i = 0; i < grid.size(); ++i) {
      double v = 0.0;
      for (size_t k = 0; k < terms.size(); ++k)
        v += std::copysign(w.feedback / w.ohm[k], terms[k].weight) * ramps[k][i];
      worst = std::max(worst, std::abs(v - wanted[i]));
    }
    return worst;
  };
  const double low = std::max(10e3, 2e3 * largest);
  const std::vector<double> candidates =
      series.is_exact() ? std::vector<double>{low} : series.values(low, 10.0 * low);
  Weights best;
  best.error = std::numeric_limits<double>::infinity();
  for (const double feedback : candidates) {
    Weights trial;
    trial.feedback = feedback;
    for (const Term& term : terms) trial.ohm.push_back(series.nearest(feedback / std::abs(term.weight)));
    trial.error = error_of(trial);
    if (trial.error < best.error) best = trial;
  }
  // One weight at a time, as long as it helps.
  for (bool better = true; better;) {
    better = false;
    for (size_t k = 0; k < terms.size(); ++k) {
      for (const double ohm : series.nearest(best.feedback / std::abs(terms[k].weight), 5)) {
        Weights trial = best;
        trial.ohm[k] = ohm;
        trial.error = error_of(trial);
        if (trial.error < best.error * (1.0 - 1e-9)) {
          best = trial;
          better = true;
        }
      }
    }
  }
  return best;
}

class Amplitude : private circuit::NetlistMaker {
 public:
  Amplitude(Layout& layout, const Input& input, const Options& options)
      : NetlistMaker(layout, options.resistors, capacitors()),
        layout_(layout),
        input_(input),
        options_(options) {}

  void add() {
    out_.alpha = input_.alpha;
    for (const Polynomial& one : input_.branches) {
      out_.wanted.push_back(one.amplitude.empty() ? std::vector<double>(input_.alpha.size(), 1.0)
                                                  : one.amplitude);
      bends_.push_back(bends_of(out_.alpha, out_.wanted.back()));
    }
    output();
    rectifiers();
    for (size_t b = 0; b < layout_.branches.size(); ++b) control(b);
    gains();
    check_outputs(layout_);
    arrange(layout_);
    layout_.amplitude = std::move(out_);
    check();
  }

 private:
  std::size_t new_group(std::string title) {
    return add_group(std::move(title), schematic::Purpose::amplitude);
  }
  int resistor(std::string name, const std::string& role, std::string from, std::string to, double wanted,
               double realised) {
    return NetlistMaker::resistor(std::move(name), "amplitude: " + role, std::move(from), std::move(to),
                                  wanted, realised);
  }

  /// The output amplifier also takes back what the control voltage and U scale: Rg = (Rin + Ron)
  /// U/(branch_gain control_scale).
  void output() {
    double greatest = 0.0;
    for (const std::vector<double>& gains : out_.wanted) {
      for (const double g : gains) greatest = std::max(greatest, std::abs(g));
    }
    if (!(greatest > 0.0)) throw DesignError("all amplitude gains are 0, expected at least one other");
    const double input = layout_.branch_gain * layout_.part(layout_.output_feedback).realised;
    const double wanted = input * layout_.multiplier.scale_v / layout_.branch_gain * greatest /
                          (kRoom * std::min(options_.full_scale_v, layout_.multiplier.greatest_input_v));
    // The next value up makes the control voltage smaller, not larger.
    double feedback = wanted;
    for (const double r : options_.resistors.values(wanted, 2.5 * wanted)) {
      feedback = r;
      break;
    }
    group = layout_.part(layout_.output_feedback).group;
    out_.output_feedback =
        resistor("Rga", "output amplifier, feedback in place of Rg", "mo", "out", feedback, feedback);
    out_.control_scale_v = input * layout_.multiplier.scale_v / (layout_.branch_gain * feedback);
  }

  void rectifiers() {
    const std::size_t first =
        new_group("gains over the amplitude: -max(0, alpha - alpha_k) by precision rectifiers");
    layout_.sources.push_back({"Vreference", "", "vr", -1.0, first});
    for (size_t k = 0; k < out_.alpha.size(); ++k) {
      double change = 0.0;
      for (const Bends& one : bends_) change = std::max(change, std::abs(one.change[k]));
      if (change * out_.control_scale_v < 1e-4) continue;
      AmplitudeControl::Rectifier r;
      const size_t number = out_.rectifiers.size() + 1;
      const std::string minus = fmt::format("km{}", number);
      r.node = fmt::format("r{}", number);
      r.wanted = out_.alpha[k];
      double input = 20e3, reference = options_.resistors.nearest(input / r.wanted);
      for (const double ohm : options_.resistors.values(10e3, 100e3)) {
        const double near = options_.resistors.nearest(ohm / r.wanted);
        if (std::abs(std::log(ohm / near / r.wanted)) <
            std::abs(std::log(input / reference / r.wanted)) - 1e-12) {
          input = ohm;
          reference = near;
        }
      }
      if (reference > 10e6) {
        throw DesignError(
            fmt::format("the amplitude {} of the gain table is too small to be made, expected "
                        "at least 0.01",
                        rounded_text(r.wanted)));
      }
      r.realised = input / reference;
      const std::string what = fmt::format("bend at {}", rounded_text(r.wanted)), end = "k" + r.node;
      group = new_group("alpha_k = " + rounded_text(r.realised, 6));
      const std::string part = fmt::format("Rk{}", number);
      resistor(part + "i", what + ", input", "amplitude", minus, input, input);
      resistor(part + "r", what + ", from -1 V", "vr", minus, input / r.wanted, reference);
      resistor(part + "f", what + ", feedback", minus, r.node, input, input);
      diode("D" + r.node + "a", "amplitude: " + what, r.node, end);
      diode("D" + r.node + "b", "amplitude: " + what, end, minus);
      r.opamp = opamp("amplitude: " + what, "0", minus, end, fmt::format("UK{}", number));
      place_.push_back(k);
      out_.rectifiers.push_back(std::move(r));
    }
  }

  /// What the rectifiers and the constant have to add up to.
  std::vector<Term> control_terms(std::size_t b) const {
    const double kappa = out_.control_scale_v;
    std::vector<Term> terms;
    if (bends_[b].base != 0.0)
      terms.push_back({"vr", "at rest", kappa * bends_[b].base, [](double) { return 1.0; }});
    for (std::size_t i = 0; i < out_.rectifiers.size(); ++i) {
      const double weight = kappa * bends_[b].change[place_[i]];
      if (std::abs(weight) < 1e-4) continue;
      const double at = out_.rectifiers[i].realised;
      terms.push_back({out_.rectifiers[i].node,
                       fmt::format("above {}", rounded_text(out_.rectifiers[i].wanted)), weight,
                       [at](double alpha) { return std::max(0.0, alpha - at); }});
    }
    return terms;
  }

  void control(std::size_t b) {
    const std::string number = fmt::format("{}", b + 1);
    const double kappa = out_.control_scale_v;
    const std::vector<Term> terms = control_terms(b);
    std::vector<double> grid, wanted;
    double top = 0.0;
    for (int i = 0; i <= 200; ++i) {
      grid.push_back(i / 200.0 * std::max(1.0, out_.alpha.back()));
      wanted.push_back(kappa * out_.wanted_gain(b, grid.back()));
      top = std::max(top, std::abs(wanted.back()));
    }
    const auto sum_group = [&](const std::string& what, const std::string& node) {
      return new_group(fmt::format("{}: {}", what, node));
    };
    const bool falls_somewhere =
        std::any_of(terms.begin(), terms.end(), [](const Term& one) { return one.weight < 0.0; });
    const std::string what = "control voltage, " + layout_.branches[b].name,
                      falling = "falling parts, " + layout_.branches[b].name;
    const std::size_t negative_group = falls_somewhere ? sum_group(falling, "n" + number) : 0,
                      own_group = sum_group(what, "c" + number);
    const Weights found =
        terms.empty() ? Weights{10e3, {}, 0.0} : search(terms, grid, wanted, options_.resistors);
    for (size_t k = 0; k < terms.size(); ++k) {
      const bool falls = terms[k].weight < 0.0;
      if (found.ohm[k] > 10e6 || found.ohm[k] < 1e3) {
        throw DesignError("the amplitude gains are too far apart for resistors of 1 kohm to 10 Mohm");
      }
      group = falls ? negative_group : own_group;
      resistor(fmt::format("R{}{}_{}", falls ? "n" : "c", number, k),
               fmt::format("{}, {}", terms[k].role, layout_.branches[b].name), terms[k].node,
               (falls ? "mn" : "mc") + number, found.feedback / std::abs(terms[k].weight), found.ohm[k]);
    }
    const auto finish = [&](std::size_t of, const std::string& role, const std::string& letter,
                            const char* name) {
      group = of;
      resistor(fmt::format("R{}{}_f", letter, number), "feedback, " + role, "m" + letter + number,
               letter + number, found.feedback, found.feedback);
      return opamp(role, "0", "m" + letter + number, letter + number, name + number);
    };
    if (falls_somewhere) {
      finish(negative_group, falling, "n", "UN");
      group = own_group;
      resistor(fmt::format("Rc{}_n", number), falling, "n" + number, "mc" + number, found.feedback,
               found.feedback);
    }
    out_.controls.push_back({finish(own_group, what, "c", "UC"), top});
  }

  void gains() {
    const std::size_t here = new_group("voltage-controlled gains");
    for (std::size_t b = 0; b < layout_.branches.size(); ++b) {
      const std::string number = fmt::format("{}", b + 1);
      out_.multipliers.push_back(static_cast<int>(layout_.multipliers.size()));
      layout_.multipliers.push_back(
          {"MV" + number, "voltage-controlled gain, " + layout_.branches[b].name, here,
           layout_.branches[b].out, "c" + number, "0", "v" + number,
           layout_.branches[b].peak_v * out_.controls[b].peak_v / layout_.multiplier.scale_v});
    }
  }

  /// The parts' error, at rest.
  void check() {
    const GeneratorAtRest generator(layout_, true);
    std::vector<double> x;
    for (int i = 0; i <= 50; ++i) x.push_back(i / 50.0);
    AmplitudeControl& a = *layout_.amplitude;
    for (size_t b = 0; b < layout_.branches.size(); ++b) {
      for (int i = 1; i <= 100; ++i) {
        const double alpha = i / 100.0 * std::max(1.0, a.alpha.back());
        const double gain = a.wanted_gain(b, alpha);
        const std::vector<double> d = generator.curve(b, x, alpha);
        for (size_t k = 0; k < x.size(); ++k) {
          a.max_error_percent =
              std::max(a.max_error_percent,
                       100.0 * std::abs(d[k] - gain * polynomial(layout_.branches[b].wanted, x[k])));
        }
      }
    }
  }

  Layout& layout_;
  const Input& input_;
  const Options& options_;
  AmplitudeControl out_;
  std::vector<Bends> bends_;
  std::vector<size_t> place_;  ///< in the table, one a rectifier
};

}  // namespace

void add_amplitude(Layout& layout, const Input& input, const Options& options) {
  Amplitude(layout, input, options).add();
}

}  // namespace bodesmith::multiplier_layout
