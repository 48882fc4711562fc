#include "circuit/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuit/weights_search.hpp"

namespace bodesmith {
namespace {

constexpr int kMostPowers = 7;

std::string power_node(int power) {
  return power == 1 ? "x" : fmt::format("x{}", power);
}
std::string power_text(int power) {
  return power == 1 ? "x" : fmt::format("x^{}", power);
}

/// "x^2/U", "x^3/U^2"
std::string power_over_scale(int power) {
  return power_text(power) + (power == 1 ? "" : (power == 2 ? "/U" : fmt::format("/U^{}", power - 1)));
}

double horner(const std::vector<double>& a, double x) {
  double out = 0.0;
  for (size_t k = a.size(); k-- > 0;) out = (out + a[k]) * x;
  return out;
}

double peak(const std::vector<double>& a) {
  double out = 0.0;
  for (int i = 0; i <= 1000; ++i) out = std::max(out, std::abs(horner(a, i / 1000.0)));
  return out;
}

/// Node voltage of x^k at x = 1.
double level(const MultiplierModel& m, int power) {
  return std::pow(m.scale_v, 1 - power);
}

class Builder {
 public:
  explicit Builder(const LayoutOptions& options) : options_(options) {
    out_.multiplier = options.multiplier;
    out_.opamp = options.opamp;
    out_.switch_on_ohm = options.switch_on_ohm;
    out_.full_scale_v = options.full_scale_v;
  }

  DisturbanceLayout build(const std::vector<LayoutPolynomial>& polynomials) {
    check(polynomials);
    powers(polynomials);
    output(polynomials);
    for (const LayoutPolynomial& one : polynomials) branch(one, polynomials.size());
    detector();
    nodes();
    return std::move(out_);
  }

 private:
  void check(const std::vector<LayoutPolynomial>& polynomials) const {
    if (polynomials.empty() || polynomials.size() > 2) {
      throw DesignError(fmt::format("{} branches were asked for, expected one or two", polynomials.size()));
    }
    for (const LayoutPolynomial& one : polynomials) {
      if (one.coefficients.empty() || one.coefficients.size() > kMostPowers) {
        throw DesignError(fmt::format("branch {} has degree {}, expected 1 to {}", one.name,
                                      one.coefficients.size(), kMostPowers));
      }
      for (const double a : one.coefficients) {
        if (!std::isfinite(a) || std::abs(a) > 1e6) {
          throw DesignError(
              fmt::format("branch {} has a coefficient of {}, expected at most 1e6", one.name, a));
        }
      }
    }
    if (!(options_.multiplier.scale_v > 0.0) || !(options_.full_scale_v > 0.0) ||
        !(options_.switch_on_ohm >= 0.0)) {
      throw DesignError(
          "the multiplier's scale and the full scale must be above 0, the switch's resistance not below");
    }
  }

