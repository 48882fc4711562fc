#include "signal/disturbance.hpp"
#include "base/documents/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/hertz_values.hpp"
#include "numeric/interpolated.hpp"

namespace bodesmith {
namespace {

/// A disturbance is a share of the range: sums of such numbers and of their products stay numbers.
void check_sizes(const Node& node, const std::vector<double>& values) {
  constexpr double kLargest = 1e6;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i]) > kLargest) node[i].fail(fmt::format("is {}, expected at most 1e6", values[i]));
  }
}

std::array<double, 3> read_coefficients(const Node& node) {
  const std::vector<double> values = node.numbers();
  if (values.size() != 3) node.fail(fmt::format("has {} numbers, expected [a1, a2, a3]", values.size()));
  check_sizes(node, values);
  return {values[0], values[1], values[2]};
}

/// Checks a table: one length, at least one entry, first column rising and above 0, gains of a size that makes sense.
void check_table(const Node& node, std::string_view first, const std::vector<double>& key,
                 std::size_t ascending, std::size_t descending) {
  if (key.empty()) node.at(first).fail("is empty, expected at least one number");
  if (ascending != key.size() || descending != key.size()) {
    node.fail(fmt::format("has columns of {}, {} and {} numbers, expected one length", key.size(), ascending,
                          descending));
  }
  for (std::size_t i = 0; i < key.size(); ++i) {
    if (!(key[i] > 0.0) || (i > 0 && !(key[i] > key[i - 1]))) {
      node.at(first)[i].fail("is out of order, expected rising numbers above 0");
    }
    if (!(key[i] >= 1e-6 && key[i] <= 1e9)) node.at(first)[i].fail("is not within 1e-6 to 1e9");
  }
  for (const char* branch : {"ascending", "descending"})
    check_sizes(node.at(branch), node.at(branch).numbers());
}

}  // namespace

double Disturbance::rate_gain(Branch branch, Hertz frequency) const {
  if (rate.frequency.empty()) return 1.0;
  std::vector<double> key;
  for (const Hertz f : rate.frequency) key.push_back(std::log(f.value));
  return interpolated(key, rate.of(branch), std::log(frequency.value));
}

double Disturbance::steepest(Branch branch, double to) const {
  // d' is a parabola: its ends and, where that lies inside, its vertex.
  const std::array<double, 3>& a = coefficients(branch);
  double most = std::max(std::abs(slope(branch, 0.0)), std::abs(slope(branch, to)));
  const double vertex = a[2] == 0.0 ? -1.0 : -a[1] / (3.0 * a[2]);
  if (vertex > 0.0 && vertex < to) most = std::max(most, std::abs(slope(branch, vertex)));
  return most;
}

Disturbance Disturbance::at(double alpha, std::optional<Hertz> operating) const {
  Disturbance out;
  for (const Branch branch : kBranches) {
    double scale = amplitude.at(branch, alpha);
    for (std::size_t i = 0; i < 3; ++i) {
      scale /= alpha;
      out.coefficients(branch)[i] = scale * coefficients(branch)[i];
      if (operating) out.coefficients(branch)[i] *= rate_gain(branch, *operating);
    }
  }
  return out;
}

double Disturbance::AmplitudeGains::at(Branch branch, double stroke) const {
  if (alpha.empty()) return stroke;
  return interpolated(alpha, of(branch), stroke) * std::min(stroke / alpha.front(), 1.0);
}

std::string_view to_string(Disturbance::Branch branch) {
  return branch == Disturbance::Branch::ascending ? "ascending" : "descending";
}

Disturbance Disturbance::at_load(double stroke) const {
  if (!(stroke > 0.0 && stroke <= 1.0))
    throw InputError(
        fmt::format("a load leaves {} of the stroke, expected a share above 0, at most 1", stroke));
  if (amplitude.alpha.empty())
    throw InputError("the disturbance has no amplitude gains: what a shorter stroke does is not known");
  Disturbance out = *this;
  out.amplitude = {};
  for (const double alpha : amplitude.alpha) {
    if (alpha < stroke * (1.0 - 1e-9)) out.amplitude.alpha.push_back(alpha / stroke);
  }
  out.amplitude.alpha.push_back(1.0);
  for (const Branch branch : kBranches) {
    const double full = amplitude.at(branch, stroke);
    if (!(std::abs(full) > 0.0))
      throw InputError("an amplitude gain is 0 at the load's stroke, expected another");
    for (const double alpha : out.amplitude.alpha)
      out.amplitude.of(branch).push_back(amplitude.at(branch, alpha * stroke) / full);
    for (double& a : out.coefficients(branch)) a *= full / stroke;
  }
  return out;
}

bool Disturbance::is_static(Branch branch) const {
  return std::all_of(rate.of(branch).begin(), rate.of(branch).end(),
                     [](double gain) { return std::abs(gain - 1.0) < 1e-12; });
}

Disturbance Disturbance::from_node(const Node& node) {
  node.expect_schema("disturbance");
  Disturbance out;
  out.ascending = read_coefficients(node.at("ascending"));
  out.descending = read_coefficients(node.at("descending"));
  if (node.has("amplitude")) {
    const Node table = node.at("amplitude");
    out.amplitude.alpha = table.at("alpha").numbers();
    out.amplitude.ascending = table.at("ascending").numbers();
    out.amplitude.descending = table.at("descending").numbers();
    check_table(table, "alpha", out.amplitude.alpha, out.amplitude.ascending.size(),
                out.amplitude.descending.size());
  }
  if (node.has("rate")) {
    const Node table = node.at("rate");
    const std::vector<double> frequency = table.at("frequency_hz").numbers();
    for (const double f : frequency) out.rate.frequency.push_back(Hertz{f});
    out.rate.ascending = table.at("ascending").numbers();
    out.rate.descending = table.at("descending").numbers();
    check_table(table, "frequency_hz", frequency, out.rate.ascending.size(), out.rate.descending.size());
  }
  return out;
}

Disturbance Disturbance::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

Json Disturbance::to_json() const {
  Json out = {{"ascending", ascending}, {"descending", descending}};
  if (!amplitude.alpha.empty()) {
    out["amplitude"] = {
        {"alpha", amplitude.alpha}, {"ascending", amplitude.ascending}, {"descending", amplitude.descending}};
  }
  if (!rate.frequency.empty()) {
    out["rate"] = {{"frequency_hz", hertz_values(rate.frequency)},
                   {"ascending", rate.ascending},
                   {"descending", rate.descending}};
  }
  return out;
}

std::vector<double> cubic_of(const std::function<double(double)>& f) {
  const double y[] = {f(0.0), f(1.0 / 3.0), f(2.0 / 3.0), f(1.0)};
  // Newton's divided differences, multiplied out.
  const double d1 = y[1] - y[0];
  const double d2 = y[2] - 2.0 * y[1] + y[0];
  const double d3 = y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0];
  return {y[0], 3.0 * d1 - 1.5 * d2 + d3, 4.5 * d2 - 4.5 * d3, 4.5 * d3};
}

}  // namespace bodesmith
