#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "chain/block.hpp"
#include "numeric/random.hpp"

namespace bodesmith::chain {
namespace {

/// Transposed direct form II.
class SectionKernel final : public SampledKernel {
 public:
  explicit SectionKernel(const Block& block)
      : clock_hz_(block.get("clock_hz")),
        delay_s_(block.flag("half_cycle") ? 0.5 / clock_hz_ : 0.0),
        seed_(static_cast<std::uint64_t>(block.get("seed"))) {
    const auto numerator = block.list("z_numerator");
    const auto denominator = block.list("z_denominator");
    const std::size_t size = std::max(numerator.size(), denominator.size());
    for (std::size_t i = 0; i < size; ++i) {
      b_.push_back(i < numerator.size() ? numerator[i] / denominator[0] : 0.0);
      a_.push_back(i < denominator.size() ? denominator[i] / denominator[0] : 0.0);
    }
    state_.assign(size, 0.0);
    const double capacitor = block.get("noise_capacitor_f");
    if (capacitor > 0.0) sigma_ = std::sqrt(2.0 * kBoltzmann * block.get("temperature_k") / capacitor);
  }
  double clock_hz() const override { return clock_hz_; }
  double delay_s() const override { return delay_s_; }
  double reset(double u, bool equilibrium) override {
    sample_ = 0;
    std::ranges::fill(state_, 0.0);
    if (!equilibrium) return 0.0;
    double top = 0.0;
    double bottom = 0.0;
    for (std::size_t i = 0; i < b_.size(); ++i) {
      top += b_[i];
      bottom += a_[i];
    }
    const double y = u * top / bottom;
    for (std::size_t i = b_.size(); i-- > 1;) state_[i - 1] = b_[i] * u - a_[i] * y + state_[i];
    return y;
  }
  double update(double u) override {
    if (sigma_ > 0.0) u += sigma_ * normal_number(seed_, sample_);
    ++sample_;
    const double y = b_[0] * u + state_[0];
    for (std::size_t i = 1; i < b_.size(); ++i)
      state_[i - 1] = b_[i] * u - a_[i] * y + (i + 1 < b_.size() ? state_[i] : 0.0);
    return y;
  }

 private:
  double clock_hz_;
  double delay_s_;
  std::uint64_t seed_;
  double sigma_ = 0.0;
  std::int64_t sample_ = 0;
  std::vector<double> b_, a_, state_;
};

/// A switched-capacitor section at its real clock: samples, H(z) = (b0 + b1 z^-1 + ...)/(a0 + a1 z^-1 + ...),
/// output held for a cycle (half a cycle later with half_cycle). With noise_capacitor_f each sample carries
/// the noise of two branches, sigma^2 = 2kT/C.
class SwitchedCapacitor final : public BlockType {
 public:
  SwitchedCapacitor()
      : BlockType(
            "switched_capacitor", "z-domain section, sampled and held at its clock",
            {above_zero("clock_hz", "Hz", "clock"), list_of(any_number("z_numerator", "1", "[b0, b1, ...]")),
             list_of(any_number("z_denominator", "1", "[a0, a1, ...]")),
             flag("half_cycle", "the output appears half a cycle later"),
             not_negative("noise_capacitor_f", "F", "capacitor of the kT/C noise; 0: none").with_default(0.0),
             above_zero("temperature_k", "K", "temperature").with_default(300.0),
             between("seed", "1", "of the random numbers", 0.0, 9e15).with_default(1.0)}) {}
  std::string validate(const Block& block) const override {
    const auto numerator = block.list("z_numerator");
    const auto denominator = block.list("z_denominator");
    if (numerator.empty() || denominator.empty()) return "z_numerator or z_denominator is empty";
    if (denominator[0] == 0.0) return "z_denominator starts with 0, expected a0 other than 0";
    // Jury's criterion by the step-down recursion: every reflection coefficient inside the unit circle.
    std::vector<double> a;
    for (const double v : denominator) a.push_back(v / denominator[0]);
    for (std::size_t n = a.size() - 1; n > 0; --n) {
      const double k = a[n];
      if (!(std::abs(k) < 1.0)) return "z_denominator has a pole that is not inside the unit circle";
      std::vector<double> next(n);
      for (std::size_t i = 0; i < n; ++i) next[i] = (a[i] - k * a[n - i]) / (1.0 - k * k);
      a = std::move(next);
    }
    return {};
  }
  Kernel kernel(const Block& block) const override { return std::make_unique<SectionKernel>(block); }
};

}  // namespace

BODESMITH_ENTRY(BlockType, switched_capacitor_block, SwitchedCapacitor)

}  // namespace bodesmith::chain
