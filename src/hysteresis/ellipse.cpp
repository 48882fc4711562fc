#include "hysteresis/ellipse.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"

namespace bodesmith::hysteresis {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct Place {
  std::size_t low = 0;
  std::size_t high = 0;
  double part = 0.0;
};

Place place(const std::vector<double>& key, double at, bool logarithmic) {
  if (at <= key.front()) return {0, 0, 0.0};
  if (at >= key.back()) return {key.size() - 1, key.size() - 1, 0.0};
  const auto high = static_cast<std::size_t>(std::upper_bound(key.begin(), key.end(), at) - key.begin());
  const double part = logarithmic ? std::log(at / key[high - 1]) / std::log(key[high] / key[high - 1])
                                  : (at - key[high - 1]) / (key[high] - key[high - 1]);
  return {high - 1, high, part};
}

}  // namespace

Ellipse Ellipse::from(const Parameters& values) {
  Ellipse out;
  out.u_0 = values.scalar("u_0");
  out.u_a = values.array("u_A");
  out.frequency_hz = values.array("frequency_hz");
  out.gain = values.array("gain");
  out.phase_rad = values.array("phase_rad");
  out.y_0 = values.array("y_0");
  out.amplitude = values.scalar("amplitude");
  out.operating_hz = values.scalar("operating_hz");
  for (const auto* key : {&out.u_a, &out.frequency_hz}) {
    if (key->empty()) throw DesignError("u_A or frequency_hz is empty");
    for (std::size_t i = 1; i < key->size(); ++i)
      if (!((*key)[i] > (*key)[i - 1])) throw DesignError("u_A or frequency_hz does not rise");
  }
  const std::size_t cells = out.u_a.size() * out.frequency_hz.size();
  if (out.gain.size() != cells || out.phase_rad.size() != cells || out.y_0.size() != cells)
    throw DesignError(
        fmt::format("gain, phase_rad, y_0 have {}, {}, {} numbers, expected {} (u_A times frequency_hz)",
                    out.gain.size(), out.phase_rad.size(), out.y_0.size(), cells));
  return out;
}

Ellipse::Point Ellipse::at(double amplitude_u, double frequency) const {
  const Place a = place(u_a, amplitude_u, false);
  const Place f = place(frequency_hz, frequency, true);
  const std::size_t n = frequency_hz.size();
  const auto mix = [&](const std::vector<double>& table) {
    const double low =
        table[a.low * n + f.low] + f.part * (table[a.low * n + f.high] - table[a.low * n + f.low]);
    const double high =
        table[a.high * n + f.low] + f.part * (table[a.high * n + f.high] - table[a.high * n + f.low]);
    return low + a.part * (high - low);
  };
  return {mix(gain), mix(phase_rad), mix(y_0)};
}

double Ellipse::input_amplitude(double y_a, double frequency) const {
  // G falls or rises slowly with the amplitude: a few rounds are exact enough, and never more than a factor
  // off.
  double a = y_a / at(amplitude, frequency).gain;
  for (int i = 0; i < 60; ++i) {
    const double next = y_a / at(a, frequency).gain;
    if (std::abs(next - a) <= 1e-14 * std::abs(a)) return next;
    a = 0.5 * (a + next);
  }
  return a;
}

Ellipse::Coefficients Ellipse::coefficients(double amplitude_u, double frequency, double sampling_s) const {
  const Point p = at(amplitude_u, frequency);
  const double lead = std::sin(p.phase_rad) / (kTwoPi * frequency * sampling_s);
  return {p.gain * (std::cos(p.phase_rad) + lead), -p.gain * lead,
          p.y_0 - p.gain * std::cos(p.phase_rad) * u_0};
}

Ellipse::Coefficients Ellipse::inverse_coefficients(double y_a, double frequency, double sampling_s) const {
  const Point p = at(input_amplitude(y_a, frequency), frequency);
  const double lead = -std::sin(p.phase_rad) / (kTwoPi * frequency * sampling_s);
  return {(std::cos(p.phase_rad) + lead) / p.gain, -lead / p.gain,
          u_0 - std::cos(p.phase_rad) * p.y_0 / p.gain};
}

void WaveTracker::reset(double value) {
  value_ = value;
  time_ = 0.0;
  direction_ = 0;
  turns_ = 0;
}

void WaveTracker::move(double value, double dt_s) {
  const int direction = value > value_ ? 1 : value < value_ ? -1 : direction_;
  if (direction_ != 0 && direction != direction_) {
    if (turns_ > 0 && time_ > turn_time_ && value_ != turn_value_) {
      amplitude_ = 0.5 * std::abs(value_ - turn_value_);
      frequency_ = 0.5 / (time_ - turn_time_);
    }
    ++turns_;
    turn_value_ = value_;
    turn_time_ = time_;
  }
  direction_ = direction;
  value_ = value;
  time_ += dt_s;
}

EllipseOperator::EllipseOperator(Ellipse model)
    : model_(std::move(model)),
      start_(model_.amplitude, model_.operating_hz),
      wave_(start_),
      u_(model_.u_0) {}

