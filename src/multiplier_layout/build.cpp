#include "multiplier_layout/build.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuit/parts/summing_amplifier.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::multiplier_layout {
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

class Builder {
 public:
  Builder(const Input& input, const Options& options, int group)
      : input_(input), options_(options), group_(group) {
    out_.multiplier = options.multiplier;
    out_.opamp = options.opamp;
    out_.analog_switch = options.analog_switch.value_or(SwitchModel::for_branches(input.branches.size()));
    out_.group = group;
    out_.full_scale_v = options.full_scale_v;
  }

  Layout build() {
    powers_ = add_group(out_, "powers (shared by the branches) and groups: W = X Y/U + Z", Purpose::powers);
    output_ = add_group(out_, "back to 1 V per unit of d", Purpose::output);
    powers();
    output();
    for (const Polynomial& one : input_.branches) branch(one);
    out_.output_opamp = add_opamp(
        out_, {fmt::format("U{}", out_.sums.size() + 1), "output amplifier", output_, "0", "mo", "out"});
    branch_switch();
    detector();
    arrange(out_);
    return std::move(out_);
  }

 private:
  int groups(const std::vector<double>& a) const { return std::max(1, (degree(a) + group_ - 1) / group_); }

  /// a_{jg+1} …: coefficients of P_j.
  std::vector<double> group_coefficients(const std::vector<double>& a, int j) const {
    std::vector<double> out;
    for (int i = 0; i < group_; ++i) {
      const size_t k = static_cast<size_t>(j * group_ + i);
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
      if (count > 1) needed[static_cast<size_t>(group_)] = true;
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

  int resistor(std::size_t group, std::string name, std::string role, std::string from, std::string to,
               double wanted, double realised) {
    return add_resistor(out_, options_.resistors, group, std::move(name), std::move(role), std::move(from),
                        std::move(to), wanted, realised);
  }

  /// Volts of the chain node T_j per unit of h_j, for one volt of T_0 per unit of d: each product x^g T/U
  /// costs U^-g.
  double chain_scale(int j) const { return std::pow(options_.multiplier.scale_v, group_ * j); }

  /// Greatest |voltage| of any sum or product of a branch for 1 V per unit of d.
  double greatest_inside(const std::vector<double>& a) const {
    double out = 0.0;
    for (int j = 0; j < groups(a); ++j) {
      const std::vector<double> tail(a.begin() + std::min<long>(j * group_, static_cast<long>(a.size())),
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
    double feedback = options_.resistors.nearest((input + on) / asked);
    // Never above full scale: the next value up lowers the gain.
    if ((input + on) / feedback > asked) {
      for (const double r : options_.resistors.values(feedback, feedback * 2.5)) {
        if ((input + on) / r <= asked) {
          feedback = r;
          break;
        }
      }
    }
    if (feedback > 10e6) {
      throw DesignError(
          fmt::format("the coefficients need nodes of {} V per volt of output, more than resistors up to 10 "
                      "Mohm can scale",
                      rounded_text(greatest)));
    }
    const double rin = options_.resistors.nearest(input);
    out_.branch_gain = (rin + on) / feedback;
    const std::string source = input_.branches.size() > 1 ? "sw" : "b1";
    out_.output_input = resistor(output_, "Rin", "output amplifier, input", source, "mo", rin, rin);
    out_.output_feedback =
        resistor(output_, "Rg", "output amplifier, feedback", "mo", "out", feedback, feedback);
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
        b.sums.push_back(sum(b, a, j, letter, suffix, fmt::format("{}{}", number, suffix), added));
      }
      if (j == count - 1) {
        inner = added;
        continue;
      }
      const std::string out = j == 0 ? b.out : fmt::format("t{}_{}", number, j);
      const std::vector<double> tail(b.wanted.begin() + j * group_, b.wanted.end());
      const double top = out_.branch_gain * chain_scale(j) * peak(tail);
      // M2 to M7 are the powers.
      out_.multipliers.push_back({fmt::format("M{}{}", letter.empty() ? "c" : letter, j),
                                  fmt::format("group {} of {}", j, b.name), powers_, power_node(group_),
                                  inner, added, out, top});
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
  int sum(Branch& b, const std::vector<double>& a, int j, const std::string& letter,
          const std::string& suffix, const std::string& place, const std::string& node) {
    Sum out;
    const std::size_t group =
        add_group(out_, fmt::format("{}: {}", b.name, node), schematic::Purpose::branch);
    const std::string plus = "p" + place, minus = "m" + place;
    const double volts = out_.branch_gain * chain_scale(j);
    std::vector<double> gains, scale;
    for (size_t k = 0; k < a.size(); ++k) {
      scale.push_back(level(options_.multiplier, static_cast<int>(k) + 1));
      gains.push_back(-volts * a[k] / scale.back());
    }
    const circuit::SummingDesign design = circuit::search_summing_resistors(gains, scale, options_.resistors);
    bool plus_used = false;
    double minus_siemens = 0.0;
    for (size_t k = 0; k < a.size(); ++k) {
      if (gains[k] == 0.0) continue;
      const int power = j * group_ + static_cast<int>(k) + 1;
      const bool at_plus = gains[k] > 0.0;
      const std::string from = power_node(static_cast<int>(k) + 1);
      const int part = resistor(group, fmt::format("R{}{}", letter, power),
                                fmt::format("weight of {}, {}", power_text(power), b.name), from,
                                at_plus ? plus : minus, design.exact.weights[k], design.realised.weights[k]);
      out.terms.push_back({from, part, at_plus, design.gains[k]});
      b.realised[static_cast<size_t>(power) - 1] = -design.gains[k] * scale[k] / volts;
      plus_used = plus_used || at_plus;
      if (!at_plus) minus_siemens += 1.0 / design.realised.weights[k];
    }
    out.feedback =
        resistor(group, fmt::format("R{}f{}", letter, suffix), fmt::format("feedback of the sum, {}", b.name),
                 minus, node, design.exact.feedback, design.realised.feedback);
    if (design.realised.balance > 0.0) {
      const bool at_plus = design.realised.balance_at_plus;
      out.balance = resistor(group, fmt::format("R{}b{}", letter, suffix),
                             fmt::format("balance of the sum, {}", b.name), at_plus ? plus : minus, "0",
                             design.exact.balance, design.realised.balance);
      if (!at_plus) minus_siemens += 1.0 / design.realised.balance;
    }
    out.opamp = add_opamp(
        out_, {fmt::format("U{}", out_.sums.size() + 1), b.name, group, plus_used ? plus : "0", minus, node});
    out.peak_v = volts * peak(a);
    out.noise_gain = 1.0 + minus_siemens * design.realised.feedback;
    out_.sums.push_back(std::move(out));
    return static_cast<int>(out_.sums.size()) - 1;
  }

  /// Levels of the lines, a decoder and a contact for every branch.
  void branch_switch() {
    if (!out_.switched()) return;
    const SwitchModel& model = out_.analog_switch;
    const auto level = [&](std::size_t group, const std::string& pin, const std::string& node) {
      out_.comparators.push_back({group, pin, node, 40.0, 0.5});
    };
    const std::size_t group =
        add_group(out_,
                  fmt::format("branch switch, {}: {} ohm, closes {} s and opens {} s after its control",
                              model.name, plain_number(model.on_ohm), plain_number(model.on_delay_s),
                              plain_number(model.off_delay_s())),
                  Purpose::branch_switch);
    level(group, "branch", "lb");
    for (int line = 1; line <= out_.select_lines(); ++line)
      level(group, fmt::format("select{}", line), fmt::format("l{}", line));
    for (std::size_t b = 0; b < out_.branches.size(); ++b) {
      const std::size_t channel = add_group(out_, "", Purpose::branch_switch);
      out_.gates.push_back(decoded(static_cast<int>(b), channel));
      out_.contacts.push_back({fmt::format("S{}", b + 1), channel, out_.branches[b].out, "sw",
                               fmt::format("e{}", b + 1), static_cast<int>(b)});
    }
  }

  /// 1 when the lines (levels lb, l1, l2, …) select this branch.
  schematic::Gate decoded(int branch, std::size_t group) const {
    schematic::Gate out{group, fmt::format("e{}", branch + 1), {}, {}, true};
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
    const std::size_t group = add_group(out_, "", Purpose::slope_sign);
    const auto resistance = [&](std::string name, std::string role, std::string from, std::string to,
                                double ohm) {
      resistor(group, std::move(name), std::move(role), std::move(from), std::move(to), ohm,
               options_.resistors.nearest(ohm));
    };
    const auto capacitance = [&](std::string name, std::string role, std::string from, std::string to,
                                 double farad) {
      add_part(out_, {Part::Kind::capacitor, std::move(name), std::move(role), group, std::move(from),
                      std::move(to), "E12", farad, circuit::Series::named("E12").nearest(farad)});
    };
    // A triangle of 0 to 1 V rises with 2 f V/s. At the lowest frequency the differentiator gives 100 mV
    // into 4.7 Mohm.
    const double rd = 4.7e6;
    const double cd = circuit::Series::named("E12").nearest(0.1 / (2.0 * options_.lowest.value * rd));
    resistance("Rs", "slope detector, damping", "x", "sa", 100.0);
    capacitance("Cd", "slope detector, differentiates", "sa", "sb", cd);
    resistance("Rd", "slope detector, gain for slow signals", "sb", "sc", rd);
    capacitance("Cf", "slope detector, damping", "sb", "sc", std::max(1e-3 * cd, 1e-12));
    resistance("Rh1", "slope detector, hysteresis", "sp", "0", 1e3);
    resistance("Rh2", "slope detector, hysteresis", "so", "sp", options_.opamp.swing_v / 0.02 * 1e3);
    add_diode(out_, group, "D1", "slope detector, limit", "sb", "sc");
    add_diode(out_, group, "D2", "slope detector, limit", "sc", "sb");
    const auto opamp = [&](std::size_t number, const char* role, const char* plus, const char* minus,
                           const char* out) {
      return add_opamp(out_, {fmt::format("U{}", out_.sums.size() + number), role, group, plus, minus, out});
    };
    out_.differentiator = opamp(2, "slope detector, differentiator", "0", "sb", "sc");
    out_.comparator = opamp(3, "slope detector, comparator", "sp", "sc", "so");
    out_.comparators.push_back({group, "so", "branch"});
  }

  const Input& input_;
  const Options& options_;
  int group_;
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

int add_part(Layout& layout, Part part) {
  layout.parts.push_back(std::move(part));
  return static_cast<int>(layout.parts.size()) - 1;
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

std::size_t add_group(Layout& layout, std::string title, schematic::Purpose purpose) {
  layout.groups.push_back({std::move(title), purpose});
  return layout.groups.size() - 1;
}

int add_diode(Layout& layout, std::size_t group, std::string name, std::string role, std::string anode,
              std::string cathode) {
  return add_part(layout, {Part::Kind::diode, std::move(name), std::move(role), group, std::move(anode),
                           std::move(cathode), "1N4148", 0.0, 0.0});
}

int add_opamp(Layout& layout, schematic::OpAmp opamp) {
  layout.opamps.push_back(std::move(opamp));
  return static_cast<int>(layout.opamps.size()) - 1;
}

int add_resistor(Layout& layout, const circuit::Series& series, std::size_t group, std::string name,
                 std::string role, std::string from, std::string to, double wanted, double realised) {
  return add_part(layout, {Part::Kind::resistor, std::move(name), std::move(role), group, std::move(from),
                           std::move(to), series.name(), wanted, realised});
}

Layout build(const Input& input, const Options& options, int group) {
  Layout out = Builder(input, options, group).build();
  check_outputs(out);
  return out;
}

}  // namespace bodesmith::multiplier_layout
