#include <cmath>
#include <numbers>

#include "base/whole_number.hpp"
#include "chain/block.hpp"
#include "numeric/random.hpp"

namespace bodesmith::chain {
namespace {

/// y = u + a signal that does not depend on u.
class AddedSignal : public BlockType {
 public:
  using BlockType::BlockType;
  std::optional<Complex> response(const Block&, RadPerSecond) const final { return 1.0; }
};

class HumSource final : public SourceKernel {
 public:
  HumSource(double amplitude, double w, double phase) : amplitude_(amplitude), w_(w), phase_(phase) {}
  double value(double t) const override { return amplitude_ * std::sin(w_ * t + phase_); }
  double rate(double t) const override { return amplitude_ * w_ * std::cos(w_ * t + phase_); }

 private:
  double amplitude_;
  double w_;
  double phase_;
};

/// y = u + amplitude sin(2 pi frequency_hz t + phase_deg), t as in the record's time_s.
class Hum final : public AddedSignal {
 public:
  Hum()
      : AddedSignal("hum", "adds a sinusoid of the mains",
                    {any_number("amplitude", "y", "peak, units of the signal"),
                     above_zero("frequency_hz", "Hz", "frequency"),
                     any_number("phase_deg", "deg", "phase at t = 0").with_default(0.0)}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<HumSource>(block.get("amplitude"), Hertz{block.get("frequency_hz")}.rad_s().value,
                                       to_radians(block.get("phase_deg")));
  }
};

class DriftSource final : public SourceKernel {
 public:
  explicit DriftSource(double rate) : rate_(rate) {}
  double value(double t) const override { return rate_ * t; }
  double rate(double) const override { return rate_; }
  bool straight() const override { return true; }

 private:
  double rate_;
};

/// y = u + rate_per_s t, t as in the record's time_s.
class Drift final : public AddedSignal {
 public:
  Drift()
      : AddedSignal("drift", "adds a slow straight line",
                    {any_number("rate_per_s", "y/s", "units of the signal a second")}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<DriftSource>(block.get("rate_per_s"));
  }
};

/// Straight lines between independent normal numbers T apart: variance 2/3 of theirs, two-sided density
/// sigma^2 T sinc^4(fT).
class Octave {
 public:
  Octave(std::uint64_t seed, double interval, double sigma)
      : seed_(seed), interval_(interval), sigma_(sigma) {}
  double value(double t) const {
    const double at = t / interval_;
    const double whole = std::floor(at);
    const auto k = static_cast<std::int64_t>(whole);
    const double a = normal_number(seed_, k);
    return sigma_ * (a + (at - whole) * (normal_number(seed_, k + 1) - a));
  }
  double rate(double t) const {
    const auto k = whole_number<std::int64_t>(std::floor(t / interval_));
    return sigma_ * (normal_number(seed_, k + 1) - normal_number(seed_, k)) / interval_;
  }

 private:
  std::uint64_t seed_;
  double interval_;
  double sigma_;
};

class NoiseSource final : public SourceKernel {
 public:
  explicit NoiseSource(const Block& block) {
    const double density = block.get("density_per_rthz");
    const double bandwidth = block.get("bandwidth_hz");
    const auto seed = static_cast<std::uint64_t>(block.get("seed"));
    // One-sided density 2 sigma^2 T at low frequencies.
    parts_.emplace_back(seed, 0.5 / bandwidth, density * std::sqrt(bandwidth));
    const double corner = block.get("corner_hz");
    if (corner <= 0.0) return;
    // 1/f: one octave of straight lines after the other, each with the power density^2 corner ln 2 of an
    // octave.
    const double sigma = density * std::sqrt(1.5 * corner * std::numbers::ln2);
    std::uint64_t index = 0;
    for (double f = bandwidth; f > block.get("lowest_hz"); f *= 0.5)
      parts_.emplace_back(seed + 1000003ULL * ++index, 0.5 / f, sigma);
  }
  double value(double t) const override {
    double sum = 0.0;
    for (const Octave& part : parts_) sum += part.value(t);
    return sum;
  }
  double rate(double t) const override {
    double sum = 0.0;
    for (const Octave& part : parts_) sum += part.rate(t);
    return sum;
  }

 private:
  std::vector<Octave> parts_;
};

/// y = u + noise of one-sided density density_per_rthz^2 (1 + corner_hz/f) up to about bandwidth_hz (half its
/// power at 0.64 bandwidth), 1/f down to lowest_hz within 1 dB. The same seed is the same signal for every
/// engine. kT/C noise belongs to a switched_capacitor block.
class Noise final : public AddedSignal {
 public:
  Noise()
      : AddedSignal(
            "noise", "adds white and 1/f noise",
            {not_negative("density_per_rthz", "y/√Hz", "white density, units of the signal per root hertz"),
             above_zero("bandwidth_hz", "Hz", "where the noise ends"),
             not_negative("corner_hz", "Hz", "below it 1/f noise is larger; 0: none").with_default(0.0),
             above_zero("lowest_hz", "Hz", "where 1/f noise ends").with_default(1e-3),
             between("seed", "1", "of the random numbers", 0.0, 9e15).with_default(1.0)}) {}
  Kernel kernel(const Block& block) const override { return std::make_unique<NoiseSource>(block); }
};

}  // namespace

BODESMITH_ENTRY(BlockType, hum_block, Hum)
BODESMITH_ENTRY(BlockType, drift_block, Drift)
BODESMITH_ENTRY(BlockType, noise_block, Noise)

}  // namespace bodesmith::chain