double EllipseOperator::output(double u, double dt_s) const {
  const Ellipse::Point p = model_.at(wave_.amplitude(), wave_.frequency());
  const double slope = dt_s > 0.0 ? (u - u_) / dt_s : 0.0;
  return p.y_0 + p.gain * (std::cos(p.phase_rad) * (u - model_.u_0) +
                           std::sin(p.phase_rad) / (kTwoPi * wave_.frequency()) * slope);
}

double EllipseOperator::reset(double u) {
  wave_ = start_;
  wave_.reset(u);
  u_ = u;
  return output(u, 0.0);
}

double EllipseOperator::step(double u, double dt_s) {
  wave_.move(u, dt_s);
  const double y = output(u, dt_s);
  u_ = u;
  return y;
}

double EllipseOperator::peek(double u, double dt_s) const {
  EllipseOperator copy(*this);
  return copy.step(u, dt_s);
}

EllipseInverse::EllipseInverse(Ellipse model)
    : model_(std::move(model)),
      forward_(model_),
      start_(model_.amplitude * model_.at(model_.amplitude, model_.operating_hz).gain, model_.operating_hz),
      wave_(start_) {
  for (const double g : model_.gain)
    if (!(g > 0.0)) throw DesignError("a gain is not above 0: there is no inverse");
}

double EllipseInverse::reset(double y) {
  wave_ = start_;
  wave_.reset(y);
  y_ = y;
  const Ellipse::Point p = model_.at(model_.amplitude, model_.operating_hz);
  const double u = model_.u_0 + std::cos(p.phase_rad) * (y - p.y_0) / p.gain;
  achieved_ = forward_.reset(u);
  return u;
}

double EllipseInverse::step(double y, double dt_s) {
  wave_.move(y, dt_s);
  const Ellipse::Point p =
      model_.at(model_.input_amplitude(wave_.amplitude(), wave_.frequency()), wave_.frequency());
  const double slope = dt_s > 0.0 ? (y - y_) / dt_s : 0.0;
  const double u = model_.u_0 + (std::cos(p.phase_rad) * (y - p.y_0) -
                                 std::sin(p.phase_rad) / (kTwoPi * wave_.frequency()) * slope) /
                                    p.gain;
  y_ = y;
  achieved_ = forward_.step(u, dt_s);
  return u;
}

SineThrough sine_through(std::span<const double> values, double step_s, double frequency_hz) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
  const auto row = [&](std::size_t i) {
    const double angle = kTwoPi * frequency_hz * step_s * static_cast<double>(i);
    return Eigen::Vector3d(1.0, std::sin(angle), std::cos(angle));
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Eigen::Vector3d r = row(i);
    gram += r * r.transpose();
    rhs += values[i] * r;
  }
  const Eigen::Vector3d x = gram.ldlt().solve(rhs);
  SineThrough out;
  out.mean = x(0);
  out.amplitude = std::hypot(x(1), x(2));
  out.phase_rad = std::atan2(x(2), x(1));
  double left = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) left += std::pow(row(i).dot(x) - values[i], 2);
  out.rms = std::sqrt(left / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
  return out;
}

