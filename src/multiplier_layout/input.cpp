#include <fmt/format.h>

#include <algorithm>

#include "multiplier_layout/build.hpp"

namespace bodesmith::multiplier_layout {

Input Input::of(const Disturbance& disturbance) {
  const auto list = [](const std::array<double, 3>& a) { return std::vector<double>(a.begin(), a.end()); };
  Input out;
  out.alpha = disturbance.amplitude.alpha;
  out.branches = {{"ascending", list(disturbance.ascending), disturbance.amplitude.ascending},
                  {"descending", list(disturbance.descending), disturbance.amplitude.descending}};
  return out;
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
