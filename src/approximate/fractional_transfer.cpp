#include "approximate/fractional_transfer.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

Complex sum(const std::vector<FractionalPower>& terms, double w) {
  Complex out = 0.0;
  for (const FractionalPower& term : terms) {
    out += term.coefficient * std::polar(std::pow(w, term.power), 0.5 * std::numbers::pi * term.power);
  }
  return out;
}

std::vector<FractionalPower> read_terms(const Node& node) {
  std::vector<FractionalPower> out;
  for (const Node& item : node.items()) {
    item.allow_only({"coefficient", "power"});
    out.push_back({item.at("coefficient").number(), item.at("power").non_negative()});
  }
  const bool any =
      std::any_of(out.begin(), out.end(), [](const FractionalPower& t) { return t.coefficient != 0.0; });
  if (!any) node.fail("has no coefficient other than 0");
  return out;
}

/// Equal powers joined, zeros dropped, rising.
std::vector<FractionalPower> tidy(std::vector<FractionalPower> terms) {
  std::sort(terms.begin(), terms.end(), [](const auto& a, const auto& b) { return a.power < b.power; });
  std::vector<FractionalPower> out;
  for (const FractionalPower& term : terms) {
    if (!out.empty() && std::abs(out.back().power - term.power) < 1e-12)
      out.back().coefficient += term.coefficient;
    else
      out.push_back(term);
  }
  out.erase(std::remove_if(out.begin(), out.end(), [](const auto& t) { return t.coefficient == 0.0; }),
            out.end());
  return out;
}

/// Common step of the powers, 0 when none with a denominator up to 60 fits.
double common_step(const std::vector<FractionalPower>& terms) {
  for (int denominator = 1; denominator <= 60; ++denominator) {
    const bool fits = std::all_of(terms.begin(), terms.end(), [&](const FractionalPower& t) {
      return std::abs(t.power * denominator - std::round(t.power * denominator)) < 1e-9;
    });
    if (!fits) continue;
    long common = 0;
    for (const FractionalPower& t : terms) common = std::gcd(common, std::lround(t.power * denominator));
    return common == 0 ? 0.0 : static_cast<double>(common) / denominator;
  }
  return 0.0;
}

}  // namespace

Complex FractionalTransfer::response(RadPerSecond w) const {
  return sum(numerator, w.value) / sum(denominator, w.value);
}

FractionalTransfer FractionalTransfer::from_node(const Node& node) {
  node.expect_schema("fractional");
  node.allow_only({"schema", "numerator", "denominator", "pid"});
  FractionalTransfer out;
  if (node.has("pid")) {
    if (node.has("numerator") || node.has("denominator"))
      node.fail("has both 'pid' and a fraction, expected one of them");
    const Node pid = node.at("pid");
    pid.allow_only({"kp", "ki", "lambda", "kd", "mu"});
    const double kp = pid.number_or("kp", 0.0);
    const double ki = pid.number_or("ki", 0.0);
    const double kd = pid.number_or("kd", 0.0);
    const double lambda = ki != 0.0 ? pid.at("lambda").positive() : 0.0;
    const double mu = kd != 0.0 ? pid.at("mu").positive() : 0.0;
    if (kp == 0.0 && ki == 0.0 && kd == 0.0) pid.fail("has no gain other than 0, expected kp, ki or kd");
    out.numerator = tidy({{ki, 0.0}, {kp, lambda}, {kd, lambda + mu}});
    out.denominator = {{1.0, lambda}};
    return out;
  }
  out.numerator = read_terms(node.at("numerator"));
  out.denominator = read_terms(node.at("denominator"));
  return out;
}

FractionalTransfer FractionalTransfer::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

