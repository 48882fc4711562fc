#include "hysteresis/ellipse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"

namespace bodesmith::hysteresis {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

Ellipse::Place place(const std::vector<double>& key, double at, bool logarithmic) {
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
  out.u_0 = values.number("u_0");
  out.u_a = values.list("u_A");
  out.frequency_hz = values.list("frequency_hz");
  out.gain = values.list("gain");
  out.phase_rad = values.list("phase_rad");
  out.y_0 = values.list("y_0");
  out.amplitude = values.number("amplitude");
  out.operating_hz = values.number("operating_hz");
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

Ellipse::Place Ellipse::place_of_amplitude(double amplitude_u) const {
  return place(u_a, amplitude_u, false);
}

Ellipse::Point Ellipse::at(double amplitude_u, double frequency) const {
  const Place a = place_of_amplitude(amplitude_u);
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

namespace {

class EllipseType final : public ShapedModelType<Ellipse, EllipseOperator, EllipseInverse> {
 public:
  EllipseType()
      : ShapedModelType(
            "ellipse", "ellipse over the input, surfaces over amplitude and frequency",
            {
                any_number("u_0", "u", "centre of the input").with_default(0.0),
                list_of(above_zero("u_A", "u", "amplitudes of the surfaces, rising")),
                list_of(above_zero("frequency_hz", "Hz", "frequencies of the surfaces, rising")),
                list_of(
                    any_number("gain", "y/u", "G = y_A/u_A, all frequencies of the first amplitude first")),
                list_of(any_number("phase_rad", "rad", "alpha2 - alpha1, below 0 for a lag")),
                list_of(any_number("y_0", "y", "centre of the output")),
                above_zero("amplitude", "u", "amplitude assumed before two turning points are known"),
                above_zero("operating_hz", "Hz", "frequency assumed before two turning points are known"),
            }) {}
  bool for_steady_sines() const override { return true; }

 protected:
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_ellipse(records, options);
  }
};

}  // namespace

BODESMITH_ENTRY(ModelType, ellipse_type, EllipseType)

}  // namespace bodesmith::hysteresis
