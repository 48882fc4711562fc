#include "multiplier_layout/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "multiplier_layout/build.hpp"

namespace bodesmith::multiplier_layout {
namespace {

void check(const Input& input, const Options& options) {
  if (input.branches.empty() || input.branches.size() > kMostBranches) {
    throw DesignError(
        fmt::format("{} branches were asked for, expected 1 to {}", input.branches.size(), kMostBranches));
  }
  for (const Polynomial& one : input.branches) {
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
  if (!(options.multiplier.scale_v > 0.0) || !(options.full_scale_v > 0.0) ||
      (options.analog_switch && !(options.analog_switch->on_ohm >= 0.0))) {
    throw DesignError(
        "the multiplier's scale and the full scale must be above 0, the switch's resistance not below");
  }
}

void warn_when_slow(Layout& layout, Hertz highest) {
  for (const Candidate& one : layout.candidates) {
    if (one.chosen && one.bandwidth.value < Scheme::kBandwidthRatio * highest.value) {
      layout.warnings.push_back(fmt::format(
          "the signal path ends at {} Hz, less than {} times the highest "
          "reference frequency of {} Hz",
          rounded_text(one.bandwidth.value, 3), Scheme::kBandwidthRatio, rounded_text(highest.value)));
    }
  }
}

}  // namespace

double Branch::value(double x) const {
  return polynomial(realised, x);
}

double AmplitudeControl::wanted_gain(size_t branch, double at) const {
  const std::vector<double>& gain = wanted[branch];
  if (at <= alpha.front()) return gain.front();
  if (at >= alpha.back()) return gain.back();
  const size_t i = static_cast<size_t>(std::upper_bound(alpha.begin(), alpha.end(), at) - alpha.begin());
  return gain[i - 1] + (at - alpha[i - 1]) / (alpha[i] - alpha[i - 1]) * (gain[i] - gain[i - 1]);
}

int Layout::select_lines() const {
  int lines = 0;
  while ((2u << lines) < branches.size()) ++lines;
  return lines;
}

int Layout::branch_at(int select, bool rising) const {
  const int count = static_cast<int>(branches.size());
  const int code = 2 * select + (rising ? 0 : 1);
  if (code < count) return code;
  return code == count && count % 2 == 1 ? count - 1 : -1;
}

schematic::Netlist Layout::generator(bool with_amplitude) const {
  schematic::Netlist out = schematic::subset(*this, [&](std::size_t one) {
    const schematic::Purpose purpose = purpose_of(one);
    return purpose != schematic::Purpose::slope_sign &&
           (with_amplitude || purpose != schematic::Purpose::amplitude);
  });
  if (!amplitude) return out;
  // The gains stand between the branches and what reads them, and the output takes back what they scale.
  const std::string& left_out = part(with_amplitude ? output_feedback : amplitude->output_feedback).name;
  std::erase_if(out.parts, [&](const Part& one) { return one.name == left_out; });
  if (!with_amplitude) return out;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const std::string& gained = product(amplitude->multipliers[b]).out;
    for (schematic::Contact& one : out.contacts) {
      if (one.from == branches[b].out) one.from = gained;
    }
    if (switched()) continue;
    for (Part& one : out.parts) {
      if (one.name == part(output_input).name) one.from = gained;
    }
  }
  return out;
}

schematic::Netlist Layout::detector_netlist() const {
  return schematic::subset(
      *this, [&](std::size_t one) { return purpose_of(one) == schematic::Purpose::slope_sign; });
}

Layout make_layout(const Input& input, const Options& options) {
  check(input, options);
  std::vector<Candidate> candidates = compare_schemes(input, options);
  const auto chosen =
      std::find_if(candidates.begin(), candidates.end(), [](const Candidate& one) { return one.chosen; });
  // Asked for, but it cannot be made: building it says why.
  const int group = chosen == candidates.end() ? options.scheme.group : chosen->group;
  Layout out = build(input, options, group);
  out.candidates = std::move(candidates);
  warn_when_slow(out, options.highest);
  if (!input.alpha.empty()) add_amplitude(out, input, options);
  add_nodes(out);
  return out;
}

Layout make_layout(const Disturbance& disturbance, const Options& options) {
  return make_layout(Input::of(disturbance), options);
}

Layout make_layout_of_polynomials(const std::vector<Polynomial>& branches, const Options& options) {
  return make_layout(Input{branches, {}}, options);
}

}  // namespace bodesmith::multiplier_layout
