#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "hysteresis/ellipse.hpp"
#include "hysteresis/identification/record_tools.hpp"
#include "hysteresis/model_type.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::hysteresis {

SineThrough sine_through(std::span<const double> values, double step_s, double frequency_hz) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
  const auto row = [&](std::size_t i) {
    const double angle = 2.0 * std::numbers::pi * frequency_hz * step_s * static_cast<double>(i);
    return Eigen::Vector3d(1.0, std::sin(angle), std::cos(angle));
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Eigen::Vector3d r = row(i);
    gram += r * r.transpose();
    rhs += values[i] * r;
  }
  const Eigen::Vector3d x = solve_ldlt(gram, rhs);
  return {.mean = x(0), .amplitude = std::hypot(x(1), x(2)), .phase_rad = std::atan2(x(2), x(1))};
}

namespace {

/// One period of a record seen as an ellipse.
struct Period {
  double amplitude, frequency, gain, phase_rad, u_0, y_mean;
};

std::vector<Period> periods_of(const TimeRecord& record, double skip_s, double given_hz) {
  std::vector<Period> out;
  const std::size_t first = first_counted(record, skip_s);
  const std::vector<Branch> list = branches(record.u, 0.02);
  for (std::size_t b = 1; b + 2 < list.size(); b += 2) {
    // From one turning point to the next but one.
    const std::size_t from = list[b].first;
    const std::size_t to = list[b + 1].last;
    if (from < first || to - from < 8) continue;
    const double f = given_hz > 0.0 ? given_hz : 1.0 / (record.step_s * static_cast<double>(to - from));
    const auto part = [&](const std::vector<double>& v) {
      return std::span<const double>(v).subspan(from, to - from);
    };
    const SineThrough u = sine_through(part(record.u), record.step_s, f);
    const SineThrough y = sine_through(part(record.y), record.step_s, f);
    double phase = y.phase_rad - u.phase_rad;
    phase = std::remainder(phase, 2.0 * std::numbers::pi);
    out.push_back({u.amplitude, f, y.amplitude / u.amplitude, phase, u.mean, y.mean});
  }
  return out;
}

/// The periods of (nearly) one frequency.
struct PeriodGroup {
  double frequency = 0.0;
  std::vector<Period> periods;
};

/// Rising in frequency. Throws InputError when there is no whole period.
std::vector<PeriodGroup> period_groups(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  std::vector<PeriodGroup> groups;
  for (const TimeRecord& record : records) {
    for (const Period& p : periods_of(record, options.skip_s, options.frequency_hz)) {
      auto found = std::ranges::find_if(
          groups, [&](const PeriodGroup& g) { return std::abs(g.frequency / p.frequency - 1.0) < 0.08; });
      if (found == groups.end()) {
        groups.push_back({p.frequency, {}});
        found = groups.end() - 1;
      }
      found->periods.push_back(p);
    }
  }
  if (groups.empty())
    throw InputError(records[0].file, 0, "holds no whole period of the input, expected at least two");
  std::ranges::sort(groups, [](const auto& a, const auto& b) { return a.frequency < b.frequency; });
  return groups;
}

/// The model's nodes: amplitudes evenly over those of the periods, the groups' mean frequencies.
Ellipse ellipse_nodes(const std::vector<PeriodGroup>& groups, Range amplitudes, double u_0, int size) {
  Ellipse model;
  model.u_0 = u_0;
  if (amplitudes.high < 1.05 * amplitudes.low || size == 1) {
    model.u_a = {amplitudes.middle()};
  } else {
    for (int i = 0; i < size; ++i)
      model.u_a.push_back(amplitudes.low + (amplitudes.high - amplitudes.low) * i / (size - 1));
  }
  for (const PeriodGroup& g : groups) {
    double mean = 0.0;
    for (const Period& p : g.periods) mean += p.frequency;
    model.frequency_hz.push_back(mean / static_cast<double>(g.periods.size()));
  }
  model.gain.resize(model.u_a.size() * groups.size());
  model.phase_rad = model.y_0 = model.gain;
  model.amplitude = groups[0].periods[0].amplitude;
  model.operating_hz = groups[0].periods[0].frequency;
  return model;
}

/// Piecewise linear surfaces by least squares along the amplitude, at frequency f; a touch of smoothing fills
/// amplitudes that the frequency has no period of.
void fit_surfaces(Ellipse& model, std::size_t f, const std::vector<Period>& periods) {
  const Eigen::Index na = eigen_index(model.u_a.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(na, na);
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(na, 3);
  for (const Period& p : periods) {
    const Ellipse::Place at = model.place_of_amplitude(p.amplitude);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(na);
    row(eigen_index(at.low)) += 1.0 - at.part;
    row(eigen_index(at.high)) += at.part;
    const double y_0 = p.y_mean - p.gain * std::cos(p.phase_rad) * (p.u_0 - model.u_0);
    gram += row * row.transpose();
    rhs += row * Eigen::RowVector3d(p.gain, p.phase_rad, y_0);
  }
  for (Eigen::Index i = 0; i + 1 < na; ++i) {
    const double weight = 1e-3;
    gram(i, i) += weight;
    gram(i + 1, i + 1) += weight;
    gram(i, i + 1) -= weight;
    gram(i + 1, i) -= weight;
  }
  const Eigen::MatrixXd x = solve_ldlt_columns(gram, rhs);
  for (std::size_t a = 0; a < model.u_a.size(); ++a) {
    const std::size_t cell = a * model.frequency_hz.size() + f;
    model.gain[cell] = x(eigen_index(a), 0);
    model.phase_rad[cell] = x(eigen_index(a), 1);
    model.y_0[cell] = x(eigen_index(a), 2);
  }
}

/// Of gain and phase at frequency f in the middle of the amplitudes, from what the periods scatter.
void add_surface_uncertainty(const Ellipse& model, std::size_t f, const std::vector<Period>& periods,
                             double middle_amplitude, std::vector<ParameterUncertainty>& out) {
  const double frequency = model.frequency_hz[f];
  Eigen::Vector2d spread = Eigen::Vector2d::Zero();
  for (const Period& p : periods) {
    const Ellipse::Point at = model.at(p.amplitude, frequency);
    spread += Eigen::Vector2d(std::pow(at.gain - p.gain, 2), std::pow(at.phase_rad - p.phase_rad, 2));
  }
  const auto n = static_cast<double>(periods.size());
  const auto nodes = static_cast<double>(model.u_a.size());
  const double degrees = std::max(n - nodes, 1.0);
  const double share = std::min(1.0, nodes / n);  // periods an average node has for itself
  const Ellipse::Point middle = model.at(middle_amplitude, frequency);
  out.push_back(
      {fmt::format("gain at {:.4g} Hz", frequency), middle.gain, std::sqrt(spread(0) / degrees * share)});
  out.push_back({fmt::format("phase_rad at {:.4g} Hz", frequency), middle.phase_rad,
                 std::sqrt(spread(1) / degrees * share)});
}

}  // namespace

Identified identify_ellipse(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const std::vector<PeriodGroup> groups = period_groups(records, options);
  Range amplitudes;
  double u_0 = 0.0;
  std::size_t count = 0;
  for (const PeriodGroup& g : groups) {
    for (const Period& p : g.periods) {
      amplitudes.include(p.amplitude);
      u_0 += p.u_0;
      ++count;
    }
  }
  u_0 /= static_cast<double>(count);
  Ellipse model = ellipse_nodes(groups, amplitudes, u_0, options.size > 0 ? options.size : 6);
  Identified out;
  for (std::size_t f = 0; f < groups.size(); ++f) {
    fit_surfaces(model, f, groups[f].periods);
    add_surface_uncertainty(model, f, groups[f].periods, amplitudes.middle(), out.uncertainty);
  }
  out.method = fmt::format("sines through {} periods; surfaces of {} amplitudes and {} frequencies", count,
                           model.u_a.size(), groups.size());
  out.model = make_model("ellipse", Parameters()
                                        .set("u_0", model.u_0)
                                        .set("u_A", model.u_a)
                                        .set("frequency_hz", model.frequency_hz)
                                        .set("gain", model.gain)
                                        .set("phase_rad", model.phase_rad)
                                        .set("y_0", model.y_0)
                                        .set("amplitude", model.amplitude)
                                        .set("operating_hz", model.operating_hz));
  return out;
}

}  // namespace bodesmith::hysteresis
