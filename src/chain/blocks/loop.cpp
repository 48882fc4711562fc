#include <cmath>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "chain/block.hpp"
#include "chain/inverse.hpp"
#include "hysteresis/polynomial_disturbance.hpp"

namespace bodesmith::chain {
namespace {

using hysteresis::PolynomialDisturbance;

PolynomialDisturbance generator_of(const Block& block) {
  hysteresis::Parameters values;
  for (const char* list :
       {"ascending", "descending", "rate_frequency_hz", "rate_ascending", "rate_descending"})
    values.set(list, block.list(list));
  for (const char* number : {"constant_ascending", "constant_descending", "operating_hz"})
    values.set(number, block.get(number));
  for (const char* none : {"alpha", "alpha_1", "alpha_2"}) values.set(none, std::vector<double>{});
  values.set("minor", std::string_view("slope_sign")).set("amplitude", 1.0).set("switch_delay_s", 0.0);
  return PolynomialDisturbance::from(values);
}

/// The generator of a disturbance and the sum round it. Between changes of branch one curve; it jumps to the other where r turns,
/// or the switch's delay later.
class LoopKernel final : public MemoryKernel {
 public:
  LoopKernel(PolynomialDisturbance generator, double gain, int passes, double delay_s)
      : generator_(std::move(generator)), gain_(gain), passes_(passes), delay_s_(delay_s) {}
  double reset(double r, bool) override {
    r_ = r;
    rising_ = goes_up_ = true;
    since_ = delay_s_;
    return drive(true, r);
  }
  double step(double r, double dt_s) override {
    move(r, dt_s);
    return drive(rising_, r);
  }
  double peek(double r, double dt_s) const override {
    LoopKernel other = *this;
    return other.step(r, dt_s);
  }
  bool has_branches() const override { return true; }
  double on_branch(bool rising, double r) const override { return drive(rising, r); }
  double switch_delay_s() const override { return delay_s_; }
  bool rate_independent() const override { return delay_s_ == 0.0; }

 private:
  void move(double r, double dt_s) {
    if (r != r_ && (r > r_) != goes_up_) {
      goes_up_ = r > r_;
      since_ = 0.0;
    }
    since_ += dt_s;
    if (since_ >= delay_s_) rising_ = goes_up_;
    r_ = r;
  }
  double drive(bool rising, double r) const {
    if (passes_ == 0) return generator_.input_on(rising, gain_ * r);
    double v = r;
    for (int i = 0; i < passes_; ++i) v += gain_ * r - generator_.plain(rising, v);
    return v;
  }

  PolynomialDisturbance generator_;
  double gain_;
  int passes_;
  double delay_s_;
  double r_ = 0.0;
  double since_ = 0.0;  ///< the last turn
  bool rising_ = true, goes_up_ = true;
};

/// v = g r − K(f) d_b(v), b by the sign of r's slope: the controller of a stage that reads its drive, fed by its own drive.
/// `passes` = n: v_k = g r − K d_b(v_(k−1)), v_0 = r, n times (1: the disturbance paper's Fig. 2). Per unit of the full
/// stroke. The stage itself is the polynomial_hysteresis behind it.
class LoopBlock final : public BlockType {
 public:
  LoopBlock()
      : BlockType(
            "loop", "drive v = r - d(v) of a disturbance generator fed by its own drive",
            {above_zero("reference_gain", "1", "g of v = g r - d(v)").with_default(1.0),
             list_of(any_number("ascending", "1", "a1, a2, a3 that the generator makes while r rises")),
             list_of(any_number("descending", "1", "the same while r falls")),
             any_number("constant_ascending", "1", "its offset while r rises").with_default(0.0),
             any_number("constant_descending", "1", "its offset while r falls").with_default(0.0),
             optional_list_of(above_zero("rate_frequency_hz", "Hz", "frequencies of the rate gains, rising")),
             optional_list_of(any_number("rate_ascending", "1", "rate gains of the ascending branch")),
             optional_list_of(any_number("rate_descending", "1", "rate gains of the descending branch")),
             not_negative("operating_hz", "Hz",
                          "frequency at which the rate gains are taken; 0: they are left out")
                 .with_default(0.0),
             between("passes", "1",
                     "times that d is worked out before it is subtracted; 0: fed by its own drive", 0.0, 16.0)
                 .with_default(0.0),
             not_negative("switch_delay_s", "s", "from a turn of r to the other branch").with_default(0.0)}) {
  }
  std::string validate(const Block& block) const override {
    if (block.get("passes") != std::floor(block.get("passes"))) return "passes is no whole number";
    try {
      // Where x + d(x) falls there is no drive, or two.
      if (block.get("passes") == 0.0) hysteresis::PolynomialInverse check(generator_of(block));
    } catch (const DesignError& error) {
      return error.what();
    }
    return {};
  }
  Kernel kernel(const Block& block) const override {
    return std::make_unique<LoopKernel>(generator_of(block), block.get("reference_gain"),
                                        whole_number<int>(block.get("passes")), block.get("switch_delay_s"));
  }
  /// Of the loop g r = v + K d(v), by the direction of v.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    if (block.get("passes") != 0.0) return std::nullopt;
    hysteresis::PolynomialOperator forward(generator_of(block));
    FoundInput out;
    for (const double v : wanted.values)
      out.values.push_back((out.values.empty() ? forward.reset(v) : forward.step(v, wanted.step_s)) /
                           block.get("reference_gain"));
    return out;
  }
  std::vector<PolynomialList> polynomials() const override { return {{"ascending", 0}, {"descending", 0}}; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, loop_block, LoopBlock)

}  // namespace bodesmith::chain
