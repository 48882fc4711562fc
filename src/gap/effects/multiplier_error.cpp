#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Errors of a multiplier, in this order: its product of x and y is scale (x + feedthrough) y + offset.
using ErrorValues = std::array<double, 3>;
constexpr ErrorValues kNoErrors = {1.0, 0.0, 0.0};

/// Coefficients [c0, c1, ...] of the polynomial with those coefficients when its powers come from multipliers with
/// errors: p1 = x, p2 = m(p1, x), p3 = m(p2, x), ...
std::vector<double> with_errors(const std::vector<double>& coefficients, const ErrorValues& errors,
                                bool first_alone) {
  std::vector<double> sum(coefficients.size(), 0.0);
  std::vector<double> power(coefficients.size(), 0.0);
  if (sum.size() < 2) return coefficients;
  sum[0] = coefficients[0];
  power[1] = 1.0;
  for (std::size_t n = 1; n < sum.size(); ++n) {
    for (std::size_t k = 0; k <= n; ++k) sum[k] += coefficients[n] * power[k];
    const auto& [scale, feedthrough, offset] = first_alone && n > 1 ? kNoErrors : errors;
    power[0] += feedthrough;
    for (std::size_t k = std::min(n + 1, sum.size() - 1); k > 0; --k) power[k] = scale * power[k - 1];
    power[0] = offset;
  }
  return sum;
}

/// The polynomials of a block with their constants. A list that begins with the coefficient of x has its constant in a
/// parameter "constant_" and the list's name, if the block has one.
struct Powers {
  chain::PolynomialList list;
  std::string constant;
  std::vector<double> coefficients;  ///< [c0, c1, ...]
};

std::vector<Powers> powers_of(const chain::Block& block) {
  std::vector<Powers> all;
  for (const auto& list : block.polynomials()) {
    Powers p{list, {}, block.list(list.key)};
    if (list.first == 0) {
      const std::string constant = "constant_" + std::string(list.key);
      if (block.has(constant)) p.constant = constant;
      p.coefficients.insert(p.coefficients.begin(), p.constant.empty() ? 0.0 : block.get(constant));
    }
    all.push_back(std::move(p));
  }
  return all;
}

void write_powers(chain::Block& block, const Powers& powers, std::vector<double> coefficients) {
  if (powers.list.first == 0) {
    if (!powers.constant.empty()) block.set(powers.constant, coefficients.front());
    coefficients.erase(coefficients.begin());
  }
  block.set(powers.list.key, coefficients);
}

std::size_t degree_of(const std::vector<Powers>& powers) {
  std::size_t degree = 0;
  for (const auto& p : powers) {
    for (std::size_t n = 0; n < p.coefficients.size(); ++n) {
      if (p.coefficients[n] != 0.0) degree = std::max(degree, n);
    }
  }
  return degree;
}

void propose_in_multiplier(const Scene& scene, std::size_t at, std::vector<Proposal>& out) {
  const double scale = scene.model->at(at).get("scale_v");
  const double most = std::pow(scene.boundary[at].size(), 2) / scale;
  const std::vector<Unknown> all = {linear_unknown("scale_v", 0.5 * scale, 2.0 * scale, 0.05 * scale),
                                    linear_unknown("feedthrough", -1.0, 1.0, 0.05),
                                    linear_unknown("z_offset_v", -most, most, 0.05 * most)};
  for (const auto& one : all) out.push_back(change_block(scene, at, {one}));
  out.push_back(change_block(scene, at, all));
}

/// `which` of the errors of the multipliers that make a block's powers; `first_alone`: of that of the square, else those of all powers have
/// the same.
Proposal in_powers(const Scene& scene, std::size_t at, const std::vector<Powers>& powers, bool first_alone,
                   const std::vector<std::size_t>& which) {
  const double size = scene.boundary[at].size();
  const double square = size * size;
  const std::array all = {linear_unknown("scale", 0.5, 2.0, 0.05),
                          linear_unknown("feedthrough", -size, size, 0.05 * size),
                          linear_unknown("offset", -square, square, 0.05 * square)};
  std::vector<Unknown> unknowns;
  std::vector<double> start;
  for (const std::size_t k : which) {
    unknowns.push_back(all[k]);
    start.push_back(kNoErrors[k] + 0.1 * all[k].scale);
  }
  return change_block(scene, at, unknowns, {start}, [=](chain::Block& block, std::span<const double> v) {
    ErrorValues errors = kNoErrors;
    for (std::size_t k = 0; k < which.size(); ++k) errors[which[k]] = v[k];
    for (const auto& p : powers) write_powers(block, p, with_errors(p.coefficients, errors, first_alone));
  });
}

void propose_multiplier_error(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.base_places()) {
    const auto& block = scene.model->at(at);
    if (block.has("scale_v")) propose_in_multiplier(scene, at, out);
    const auto powers = powers_of(block);
    const std::size_t degree = degree_of(powers);
    const bool refitted = std::any_of(block.parameters().begin(), block.parameters().end(),
                                      [](const chain::Parameter& p) { return p.free; });
    if (degree < 2 || refitted) continue;
    std::vector<std::vector<std::size_t>> sets = {{0}, {1}, {0, 1}, {0, 1, 2}};
    // One curve's constant is an offset's; those of two branches differ.
    if (powers.size() > 1) sets.push_back({2});
    for (const bool first_alone : {false, true}) {
      // With squares alone it is the same.
      if (first_alone && degree < 3) continue;
      for (const auto& which : sets) out.push_back(in_powers(scene, at, powers, first_alone, which));
    }
  }
}

}  // namespace

BODESMITH_EFFECT(multiplier_error, .what = "scale, feedthrough or offset of a multiplier in the chain",
                 .experiment = "the disturbance generator alone, swept from end to end",
                 .propose = propose_multiplier_error)

}  // namespace bodesmith::gap
