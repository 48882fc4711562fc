#include "synthesis/generator/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "numeric/interpolated.hpp"

namespace bodesmith::generator {

double polynomial(const std::vector<double>& a, double x) {
  double out = 0.0;
  for (std::size_t k = a.size(); k-- > 0;) out = (out + a[k]) * x;
  return out;
}

double peak(const std::vector<double>& a) {
  double out = 0.0;
  for (int i = 0; i <= kPolynomialPoints; ++i)
    out = std::max(out, std::abs(polynomial(a, static_cast<double>(i) / kPolynomialPoints)));
  return out;
}

int degree(const std::vector<double>& a) {
  std::size_t n = a.size();
  while (n > 0 && a[n - 1] == 0.0) --n;
  return static_cast<int>(n);
}

double Layout::wanted(std::size_t branch, double x, double alpha) const {
  const double gain = amplitude ? interpolated(amplitude->alpha, amplitude->wanted[branch], alpha) : 1.0;
  return gain * polynomial(branches[branch].wanted, x);
}

double Layout::realised(std::size_t branch, double x, double alpha) const {
  const double gain = amplitude ? interpolated(amplitude->alpha, amplitude->wanted[branch], alpha) : 1.0;
  return gain * polynomial(branches[branch].realised, x);
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

schematic::Netlist Layout::generator() const {
  return schematic::subset(
      *this, [&](std::size_t one) { return purpose_of(one) != schematic::Purpose::slope_sign; });
}

schematic::Netlist Layout::detector_netlist() const {
  return schematic::subset(
      *this, [&](std::size_t one) { return purpose_of(one) == schematic::Purpose::slope_sign; });
}

std::vector<std::string> Layout::ports() const {
  std::vector<std::string> out = {"x", "out"};
  if (amplitude) out.emplace_back("amplitude");
  for (int line = 1; line <= select_lines(); ++line) out.push_back(fmt::format("select{}", line));
  return out;
}

}  // namespace bodesmith::generator
