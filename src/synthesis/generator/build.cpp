#include "synthesis/generator/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/opamp_library.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::generator {
namespace {

using schematic::plain_number;
using schematic::Purpose;

const synthesis::Series& capacitors() {
  static const synthesis::Series series = synthesis::Series::named("E12");
  return series;
}

std::vector<std::string> names_of(const std::vector<Polynomial>& branches) {
  std::vector<std::string> out;
  for (const Polynomial& one : branches) out.push_back(one.name);
  return out;
}

class Builder : private GeneratorMaker {
 public:
  Builder(const Input& input, const Options& options, int size)
      : GeneratorMaker(out_, options.resistors, capacitors(), names_of(input.branches)),
        input_(input),
        options_(options),
        size_(size) {
    out_.multiplier = options.multiplier;
    out_.opamp = options.opamp;
    out_.fast_opamp = options.fast_opamp;
    out_.analog_switch = options.analog_switch.value_or(SwitchModel::for_branches(input.branches.size()));
    out_.group = size;
    out_.full_scale_v = options.full_scale_v;
  }

  Layout build() {
    if (!input_.alpha.empty()) amplitude_gains();
    powers();
    scale_branches();
    for (std::size_t b = 0; b < input_.branches.size(); ++b) branch(b);
    output();
    if (input_.branches.size() > 1) {
      branch_switch();
      slope_sign("x", 1.0, options_.lowest);
      out_.comparators.push_back({group, "so", "branch"});
    }
    arrange(out_);
    return std::move(out_);
  }

 private:
  /// Of a branch over the stroke: what its weights hold, and its greatest.
  double at_rest(std::size_t b) const { return out_.amplitude ? out_.amplitude->gains[b].at_rest : 1.0; }
  double greatest_gain(std::size_t b) const {
    if (!out_.amplitude) return 1.0;
    double out = 0.0;
    for (const double one : out_.amplitude->wanted[b]) out = std::max(out, std::abs(one));
    return out;
  }

  int groups(const std::vector<double>& a) const { return std::max(1, (degree(a) + size_ - 1) / size_); }

  /// a_{jg+1} …: coefficients of P_j.
  std::vector<double> group_coefficients(const std::vector<double>& a, int j) const {
    std::vector<double> out;
    for (int i = 0; i < size_; ++i) {
      const size_t k = static_cast<size_t>(j * size_ + i);
      out.push_back(k < a.size() ? a[k] : 0.0);
    }
    return out;
  }

  void amplitude_gains() {
    AmplitudeControl& out = out_.amplitude.emplace();
    out.alpha = input_.alpha;
    GainCurve curve = GainCurve::over_amplitude();
    curve.corner_v = out.alpha;
    for (const double alpha : out.alpha)
      curve.corner_text.push_back(fmt::format("corner at {} of the stroke", rounded_text(alpha, 4)));
    for (const Polynomial& one : input_.branches) {
      out.wanted.push_back(one.amplitude.empty() ? std::vector<double>(out.alpha.size(), 1.0)
                                                 : one.amplitude);
      const auto [least, most] = std::minmax_element(out.wanted.back().begin(), out.wanted.back().end());
      out.gains.push_back(BranchGain::between(*least, *most, out_.multiplier));
    }
    curve.gain = out.wanted;
    enter("amplitude curve", Purpose::amplitude);
    invert("stroke", "amplitude", "an");
    build_curve(curve, out.gains);
  }

  void powers() {
    std::vector<bool> needed(kMostPowers + 1, false);
    for (const Polynomial& one : input_.branches) {
      const int count = groups(one.coefficients);
      for (int j = 0; j < count; ++j) {
        const std::vector<double> a = group_coefficients(one.coefficients, j);
        for (size_t i = 0; i < a.size(); ++i) {
          if (a[i] != 0.0) needed[i + 1] = true;
        }
      }
      if (count > 1) needed[static_cast<size_t>(size_)] = true;
    }
    enter("powers (shared by the branches) and groups: W = X Y/U + Z", Purpose::powers);
    make_powers(powers_, std::move(needed), 1.0);
    for (const int one : powers_.multipliers) {
      const Multiplier& m = out_.multipliers[static_cast<std::size_t>(one)];
      warn_above(m.name, m.peak_v);
    }
  }

