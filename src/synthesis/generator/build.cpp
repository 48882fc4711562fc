#include "synthesis/generator/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/plain_number.hpp"
#include "synthesis/parts/summing_amplifier.hpp"

namespace bodesmith::generator {
namespace {

using schematic::plain_number;
using schematic::Purpose;

std::string power_node(int power) {
  return power == 1 ? "x" : fmt::format("x{}", power);
}

/// "x^2/U", "x^3/U^2"
std::string power_over_scale(int power) {
  return power_text(power) + (power == 1 ? "" : (power == 2 ? "/U" : fmt::format("/U^{}", power - 1)));
}

class Builder : private synthesis::NetlistMaker {
 public:
  Builder(const Input& input, const Options& options, int size)
      : NetlistMaker(out_, options.resistors, capacitors()), input_(input), options_(options), size_(size) {
    out_.multiplier = options.multiplier;
    out_.opamp = options.opamp;
    out_.analog_switch = options.analog_switch.value_or(SwitchModel::for_branches(input.branches.size()));
    out_.group = size;
    out_.full_scale_v = options.full_scale_v;
  }

  Layout build() {
    powers_ = add_group("powers (shared by the branches) and groups: W = X Y/U + Z", Purpose::powers);
    output_ = add_group("back to 1 V per unit of d", Purpose::output);
    powers();
    output();
    for (const Polynomial& one : input_.branches) branch(one);
    group = output_;
    out_.output_opamp = opamp("output amplifier", "0", "mo", "out");
    branch_switch();
    detector();
    arrange(out_);
    return std::move(out_);
  }

 private:
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

  /// Fewest multipliers for the powers that any group uses: x^k from the two halves of k, which may have to
  /// be made too.
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
    for (int k = kMostPowers; k >= 2; --k) {
      if (!needed[static_cast<size_t>(k)]) continue;
      const auto [a, b] = factors(k, needed);
      needed[static_cast<size_t>(a)] = true;
      needed[static_cast<size_t>(b)] = true;
    }
    for (int k = 2; k <= kMostPowers; ++k) {
      if (!needed[static_cast<size_t>(k)]) continue;
      const auto [a, b] = factors(k, needed);
      const double top = level(options_.multiplier, k);
      out_.multipliers.push_back({fmt::format("M{}", k), power_over_scale(k), powers_, power_node(a),
                                  power_node(b), "0", power_node(k), top});
      warn_above(out_.multipliers.back().name, top);
    }
  }

  void warn_above(const std::string& name, double peak_v) {
    if (peak_v > options_.full_scale_v * (1.0 + 1e-9)) {
      out_.warnings.push_back(fmt::format("{} reaches {} V, above the full scale of {} V", name,
                                          rounded_text(peak_v), rounded_text(options_.full_scale_v)));
    }
  }

