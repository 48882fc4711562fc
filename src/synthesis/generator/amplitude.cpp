#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/build.hpp"

namespace bodesmith::generator {
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

/// A bend takes a resistor of at most so many times the rectifier's own.
constexpr double kLeastAlpha = 0.01;

class Amplitude : private synthesis::NetlistMaker {
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
    const double feedback = options_.resistors.nearest_above(wanted);
    group = layout_.part(layout_.output_feedback).group;
    out_.output_feedback = resistor("Rga", "amplitude: output amplifier, feedback in place of Rg", "mo",
                                    "out", feedback, feedback);
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
      r.node = fmt::format("k{}", out_.rectifiers.size() + 1);
      r.wanted = out_.alpha[k];
      if (r.wanted < kLeastAlpha) {
        throw DesignError(
            fmt::format("the amplitude {} of the gain table is too small to be made, expected "
                        "at least {}",
                        rounded_text(r.wanted), rounded_text(kLeastAlpha)));
      }
      group = new_group("alpha_k = " + rounded_text(r.wanted, 6));
      const auto made = rectifier(r.node, "amplitude: bend at " + rounded_text(r.wanted), "amplitude", "vr",
                                  1.0 / r.wanted);
      r.realised = 1.0 / made.ratio;
      r.opamp = made.opamp;
      place_.push_back(k);
      out_.rectifiers.push_back(std::move(r));
    }
  }

  /// kappa g of the rectifiers, which make -max(0, alpha - alpha_k), and of -1 V.
  void control(std::size_t b) {
    const std::string number = fmt::format("{}", b + 1),
                      what = "amplitude: control voltage, " + layout_.branches[b].name;
    const double kappa = out_.control_scale_v;
    std::vector<std::string> from = {"vr"};
    std::vector<double> gains = {-kappa * bends_[b].base};
    for (std::size_t i = 0; i < out_.rectifiers.size(); ++i) {
      from.push_back(out_.rectifiers[i].node);
      gains.push_back(-kappa * bends_[b].change[place_[i]]);
    }
    std::vector<std::vector<double>> rows;
    double top = 0.0;
    for (int i = 0; i <= 200; ++i) {
      const double alpha = i / 200.0 * std::max(1.0, out_.alpha.back());
      std::vector<double> row = {-1.0};
      for (const AmplitudeControl::Rectifier& one : out_.rectifiers)
        row.push_back(-std::max(0.0, alpha - one.realised));
      row.push_back(kappa * out_.wanted_gain(b, alpha));
      top = std::max(top, std::abs(row.back()));
      rows.push_back(std::move(row));
    }
    group = new_group(what);
    out_.controls.push_back({signed_sum(from, gains, rows, what, "c" + number, "n" + number), top});
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

}  // namespace bodesmith::generator
