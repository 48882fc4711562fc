#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/build.hpp"

namespace bodesmith::generator {
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
  const auto is_scale = [](double v) { return v > 0.0 && v <= 1e6; };
  if (!is_scale(options.multiplier.scale_v) || !is_scale(options.full_scale_v) ||
      (options.analog_switch && !(options.analog_switch->on_ohm >= 0.0))) {
    throw DesignError(
        "the multiplier's scale and the full scale must be above 0 and at most 1e6 V, the switch's resistance not below 0");
  }
}

void warn_when_slow(DisturbanceCircuit& layout, Hertz highest) {
  for (const Candidate& one : layout.candidates) {
    if (one.chosen && one.bandwidth.value < Scheme::kBandwidthRatio * highest.value) {
      layout.warnings.push_back(fmt::format(
          "the signal path ends at {} Hz, less than {} times the highest "
          "reference frequency of {} Hz",
          rounded_text(one.bandwidth.value, 3), Scheme::kBandwidthRatio, rounded_text(highest.value)));
    }
  }
}

/// By the parts, at rest.
void find_amplitude_error(DisturbanceCircuit& layout) {
  const RestWiring wiring(layout);
  const AtRest rest(wiring, Deviations::none(layout));
  AmplitudeControl& a = *layout.amplitude;
  std::vector<double> x;
  for (int i = 0; i <= 50; ++i) x.push_back(i / 50.0);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    for (int i = 1; i <= 100; ++i) {
      const double alpha = i / 100.0 * std::max(1.0, a.alpha.back());
      const std::vector<double> d = curve(rest, b, x, alpha);
      for (std::size_t k = 0; k < x.size(); ++k)
        a.max_error_percent =
            std::max(a.max_error_percent, 100.0 * std::abs(d[k] - layout.wanted(b, x[k], alpha)));
    }
  }
}

Candidate measure(const DisturbanceCircuit& layout, int group, int degree) {
  Candidate out;
  out.group = group;
  out.name = group >= degree ? "shared powers" : (group == 1 ? "Horner" : fmt::format("x^{} (…)", group));
  out.multipliers = static_cast<int>(layout.multipliers.size());
  out.opamps = static_cast<int>(layout.opamps.size());
  std::map<std::string, int> depth;
  for (const Multiplier& m : layout.multipliers) {
    depth[m.out] = 1 + std::max({depth[m.x], depth[m.y], depth[m.z]});
    out.depth = std::max(out.depth, depth[m.out]);
  }
  const Budget budget = make_budget(layout);
  out.rss_percent = *std::ranges::max_element(budget.rss_percent);
  const double lag =
      out.depth / layout.multiplier.bandwidth.rad_s().value +
      (layout.noise_gain + 1.0 + 1.0 / layout.branch_gain) / layout.opamp.gain_bandwidth.rad_s().value;
  out.bandwidth = Hertz{1.0 / (2.0 * std::numbers::pi * lag)};
  return out;
}

}  // namespace

DisturbanceCircuit make_layout(const Input& input, const Options& options) {
  check(input, options);
  const Input full_strokes{input.branches, {}};
  const std::vector<Candidate> candidates = compare_schemes(full_strokes, options);
  const auto chosen = std::ranges::find_if(candidates, [](const Candidate& one) { return one.chosen; });
  const auto made = [&](const Input& which) {
    // Asked for, but it cannot be made: building it says why.
    DisturbanceCircuit out =
        Builder(which, options, chosen == candidates.end() ? options.scheme.group : chosen->group).build();
    out.candidates = candidates;
    warn_when_slow(out, options.highest);
    add_nodes(out);
    return out;
  };
  DisturbanceCircuit out = made(input);
  if (out.amplitude) {
    find_amplitude_error(out);
    out.of_full_strokes = std::make_shared<const DisturbanceCircuit>(made(full_strokes));
  }
  return out;
}

DisturbanceCircuit make_layout(const Disturbance& disturbance, const Options& options) {
  return make_layout(Input::of(disturbance), options);
}

Input Input::of(const Disturbance& disturbance) {
  const auto list = [](const std::array<double, 3>& a) { return std::vector<double>(a.begin(), a.end()); };
  return {.branches = {{"ascending", list(disturbance.ascending), disturbance.amplitude.ascending},
                       {"descending", list(disturbance.descending), disturbance.amplitude.descending}},
          .alpha = disturbance.amplitude.alpha};
}