  /// The two powers that make x^k: both there already if possible, otherwise as equal as possible (short
  /// chains).
  static std::pair<int, int> factors(int k, const std::vector<bool>& needed) {
    for (int a = (k + 1) / 2; a < k; ++a) {
      const int b = k - a;
      if ((a == 1 || needed[static_cast<size_t>(a)]) && (b == 1 || needed[static_cast<size_t>(b)]))
        return {a, b};
    }
    return {(k + 1) / 2, k / 2};
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
  void output() {
    double greatest = 0.0, top = 0.0;
    for (const Polynomial& one : input_.branches) {
      greatest = std::max(greatest, greatest_inside(one.coefficients));
      top = std::max(top, peak(one.coefficients));
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
    const double input = 20e3;
    const double on = input_.branches.size() > 1 ? out_.analog_switch.on_ohm : 0.0;
    // Never above full scale: the next value up lowers the gain.
    const double feedback = options_.resistors.nearest_above((input + on) / asked);
    if (feedback > 10e6) {
      throw DesignError(
          fmt::format("the coefficients need nodes of {} V per volt of output, more than resistors up to 10 "
                      "Mohm can scale",
                      rounded_text(greatest)));
    }
    const double rin = options_.resistors.nearest(input);
    out_.branch_gain = (rin + on) / feedback;
    const std::string source = input_.branches.size() > 1 ? "sw" : "b1";
    group = output_;
    out_.output_input = resistor("Rin", "output amplifier, input", source, "mo", rin, rin);
    out_.output_feedback = resistor("Rg", "output amplifier, feedback", "mo", "out", feedback, feedback);
  }

  void branch(const Polynomial& asked) {
    const size_t number = out_.branches.size() + 1;
    const std::string letter = branch_letter(number - 1, input_.branches.size());
    Branch b;
    b.name = asked.name;
    b.wanted = asked.coefficients;
    b.realised.assign(b.wanted.size(), 0.0);
    b.out = fmt::format("b{}", number);
    const int count = groups(b.wanted);
    std::string inner;
    for (int j = count - 1; j >= 0; --j) {
      const std::vector<double> a = group_coefficients(b.wanted, j);
      const bool zero = std::all_of(a.begin(), a.end(), [](double one) { return one == 0.0; });
      std::string added = "0";
      if (!zero || count == 1) {
        const std::string suffix = count == 1 ? "" : fmt::format("_{}", j);
        added = count == 1 ? b.out : fmt::format("{}{}_{}", j == count - 1 ? "t" : "z", number, j);
        b.sums.push_back(branch_sum(b, a, j, letter, suffix, fmt::format("{}{}", number, suffix), added));
      }
      if (j == count - 1) {
        inner = added;
        continue;
      }
      const std::string out = j == 0 ? b.out : fmt::format("t{}_{}", number, j);
      const std::vector<double> tail(b.wanted.begin() + j * size_, b.wanted.end());
      const double top = out_.branch_gain * chain_scale(j) * peak(tail);
      // M2 to M7 are the powers.
      out_.multipliers.push_back({fmt::format("M{}{}", letter.empty() ? "c" : letter, j),
                                  fmt::format("group {} of {}", j, b.name), powers_, power_node(size_), inner,
                                  added, out, top});
      b.multipliers.push_back(static_cast<int>(out_.multipliers.size()) - 1);
      inner = out;
    }
    b.peak_v = out_.branch_gain * peak(b.realised);
    for (int i = 0; i <= kPolynomialPoints; ++i) {
      const double x = static_cast<double>(i) / kPolynomialPoints;
      b.max_error_percent =
          std::max(b.max_error_percent, 100.0 * std::abs(b.value(x) - polynomial(b.wanted, x)));
    }
    out_.max_error_percent = std::max(out_.max_error_percent, b.max_error_percent);
    out_.branches.push_back(std::move(b));
  }

  /// The sum -branch_gain * chain_scale * P_j at `node`; fills the coefficients that its resistors make.
  int branch_sum(Branch& b, const std::vector<double>& a, int j, const std::string& letter,
                 const std::string& suffix, const std::string& place, const std::string& node) {
    group = add_group(fmt::format("{}: {}", b.name, node), Purpose::branch);
    const double volts = out_.branch_gain * chain_scale(j);
    std::vector<double> gains, scale;
    std::vector<Weight> weights;
    for (size_t k = 0; k < a.size(); ++k) {
      const int power = j * size_ + static_cast<int>(k) + 1;
      scale.push_back(level(options_.multiplier, static_cast<int>(k) + 1));
      gains.push_back(-volts * a[k] / scale.back());
      weights.push_back({power_node(static_cast<int>(k) + 1), fmt::format("R{}{}", letter, power),
                         fmt::format("weight of {}, {}", power_text(power), b.name)});
    }
    const synthesis::SummingDesign design =
        synthesis::search_summing_resistors(gains, scale, options_.resistors);
    for (size_t k = 0; k < a.size(); ++k) {
      if (gains[k] != 0.0)
        b.realised[static_cast<size_t>(j * size_) + k] = -design.gains[k] * scale[k] / volts;
    }
    const NetlistMaker::Sum made =
        sum(weights, gains, design, "R" + letter, suffix, b.name, b.name, "p" + place, "m" + place, node);
    out_.sums.push_back({made.opamp, volts * peak(a), made.noise_gain});
    return static_cast<int>(out_.sums.size()) - 1;
  }

  /// Levels of the lines, a decoder and a contact for every branch.
  void branch_switch() {
    if (!out_.switched()) return;
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

  /// Differentiator with a logarithmic limit (two diodes across Rd) and a comparator with hysteresis:
  /// v = -Rd Cd dx/dt as long as it is small, +-0.6 V above; the sign is right over four decades of slope.
  void detector() {
    if (!out_.switched()) return;
    group = add_group("", Purpose::slope_sign);
    // A triangle of 0 to 1 V rises with 2 f V/s. At the lowest frequency the differentiator gives 100 mV
    // into 4.7 Mohm.
    const double rd = 4.7e6;
    const double cd = capacitors().nearest(0.1 / (2.0 * options_.lowest.value * rd));
    resistor("Rs", "slope detector, damping", "x", "sa", 100.0);
    capacitor("Cd", "slope detector, differentiates", "sa", "sb", cd);
    resistor("Rd", "slope detector, gain for slow signals", "sb", "sc", rd);
    capacitor("Cf", "slope detector, damping", "sb", "sc", std::max(1e-3 * cd, 1e-12));
    resistor("Rh1", "slope detector, hysteresis", "sp", "0", 1e3);
    resistor("Rh2", "slope detector, hysteresis", "so", "sp", options_.opamp.swing_v / 0.02 * 1e3);
    diode("D1", "slope detector, limit", "sb", "sc");
    diode("D2", "slope detector, limit", "sc", "sb");
    opamp("slope detector, differentiator", "0", "sb", "sc");
    opamp("slope detector, comparator", "sp", "sc", "so");
    out_.comparators.push_back({group, "so", "branch"});
  }

  const Input& input_;
  const Options& options_;
  int size_;
  std::size_t powers_ = 0, output_ = 0;  ///< groups
  Layout out_;
};

}  // namespace

double level(const MultiplierModel& m, int power) {
  return std::pow(m.scale_v, 1 - power);
}

std::string power_text(int power) {
  return power == 1 ? "x" : fmt::format("x^{}", power);
}

std::string branch_letter(size_t branch, size_t count) {
  if (count == 1) return "";
  if (count == 2) return branch == 0 ? "a" : "d";
  return fmt::format("{}_", branch + 1);
}

void check_outputs(const Layout& layout) {
  for (const Multiplier& m : layout.multipliers) {
    if (m.peak_v <= layout.multiplier.greatest_output_v) continue;
    throw DesignError(fmt::format("{} reaches {} V, expected at most the {}'s {} V", m.name,
                                  rounded_text(m.peak_v), layout.multiplier.name,
                                  rounded_text(layout.multiplier.greatest_output_v)));
  }
}

const synthesis::Series& capacitors() {
  static const synthesis::Series series = synthesis::Series::named("E12");
  return series;
}

void arrange(Layout& layout) {
  using schematic::Purpose;
  static constexpr Purpose kOrder[] = {Purpose::powers,        Purpose::branch, Purpose::amplitude,
                                       Purpose::branch_switch, Purpose::output, Purpose::slope_sign};
  schematic::sort_groups(layout, [](Purpose a, Purpose b) {
    return std::find(std::begin(kOrder), std::end(kOrder), a) <
           std::find(std::begin(kOrder), std::end(kOrder), b);
  });
}

Layout build(const Input& input, const Options& options, int group) {
  Layout out = Builder(input, options, group).build();
  check_outputs(out);
  return out;
}

}  // namespace bodesmith::generator
