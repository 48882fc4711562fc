#include "synthesis/generator/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "schematic/writers/parts_table.hpp"
#include "signal/csv.hpp"

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

std::string parts_csv(const Layout& layout) {
  CsvTable table({"part", "role", "series", "wanted_ohm", "realised_ohm", "wanted_f", "realised_f"});
  for (const Part& part : layout.parts) {
    table.add_row(schematic::part_cells(part, part.role));
  }
  return table.text();
}

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

schematic::Netlist Layout::whole() const {
  schematic::Netlist out = generator(amplitude.has_value());
  const schematic::Netlist detector = detector_netlist();
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(out.parts, detector.parts);
  add(out.opamps, detector.opamps);
  add(out.comparators, detector.comparators);
  return out;
}

std::vector<std::string> Layout::ports() const {
  std::vector<std::string> out = {"x", "out"};
  if (amplitude) out.emplace_back("amplitude");
  for (int line = 1; line <= select_lines(); ++line) out.push_back(fmt::format("select{}", line));
  return out;
}

}  // namespace bodesmith::generator