  void warn_above(const std::string& name, double peak_v) {
    if (peak_v > options_.full_scale_v * (1.0 + 1e-9)) {
      out_.warnings.push_back(fmt::format("{} reaches {} V, above the full scale of {} V", name,
                                          rounded_text(peak_v), rounded_text(options_.full_scale_v)));
    }
  }

  /// Volts of the chain node T_j per unit of h_j, for one volt of T_0 per unit of d: each product x^g T/U
  /// costs U^-g.
  double chain_scale(int j) const { return std::pow(options_.multiplier.scale_v, size_ * j); }

  /// Greatest |voltage| of any sum or product of a branch for 1 V per unit of d.
  double greatest_inside(const std::vector<double>& a) const {
    double out = 0.0;
    for (int j = 0; j < groups(a); ++j) {
      const std::vector<double> tail(a.begin() + std::min<long>(j * size_, static_cast<long>(a.size())),
                                     a.end());
      out = std::max({out, chain_scale(j) * peak(tail), chain_scale(j) * peak(group_coefficients(a, j))});
    }
    return out;
  }

  /// Output amplifier: -(Rg/(Rin + Ron)), its gain such that the greatest node of the branches uses the full
  /// scale.
  void scale_branches() {
    double greatest = 0.0, top = 0.0;
    for (std::size_t b = 0; b < input_.branches.size(); ++b) {
      const std::vector<double>& a = input_.branches[b].coefficients;
      greatest = std::max({greatest, at_rest(b) * greatest_inside(a), greatest_gain(b) * peak(a)});
      top = std::max(top, greatest_gain(b) * peak(a));
    }
    const double swing = 0.95 * options_.opamp.swing_v;
    if (top > swing) {
      throw DesignError(
          fmt::format("d(x) reaches {} and 1 V stands for d = 1: the output amplifier ends at {} V",
                      rounded_text(top), rounded_text(swing)));
    }
    if (top > options_.full_scale_v) {
      out_.warnings.push_back(fmt::format("out reaches {} V, above the full scale of {} V (1 V is d = 1)",
                                          rounded_text(top), rounded_text(options_.full_scale_v)));
    }
    const double asked = greatest > 0.0 ? std::min(kRoom * options_.full_scale_v / greatest, 50.0) : 1.0;
    const double on = input_.branches.size() > 1 ? out_.analog_switch.on_ohm : 0.0;
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

  void output() {
    enter("back to 1 V per unit of d", Purpose::output);
    const std::string source = out_.switched() ? "sw" : out_.branches.front().out;
    out_.output_input = resistor("Rin", "output amplifier, input", source, "mo", input_ohm_, input_ohm_);
    out_.output_feedback =
        resistor("Rg", "output amplifier, feedback", "mo", "out", feedback_ohm_, feedback_ohm_);
    opamp("output amplifier", "0", "mo", "out");
  }

  void branch(std::size_t number) {
    const Polynomial& asked = input_.branches[number];
    Branch b;
    b.name = asked.name;
    b.wanted = asked.coefficients;
    b.realised.assign(b.wanted.size(), 0.0);
    const std::string end = "b" + letter(number);
    const int count = groups(b.wanted);
    std::string inner;
    for (int j = count - 1; j >= 0; --j) {
      const std::vector<double> a = group_coefficients(b.wanted, j);
      const bool zero = std::all_of(a.begin(), a.end(), [](double one) { return one == 0.0; });
      std::string added = "0";
      const double volts = -out_.branch_gain * chain_scale(j) * at_rest(number);
      if (!zero || count == 1) {
        added = count == 1 ? end : fmt::format("{}{}{}", j == count - 1 ? "t" : "z", letter(number), j);
        enter(count == 1 ? b.name : fmt::format("{}: {}", b.name, added), Purpose::branch);
        const WeightedSum made = weighted_sum(powers_, a, volts, number, added, j * size_ + 1,
                                              count == 1 ? "" : fmt::format("_{}", j));
        out_.noise_gain = std::max(out_.noise_gain, made.noise_gain);
        for (std::size_t k = 0; k < a.size(); ++k) {
          if (a[k] != 0.0) b.realised[static_cast<std::size_t>(j * size_) + k] = made.realised[k];
        }
      }
      if (j == count - 1) {
        inner = added;
        continue;
      }
      const std::string out = j == 0 ? end : fmt::format("t{}{}", letter(number), j);
      const std::vector<double> tail(b.wanted.begin() + j * size_, b.wanted.end());
      enter("powers (shared by the branches) and groups: W = X Y/U + Z", Purpose::powers);
      // M2 to M7 are the powers.
      multiplier(fmt::format("M{}{}", letter(number).empty() ? "c" : letter(number), j),
                 fmt::format("group {} of {}", j, b.name), powers_.node(size_), inner, added, out,
                 -volts * peak(tail));
      inner = out;
    }
    b.peak_v = out_.branch_gain * greatest_gain(number) * peak(b.realised);
    b.out = end;
    if (out_.amplitude && out_.amplitude->gains[number].control >= 0) {
      enter("amplitude gain, " + b.name, Purpose::amplitude);
      out_.amplitude->multipliers.push_back(static_cast<int>(out_.multipliers.size()));
      b.out = vary(GainCurve::over_amplitude(), out_.amplitude->gains[number], number, end, "", b.peak_v);
    }
    for (int i = 0; i <= kPolynomialPoints; ++i) {
      const double x = static_cast<double>(i) / kPolynomialPoints;
      b.max_error_percent = std::max(b.max_error_percent,
                                     100.0 * std::abs(polynomial(b.realised, x) - polynomial(b.wanted, x)));
    }
    out_.max_error_percent = std::max(out_.max_error_percent, b.max_error_percent);
    out_.branches.push_back(std::move(b));
  }

  /// Levels of the lines, a decoder and a contact for every branch.
  void branch_switch() {
    const SwitchModel& model = out_.analog_switch;
    const auto level = [&](const std::string& pin, const std::string& node) {
      out_.comparators.push_back({group, pin, node, 40.0, 0.5});
    };
    group = add_group(fmt::format("branch switch, {}: {} ohm, closes {} s and opens {} s after its control",
                                  model.name, plain_number(model.on_ohm), plain_number(model.on_delay_s),
                                  plain_number(model.off_delay_s())),
                      Purpose::branch_switch);
    level("branch", "lb");
    for (int line = 1; line <= out_.select_lines(); ++line)
      level(fmt::format("select{}", line), fmt::format("l{}", line));
    for (std::size_t b = 0; b < out_.branches.size(); ++b) {
      const std::size_t channel = add_group("", Purpose::branch_switch);
      out_.gates.push_back(decoded(static_cast<int>(b), channel));
      out_.contacts.push_back({fmt::format("S{}", b + 1), channel, out_.branches[b].out, "sw",
                               fmt::format("e{}", b + 1), static_cast<int>(b)});
    }
  }

  /// 1 when the lines (levels lb, l1, l2, …) select this branch.
  schematic::Gate decoded(int branch, std::size_t channel) const {
    schematic::Gate out{channel, fmt::format("e{}", branch + 1), {}, {}, true};
    const int lines = out_.select_lines();
    for (int select = 0; select < (1 << lines); ++select) {
      const bool up = out_.branch_at(select, true) == branch, down = out_.branch_at(select, false) == branch;
      if (!up && !down) continue;
      out.never = false;
      if (up != down) (up ? out.high : out.low).push_back("lb");
      for (int bit = 0; bit < lines; ++bit)
        (((select >> bit) & 1) != 0 ? out.high : out.low).push_back(fmt::format("l{}", bit + 1));
      break;
    }
    return out;
  }

  const Input& input_;
  const Options& options_;
  int size_;
  Powers powers_{.x = "x", .scaled = "x", .tail = ""};
  double input_ohm_ = 0.0, feedback_ohm_ = 0.0;  ///< of the output amplifier
  Layout out_;
};

}  // namespace

Options::Options() : fast_opamp(schematic::OpAmpLibrary::built_in().named("AD8066")) {}

Layout build(const Input& input, const Options& options, int group) {
  return Builder(input, options, group).build();
}

}  // namespace bodesmith::generator