FractionalStability fractional_stability(const std::vector<FractionalPower>& given) {
  FractionalStability out;
  std::vector<FractionalPower> terms = tidy(given);
  if (terms.empty()) return out;
  out.powers_of_s = terms.front().power;
  for (FractionalPower& term : terms) term.power -= out.powers_of_s;
  out.nearest_to_axis = 1.0;
  if (terms.size() == 1) return out;

  // Frequencies between which any term can matter: outside, the lowest or the highest power rules alone.
  double low = INFINITY;
  double high = 0.0;
  for (size_t i = 0; i < terms.size(); ++i) {
    for (size_t j = i + 1; j < terms.size(); ++j) {
      const double cross = std::pow(std::abs(terms[i].coefficient / terms[j].coefficient),
                                    1.0 / (terms[j].power - terms[i].power));
      low = std::min(low, cross);
      high = std::max(high, cross);
    }
  }
  const double least_gap = [&] {
    double gap = INFINITY;
    for (size_t i = 0; i + 1 < terms.size(); ++i) gap = std::min(gap, terms[i + 1].power - terms[i].power);
    return gap;
  }();
  // A factor of 1e-8 between neighbouring terms.
  const double margin = std::clamp(8.0 / least_gap, 2.0, 120.0);
  double at = std::log(std::max(low, 1e-290)) - margin * std::numbers::ln10;
  const double end = std::log(std::min(high, 1e290)) + margin * std::numbers::ln10;
  at = std::max(at, -600.0);
  const double top = std::min(end, 600.0);
  double step = 0.05;
  Complex now = sum(terms, std::exp(at));
  // From exactly 0: D(0) is the lowest coefficient.
  double turn = std::arg(now / terms.front().coefficient);
  while (at < top) {
    const double next = std::min(top, at + step);
    const double w = std::exp(next);
    const Complex value = sum(terms, w);
    const double change = std::arg(value / now);
    if (std::abs(change) > 0.3 && step > 1e-9) {
      step *= 0.5;
      continue;
    }
    double size = 0.0;
    for (const FractionalPower& term : terms) size += std::abs(term.coefficient) * std::pow(w, term.power);
    out.nearest_to_axis = std::min(out.nearest_to_axis, std::abs(value) / size);
    turn += change;
    now = value;
    at = next;
    if (std::abs(change) < 0.05) step = std::min(0.1, step * 1.5);
  }
  const double degree = terms.back().power;
  // What is left to infinity, where the highest power rules.
  turn += std::arg(terms.back().coefficient *
                   std::polar(1.0, std::fmod(0.5 * std::numbers::pi * degree, 2 * std::numbers::pi)) /
                   (now / std::abs(now)));
  out.unstable_poles =
      static_cast<int>(std::lround((0.5 * std::numbers::pi * degree - turn) / std::numbers::pi));

  out.common_step = common_step(terms);
  const double steps = out.common_step > 0.0 ? degree / out.common_step : 0.0;
  if (steps >= 1.0 && steps <= 120.0) {
    const auto n = static_cast<Eigen::Index>(std::lround(steps));
    // Companion matrix in sigma, scaled so that first and last coefficient have one size.
    const double scale = std::pow(std::abs(terms.front().coefficient / terms.back().coefficient),
                                  1.0 / static_cast<double>(n));
    Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
    for (const FractionalPower& term : terms) {
      const auto k = static_cast<Eigen::Index>(std::lround(term.power / out.common_step));
      if (k == n) continue;
      companion(k, n - 1) =
          -term.coefficient / terms.back().coefficient * std::pow(scale, static_cast<double>(k - n));
    }
    for (Eigen::Index k = 1; k < n; ++k) companion(k, k - 1) = 1.0;
    int count = 0;
    const Eigen::VectorXcd roots = Eigen::EigenSolver<Eigen::MatrixXd>(companion, false).eigenvalues();
    for (const Complex& root : roots) {
      if (std::abs(std::arg(root)) < 0.5 * std::numbers::pi * out.common_step) ++count;
    }
    out.matignon_count = count;
  }
  return out;
}

}  // namespace bodesmith