Input Input::from_node(const Node& node) {
  if (!node.has("branches")) return of(Disturbance::from_node(node));
  node.expect_schema("disturbance");
  // What the contract fixes must be right, even if the branches take its place here.
  if (node.has("ascending") || node.has("descending")) Disturbance::from_node(node);
  Input out;
  const Node branches = node.at("branches");
  if (branches.size() == 0 || branches.size() > kMostBranches) {
    branches.fail(fmt::format("has {} branches, expected 1 to {}", branches.size(), kMostBranches));
  }
  if (node.has("amplitude")) {
    const Node alpha = node.at("amplitude").at("alpha");
    out.alpha = alpha.numbers();
    if (out.alpha.empty()) alpha.fail("is empty, expected at least one number");
    for (size_t i = 0; i < out.alpha.size(); ++i) {
      if (!(out.alpha[i] > 0.0) || (i > 0 && !(out.alpha[i] > out.alpha[i - 1])))
        alpha[i].fail("is out of order, expected rising numbers above 0");
    }
  }
  for (size_t b = 0; b < branches.size(); ++b) {
    const Node one = branches[b];
    one.allow_only({"name", "coefficients", "amplitude"});
    Polynomial polynomial;
    polynomial.name = one.string_or("name", fmt::format("branch {}", b + 1));
    const Node coefficients = one.at("coefficients");
    polynomial.coefficients = coefficients.numbers();
    if (polynomial.coefficients.empty() || polynomial.coefficients.size() > kMostPowers) {
      coefficients.fail(fmt::format("has {} numbers, expected [a1, …] with 1 to {}",
                                    polynomial.coefficients.size(), kMostPowers));
    }
    if (one.has("amplitude")) {
      polynomial.amplitude = one.at("amplitude").numbers();
      if (polynomial.amplitude.size() != out.alpha.size()) {
        one.at("amplitude")
            .fail(fmt::format("has {} gains, expected one for each of the {} values of amplitude.alpha",
                              polynomial.amplitude.size(), out.alpha.size()));
      }
    }
    out.branches.push_back(std::move(polynomial));
  }
  return out;
}

Input Input::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

Scheme Scheme::named(const std::string& name) {
  if (name == "auto") return {kAutomatic};
  if (name == "horner") return {kHorner};
  if (name == "shared") return {kShared};
  double group = 0.0;
  if (!parse_number(name, group) || group < 2.0 || group > 6.0 || group != std::floor(group)) {
    throw InputError(fmt::format("unknown scheme \"{}\", expected auto, shared, horner or 2 to 6", name));
  }
  return {static_cast<int>(group)};
}

/// Fewest multipliers among those whose budget is at most 1.5 times the least and whose bandwidth is at least
/// 20 times the highest reference frequency; of equals the fewest op-amps, then the least
/// error.
std::vector<Candidate> compare_schemes(const Input& input, const Options& options) {
  int most = 1;
  for (const Polynomial& one : input.branches) most = std::max(most, degree(one.coefficients));
  Options exact = options;
  exact.resistors = synthesis::Series::named("exact");
  std::vector<Candidate> out;
  for (int group = most; group >= 1; --group) {
    try {
      out.push_back(measure(Builder(input, exact, group).build(), group, most));
    } catch (const DesignError&) {
      // This split cannot be made; if none can, or it was asked for, building it says why.
    }
  }
  if (out.empty()) Builder(input, exact, most).build();  // throws the reason
  const int asked = std::min(options.scheme.group, most);
  if (options.scheme.group != Scheme::kAutomatic) {
    for (Candidate& one : out) one.chosen = one.group == asked;
    return out;
  }
  double min_error = std::numeric_limits<double>::infinity();
  for (const Candidate& one : out) min_error = std::min(min_error, one.rss_percent);
  Candidate* best = nullptr;
  for (Candidate& one : out) {
    if (one.rss_percent > 1.5 * min_error ||
        one.bandwidth.value < Scheme::kBandwidthRatio * options.highest.value)
      continue;
    const auto rank = [](const Candidate& c) { return std::tuple(c.multipliers, c.opamps, c.rss_percent); };
    if (best == nullptr || rank(one) < rank(*best)) best = &one;
  }
  // None is fast enough: the most accurate.
  if (best == nullptr) {
    best = &*std::ranges::min_element(out, {}, &Candidate::rss_percent);
  }
  best->chosen = true;
  return out;
}

}  // namespace bodesmith::generator