namespace {

const std::vector<ParameterInfo>& infos() {
  static const std::vector<ParameterInfo> list = {
      optional(scalar("u_0", "u", "centre of the input"), {0.0}),
      array("u_A", "u", "amplitudes of the surfaces, rising", 1e-300),
      array("frequency_hz", "Hz", "frequencies of the surfaces, rising", 1e-300),
      array("gain", "y/u", "G = y_A/u_A, all frequencies of the first amplitude first"),
      array("phase_rad", "rad", "alpha2 - alpha1, below 0 for a lag"),
      array("y_0", "y", "centre of the output"),
      scalar("amplitude", "u", "amplitude assumed before two turning points are known", 1e-300),
      scalar("operating_hz", "Hz", "frequency assumed before two turning points are known", 1e-300),
  };
  return list;
}

void check(const Parameters& values) {
  (void)Ellipse::from(values);
}
std::unique_ptr<Operator> make(const Parameters& values) {
  return std::make_unique<EllipseOperator>(Ellipse::from(values));
}
std::unique_ptr<Inverse> make_inverse_of(const Parameters& values) {
  return std::make_unique<EllipseInverse>(Ellipse::from(values));
}

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
      return std::span<const double>(v.data() + from, to - from);
    };
    const SineThrough u = sine_through(part(record.u), record.step_s, f);
    const SineThrough y = sine_through(part(record.y), record.step_s, f);
    double phase = y.phase_rad - u.phase_rad;
    phase = std::remainder(phase, kTwoPi);
    out.push_back({u.amplitude, f, y.amplitude / u.amplitude, phase, u.mean, y.mean});
  }
  return out;
}

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  struct AtFrequency {
    double frequency;
    std::vector<Period> periods;
  };
  std::vector<AtFrequency> groups;
  for (const TimeRecord& record : records) {
    const std::vector<Period> list = periods_of(record, options.skip_s, options.frequency_hz);
    for (const Period& p : list) {
      auto found = std::find_if(groups.begin(), groups.end(), [&](const AtFrequency& g) {
        return std::abs(g.frequency / p.frequency - 1.0) < 0.08;
      });
      if (found == groups.end()) {
        groups.push_back({p.frequency, {}});
        found = groups.end() - 1;
      }
      found->periods.push_back(p);
    }
  }
  if (groups.empty())
    throw InputError(records[0].file, 0, "holds no whole period of the input, expected at least two");
  std::sort(groups.begin(), groups.end(),
            [](const auto& a, const auto& b) { return a.frequency < b.frequency; });
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  double u_0 = 0.0;
  std::size_t count = 0;
  for (const AtFrequency& g : groups) {
    for (const Period& p : g.periods) {
      low = std::min(low, p.amplitude);
      high = std::max(high, p.amplitude);
      u_0 += p.u_0;
      ++count;
    }
  }
  u_0 /= static_cast<double>(count);
  Ellipse model;
  model.u_0 = u_0;
  const int size = options.size > 0 ? options.size : 6;
  if (high < 1.05 * low || size == 1) {
    model.u_a = {0.5 * (low + high)};
  } else {
    for (int i = 0; i < size; ++i) model.u_a.push_back(low + (high - low) * i / (size - 1));
  }
  for (const AtFrequency& g : groups) {
    double mean = 0.0;
    for (const Period& p : g.periods) mean += p.frequency;
    model.frequency_hz.push_back(mean / static_cast<double>(g.periods.size()));
  }
  // Piecewise linear surfaces by least squares along the amplitude, one frequency after the other; a touch of
  // smoothing fills amplitudes that a frequency has no period of.
  const auto na = static_cast<Eigen::Index>(model.u_a.size());
  const std::size_t nf = groups.size();
  model.gain.resize(model.u_a.size() * nf);
  model.phase_rad = model.y_0 = model.gain;
  Identified out;
  for (std::size_t f = 0; f < nf; ++f) {
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(na, na);
    Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(na, 3);
    for (const Period& p : groups[f].periods) {
      const Place at = place(model.u_a, p.amplitude, false);
      Eigen::VectorXd row = Eigen::VectorXd::Zero(na);
      row(static_cast<Eigen::Index>(at.low)) += 1.0 - at.part;
      row(static_cast<Eigen::Index>(at.high)) += at.part;
      const double y_0 = p.y_mean - p.gain * std::cos(p.phase_rad) * (p.u_0 - u_0);
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
    const Eigen::MatrixXd x = gram.ldlt().solve(rhs);
    Eigen::Vector2d spread = Eigen::Vector2d::Zero();
    for (Eigen::Index i = 0; i < na; ++i) {
      const std::size_t cell = static_cast<std::size_t>(i) * nf + f;
      model.gain[cell] = x(i, 0);
      model.phase_rad[cell] = x(i, 1);
      model.y_0[cell] = x(i, 2);
    }
    for (const Period& p : groups[f].periods) {
      const Ellipse::Point at = model.at(p.amplitude, model.frequency_hz[f]);
      spread += Eigen::Vector2d(std::pow(at.gain - p.gain, 2), std::pow(at.phase_rad - p.phase_rad, 2));
    }
    const auto n = static_cast<double>(groups[f].periods.size());
    const double degrees = std::max(n - static_cast<double>(na), 1.0);
    const Ellipse::Point middle = model.at(0.5 * (low + high), model.frequency_hz[f]);
    const double share =
        std::min(1.0, static_cast<double>(na) / n);  // periods an average node has for itself
    out.uncertainty.push_back({fmt::format("gain at {:.4g} Hz", model.frequency_hz[f]), middle.gain,
                               std::sqrt(spread(0) / degrees * share)});
    out.uncertainty.push_back({fmt::format("phase_rad at {:.4g} Hz", model.frequency_hz[f]), middle.phase_rad,
                               std::sqrt(spread(1) / degrees * share)});
  }
  model.amplitude = groups[0].periods[0].amplitude;
  model.operating_hz = groups[0].periods[0].frequency;
  out.method = fmt::format("sines through {} periods; surfaces of {} amplitudes and {} frequencies", count,
                           model.u_a.size(), nf);
  Parameters values;
  values.set("u_0", model.u_0)
      .set("u_A", model.u_a)
      .set("frequency_hz", model.frequency_hz)
      .set("gain", model.gain);
  values.set("phase_rad", model.phase_rad).set("y_0", model.y_0).set("amplitude", model.amplitude);
  values.set("operating_hz", model.operating_hz);
  out.stage.model = checked_model("ellipse", values);
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace

ModelType ellipse_type() {
  return {"ellipse",       "ellipse over the input, surfaces over amplitude and frequency",
          "001, eq. 1-6",  infos(),
          check,           make,
          make_inverse_of, identify};
}

}  // namespace bodesmith::hysteresis