  /// Fewest multipliers for the powers that any branch uses: x^k from the two halves of k, which may have to
  /// be made too.
  void powers(const std::vector<LayoutPolynomial>& polynomials) {
    std::vector<bool> needed(kMostPowers + 1, false);
    for (const LayoutPolynomial& one : polynomials) {
      for (size_t k = 0; k < one.coefficients.size(); ++k) {
        if (one.coefficients[k] != 0.0) needed[k + 1] = true;
      }
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
      LayoutMultiplier m;
      m.name = fmt::format("M{}", k);
      m.power = k;
      m.x_power = a;
      m.y_power = b;
      m.x = power_node(a);
      m.y = power_node(b);
      m.out = power_node(k);
      m.peak_v = level(options_.multiplier, k);
      if (m.peak_v > options_.full_scale_v * (1.0 + 1e-9)) {
        out_.warnings.push_back(fmt::format("{} reaches {} V at x = 1, above the full scale of {} V", m.name,
                                            rounded_text(m.peak_v), rounded_text(options_.full_scale_v)));
      }
      out_.multipliers.push_back(std::move(m));
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

  int add(LayoutPart part) {
    out_.parts.push_back(std::move(part));
    return static_cast<int>(out_.parts.size()) - 1;
  }
  int resistor(std::string name, std::string role, std::string from, std::string to, double wanted,
               double realised) {
    return add({LayoutPart::Kind::resistor, std::move(name), std::move(role), std::move(from), std::move(to),
                options_.resistors.name(), wanted, realised});
  }

  /// Output amplifier: -(Rg/(Rin + Ron)), its gain such that the branch sums use the full scale.
  void output(const std::vector<LayoutPolynomial>& polynomials) {
    double greatest = 0.0;
    for (const LayoutPolynomial& one : polynomials) greatest = std::max(greatest, peak(one.coefficients));
    const double asked =
        greatest > 0.0 ? std::clamp(0.97 * options_.full_scale_v / greatest, 1e-3, 50.0) : 1.0;
    const double input = 20e3;
    const double on = polynomials.size() > 1 ? options_.switch_on_ohm : 0.0;
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
    const double rin = options_.resistors.nearest(input);
    out_.branch_gain = (rin + on) / feedback;
    const std::string source = polynomials.size() > 1 ? "sw" : "b1";
    out_.output_input = resistor("Rin", "output amplifier, input", source, "mo", rin, rin);
    out_.output_feedback = resistor("Rg", "output amplifier, feedback", "mo", "out", feedback, feedback);
  }

  void branch(const LayoutPolynomial& polynomial, size_t count) {
    const size_t number = out_.branches.size() + 1;
    LayoutBranch b;
    b.name = polynomial.name;
    b.wanted = polynomial.coefficients;
    b.plus = fmt::format("p{}", number);
    b.minus = fmt::format("m{}", number);
    b.out = fmt::format("b{}", number);
    std::vector<double> gains, scale;
    for (size_t k = 0; k < b.wanted.size(); ++k) {
      scale.push_back(level(options_.multiplier, static_cast<int>(k) + 1));
      gains.push_back(-out_.branch_gain * b.wanted[k] / scale.back());
    }
    const SummingDesign design = search_summing_resistors(gains, scale, options_.resistors);
    const std::string letter = count == 1 ? "" : (number == 1 ? "a" : "d");
    for (size_t k = 0; k < b.wanted.size(); ++k) {
      b.at_plus.push_back(gains[k] > 0.0);
      b.weight.push_back(
          gains[k] == 0.0
              ? -1
              : resistor(fmt::format("R{}{}", letter, k + 1),
                         fmt::format("weight of {}, {}", power_text(static_cast<int>(k) + 1), b.name),
                         power_node(static_cast<int>(k) + 1), gains[k] > 0.0 ? b.plus : b.minus,
                         design.exact.weights[k], design.realised.weights[k]));
      b.realised.push_back(-design.gains[k] * scale[k] / out_.branch_gain);
    }
    b.feedback = resistor(fmt::format("R{}f", letter), fmt::format("feedback of the sum, {}", b.name),
                          b.minus, b.out, design.exact.feedback, design.realised.feedback);
    if (design.realised.balance > 0.0) {
      b.balance = resistor(fmt::format("R{}b", letter), fmt::format("balance of the sum, {}", b.name),
                           design.realised.balance_at_plus ? b.plus : b.minus, "0", design.exact.balance,
                           design.realised.balance);
    }
    b.peak_v = out_.branch_gain * peak(b.realised);
    for (int i = 0; i <= 1000; ++i) {
      const double x = i / 1000.0;
      b.max_error_percent = std::max(b.max_error_percent, 100.0 * std::abs(b.value(x) - horner(b.wanted, x)));
    }
    out_.max_error_percent = std::max(out_.max_error_percent, b.max_error_percent);
    out_.branches.push_back(std::move(b));
  }

  /// Differentiator with a logarithmic limit (two diodes across Rd) and a comparator with hysteresis:
  /// v = -Rd Cd dx/dt as long as it is small, +-0.6 V above; the sign is right over four decades of slope.
  void detector() {
    if (out_.branches.size() < 2) return;
    const auto resistance = [&](std::string name, std::string role, std::string from, std::string to,
                                double ohm) {
      const double near = options_.resistors.nearest(ohm);
      out_.detector.push_back(
          resistor(std::move(name), std::move(role), std::move(from), std::move(to), ohm, near));
    };
    const auto capacitance = [&](std::string name, std::string role, std::string from, std::string to,
                                 double farad) {
      out_.detector.push_back(
          add({LayoutPart::Kind::capacitor, std::move(name), std::move(role), std::move(from), std::move(to),
               "E12", farad, Series::named("E12").nearest(farad)}));
    };
    // A triangle of 0 to 1 V rises with 2 f V/s. At the lowest frequency the differentiator gives 100 mV
    // into 4.7 Mohm.
    const double rd = 4.7e6;
    const double cd = Series::named("E12").nearest(0.1 / (2.0 * options_.lowest.value * rd));
    resistance("Rs", "slope detector, damping", "x", "sa", 100.0);
    capacitance("Cd", "slope detector, differentiates", "sa", "sb", cd);
    resistance("Rd", "slope detector, gain for slow signals", "sb", "sc", rd);
    capacitance("Cf", "slope detector, damping", "sb", "sc", std::max(1e-3 * cd, 1e-12));
    resistance("Rh1", "slope detector, hysteresis", "sp", "0", 1e3);
    resistance("Rh2", "slope detector, hysteresis", "so", "sp", options_.opamp.swing_v / 0.02 * 1e3);
  }

  void nodes() {
    const auto add_node = [&](std::string name, std::string what, double low, double high) {
      // + 0.0: no "-0.0" in the files.
      out_.nodes.push_back({std::move(name), std::move(what), low + 0.0, high + 0.0});
    };
    add_node("x", "reference, 1 V is full stroke", 0.0, 1.0);
    for (const LayoutMultiplier& m : out_.multipliers) {
      add_node(m.out, power_over_scale(m.power), 0.0, m.peak_v);
    }
    double low_out = 0.0, high_out = 0.0;
    for (const LayoutBranch& b : out_.branches) {
      double low = 0.0, high = 0.0;
      for (int i = 0; i <= 1000; ++i) {
        low = std::min(low, b.value(i / 1000.0));
        high = std::max(high, b.value(i / 1000.0));
      }
      add_node(b.out, fmt::format("-{} d(x), {}", rounded_text(out_.branch_gain), b.name),
               -out_.branch_gain * high, -out_.branch_gain * low);
      low_out = std::min(low_out, low);
      high_out = std::max(high_out, high);
    }
    if (out_.branches.size() > 1) {
      add_node("sw", "behind the branch switch", -out_.branch_gain * high_out, -out_.branch_gain * low_out);
    }
    add_node("out", "d(x), 1 V per unit", low_out, high_out);
  }

  LayoutOptions options_;
  DisturbanceLayout out_;
};

}  // namespace

double LayoutBranch::value(double x) const {
  return horner(realised, x);
}

const LayoutPart* DisturbanceLayout::part_named(const std::string& name) const {
  for (const LayoutPart& one : parts) {
    if (one.name == name) return &one;
  }
  return nullptr;
}

DisturbanceLayout layout_polynomials(const std::vector<LayoutPolynomial>& branches,
                                     const LayoutOptions& options) {
  return Builder(options).build(branches);
}

DisturbanceLayout layout_disturbance(const Disturbance& disturbance, const LayoutOptions& options) {
  const auto list = [](const std::array<double, 3>& a) { return std::vector<double>(a.begin(), a.end()); };
  return layout_polynomials(
      {{"ascending", list(disturbance.ascending)}, {"descending", list(disturbance.descending)}}, options);
}

Json DisturbanceLayout::to_json() const {
  Json out;
  out["multiplier"] = {{"name", multiplier.name},
                       {"scale_v", multiplier.scale_v},
                       {"greatest_input_v", multiplier.greatest_input_v},
                       {"bandwidth_hz", multiplier.bandwidth.value}};
  out["opamp"] = {{"name", opamp.name}, {"gain_bandwidth_hz", opamp.gain_bandwidth.value}};
  out["opamps"] = branches.size() + 1 + (branches.size() > 1 ? 2 : 0);
  out["branch_gain"] = branch_gain;
  out["multipliers"] = Json::array();
  for (const LayoutMultiplier& m : multipliers) {
    out["multipliers"].push_back(
        {{"name", m.name}, {"x", m.x}, {"y", m.y}, {"w", m.out}, {"power", m.power}, {"peak_v", m.peak_v}});
  }
  out["branches"] = Json::array();
  for (const LayoutBranch& b : branches) {
    out["branches"].push_back({{"name", b.name},
                               {"wanted", b.wanted},
                               {"realised", b.realised},
                               {"peak_v", b.peak_v},
                               {"max_error_percent", b.max_error_percent}});
  }
  if (branches.size() > 1)
    out["switch"] = {{"on_ohm", switch_on_ohm}, {"control", "branch > 0.5 V: " + branches[0].name}};
  out["nodes"] = Json::array();
  for (const LayoutNode& node : nodes) {
    out["nodes"].push_back({{"name", node.name},
                            {"what", node.what},
                            {"lowest_v", node.lowest_v},
                            {"highest_v", node.highest_v}});
  }
  out["parts"] = Json::array();
  for (const LayoutPart& one : parts) {
    const bool resistor = one.kind == LayoutPart::Kind::resistor;
    out["parts"].push_back({{"part", one.name},
                            {"role", one.role},
                            {"from", one.from},
                            {"to", one.to},
                            {"series", one.series},
                            {resistor ? "wanted_ohm" : "wanted_f", one.wanted},
                            {resistor ? "realised_ohm" : "realised_f", one.realised}});
  }
  out["error"] = {{"max_error_percent", max_error_percent}};
  out["warnings"] = warnings;
  return out;
}

}  // namespace bodesmith
