#include <algorithm>
#include <cmath>
#include <vector>

#include "synthesis/controller/build.hpp"

/// A gain that is a curve over a voltage: precision rectifiers at its corners, sums of them as control voltages.
namespace bodesmith::controller {
namespace {

/// A threshold takes a resistor of at most so many times the rectifier's own.
constexpr double kReferenceRatio = 50.0;

}  // namespace

void Builder::reference() {
  if (out_.sources.empty()) out_.sources.push_back({"Vref", "ADR4525 (2.5 V)", "vr", kReferenceV});
}

/// One rectifier a corner: -max(0, s_k - s). They rest above their corner, so that beyond the last one the gain is held.
void Builder::build_curve(const GainCurve& curve, BranchGain* gains) {
  enter(curve.group + " curve");
  reference();
  double low_v = kReferenceV;
  std::string low_reference = "vr";
  if (const double least = curve.corner_v.front(); least < kReferenceV / kReferenceRatio) {
    low_reference = "vl";
    const double wanted = std::clamp(25.0 * least, 1e-3, 0.25), lower = 100.0;
    const int up = resistor("Rl1", "low reference", "vr", "vm", lower * (kReferenceV / wanted - 1.0));
    const int down = resistor("Rl2", "low reference", "vm", "0", lower);
    opamp("low reference", "vm", "vl", "vl");
    low_v = kReferenceV * out_.part(down).realised / (out_.part(down).realised + out_.part(up).realised);
  }
  for (std::size_t k = 0; k < curve.corner_v.size(); ++k) {
    const bool low = curve.corner_v[k] < kReferenceV / kReferenceRatio;
    rectifier(curve.rectifier(k), curve.corner_text[k], curve.node, low ? low_reference : "vr",
              (low ? low_v : kReferenceV) / curve.corner_v[k]);
  }
  for (const int b : {0, 1}) {
    if (curve.varies[b]) gains[b].control = control(curve, b, gains[b].at_rest);
  }
}

/// Gains on the rectifiers' nodes and, last, on the reference that make U (K/K0 - 1): each corner's change of
/// slope, the last corner's gain.
std::vector<double> Builder::control_gains(const GainCurve& curve, int b, double at_rest) const {
  const std::vector<double>& k = curve.gain[b];
  const std::size_t n = k.size();
  const double per_gain = out_.multiplier.scale_v / at_rest;
  const auto slope = [&](std::size_t i) {  // of the piece that ends at corner i, V per V of the curve's node
    if (i == 0 || i >= n) return 0.0;
    return per_gain * (k[i] - k[i - 1]) / (curve.corner_v[i] - curve.corner_v[i - 1]);
  };
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(slope(i) - slope(i + 1));
  out.push_back((per_gain * k.back() - out_.multiplier.scale_v) / kReferenceV);
  return out;
}

/// Control voltage of a branch. It counts at the corners, the middles between them, and below the first corner, where the gain
/// must rest.
int Builder::control(const GainCurve& curve, int b, double at_rest) {
  const std::string letter = branch_letter(b);
  enter(curve.group + " gain, " + branch_name(b));
  const std::vector<double> gains = control_gains(curve, b, at_rest);
  const std::vector<double>& corner = curve.corner_v;
  std::vector<double> at = {0.0, 0.5 * corner[0]};
  std::vector<std::string> from;
  for (std::size_t i = 0; i < corner.size(); ++i) {
    from.push_back(curve.rectifier(i));
    at.push_back(corner[i]);
    if (i + 1 < corner.size()) at.push_back(std::sqrt(corner[i] * corner[i + 1]));
  }
  from.emplace_back("vr");
  std::vector<std::vector<double>> rows;
  for (const double s : at) {
    std::vector<double> row;
    for (const double one : corner) row.push_back(-std::max(0.0, one - s));
    row.push_back(kReferenceV);
    double wanted = 0.0;
    for (std::size_t i = 0; i < gains.size(); ++i) wanted += gains[i] * row[i];
    row.push_back(wanted);
    rows.push_back(std::move(row));
  }
  return signed_sum(from, gains, rows, curve.group + " control voltage, " + branch_name(b),
                    curve.control + letter, curve.inverted + letter);
}

}  // namespace bodesmith::controller
