#include "lti/cascade.hpp"

#include <algorithm>
#include <cmath>

#include "approximate/approximate.hpp"
#include "approximate/approximation_error.hpp"
#include "base/whole_number.hpp"
#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

constexpr double kMaxErrorDb = 2e-5;
constexpr int kMaxPoles = 16;

/// H(s) = ((lambda s + 1)/(x lambda s + 1))^beta, disturbance paper eq. 14. Simulated by the mid-band Pade
/// approximation of the lowest order (at most 16 poles) whose complex logarithm stays within that of 2e-5 dB; the error it
/// really has, over all frequencies, is stated in the kernel.
class FractionalLeadLagBlock final : public BlockType {
 public:
  FractionalLeadLagBlock()
      : BlockType("fractional_lead_lag", "((lambda s + 1)/(x lambda s + 1))^beta",
                  {above_zero("lambda_s", "s", "time constant of the first corner"),
                   above_zero("x", "1", "ratio of the second time constant to the first"),
                   any_number("beta", "1", "order")}) {}

  /// Fits run each set of values on several records, and the approximation with its error costs more than such a run: each
  /// thread keeps its last one, of a first corner at 1 rad/s, which lambda only moves.
  Kernel kernel(const Block& block) const override {
    thread_local FractionalLeadLag last{};
    thread_local LinearKernel made = gain_kernel(1.0);
    const FractionalLeadLag term = term_of(block);
    if (term.x != last.x || term.beta != last.beta) {
      const FractionalLeadLag unscaled{1.0, term.x, term.beta};
      made = kernel_of(unscaled);
      last = unscaled;
    }
    return slowed(made, term.lambda_s);
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    return term_of(block).response(w);
  }
  std::optional<Complex> transfer(const Block& block, Complex s) const override {
    const FractionalLeadLag term = term_of(block);
    return std::exp(term.beta *
                    (std::log(1.0 + term.lambda_s * s) - std::log(1.0 + term.x * term.lambda_s * s)));
  }

  double slowest_time_constant_s(const Block& block) const override {
    return block.get("lambda_s") * std::max(1.0, block.get("x"));
  }

 private:
  /// |ln H~ - ln H| over all frequencies. In z of pade_positions, |z| = m there, it is the odd series of 2 (beta - sum x_k^(2j+1))
  /// z^(2j+1)/(2j+1), which begins where Pade's conditions end. Largest at z = -m, at rest, where H = 1: so where the first of them
  /// outweighs the rest, and by evaluation over the circle for kappa 2 to 1e6, beta .04 to .97, 2 to 16 poles.
  static double largest_log_error(const Sections& sections) { return std::abs(std::log(sections.dc_gain())); }
  static LinearKernel kernel_of(const FractionalLeadLag& term) {
    const double kappa = term.corner_ratio();
    if (std::abs(term.beta) < 1e-12 || kappa == 1.0) return gain_kernel(1.0);
    ApproximationOptions options;
    options.method = "pade";
    const int min_order = whole_number(std::ceil(std::abs(term.beta)), 1);
    // No approximation can do with fewer poles than the limit law says; from there on until the error itself
    // is met.
    int order = std::max(min_order, minimax_order(kappa, term.beta, kMaxErrorDb, kMaxPoles));
    Sections made;
    made.sections = value_or_throw(try_term_sections(term, options, order));
    while (largest_log_error(made) > kMaxErrorDb / kDecibelPerNeper && order < kMaxPoles)
      made.sections = value_or_throw(try_term_sections(term, options, ++order));
    LinearKernel out{state_space(made)};
    out.approximation_error = std::expm1(largest_log_error(made));
    return out;
  }
  /// H(lambda s).
  static LinearKernel slowed(LinearKernel kernel, double lambda_s) {
    for (double& rate : kernel.a) rate /= lambda_s;
    for (double& rate : kernel.b) rate /= lambda_s;
    return kernel;
  }
  static FractionalLeadLag term_of(const Block& block) {
    return {block.get("lambda_s"), block.get("x"), block.get("beta")};
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, fractional_lead_lag_block, FractionalLeadLagBlock)

}  // namespace bodesmith::chain
