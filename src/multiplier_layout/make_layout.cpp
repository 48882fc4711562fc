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

}  // namespace bodesmith::multiplier_layout
