#include "lti/fractional_lead_lag.hpp"

#include <algorithm>
#include <cmath>

#include "approximate/approximate.hpp"
#include "approximate/limit_law.hpp"
#include "chain/blocks/block_list.hpp"
#include "chain/linear_kernel.hpp"

namespace bodesmith::chain {
namespace {

/// H(s) = ((lambda s + 1)/(x lambda s + 1))^beta, first seed eq. 14. Simulated by the mid-band Pade
/// approximation of the lowest order (at most 16) whose limit is below 1e-5 dB; the error it really has, over
/// all frequencies, is stated in the kernel.
class FractionalLeadLagBlock final : public NamedBlockType {
 public:
  FractionalLeadLagBlock()
      : NamedBlockType("fractional_lead_lag", "((lambda s + 1)/(x lambda s + 1))^beta",
                       {above_zero("lambda_s", "time constant of the first corner"),
                        above_zero("x", "ratio of the second time constant to the first"),
                        any_number("beta", "order")}) {}

  Kernel kernel(const Block& block) const override {
    const FractionalLeadLag term = term_of(block);
    const double kappa = term.corner_ratio();
    if (term.beta == 0.0 || kappa == 1.0) return gain_kernel(1.0);
    const int least = static_cast<int>(std::ceil(std::abs(term.beta)));
    const int order =
        std::clamp(minimax_order(kappa, term.beta, 1e-5, 16), std::max(1, least), std::max(16, least));
    ApproximationOptions options;
    options.method = "pade";
    const TermApproximation got = approximate_term(term, options, order);
    LinearKernel out = gain_kernel(1.0);
    for (const Section& section : got.sections) out = in_series(out, section_kernel(section));
    out.approximation_error = std::hypot(std::expm1(got.error.everywhere_db / kDecibelPerNeper),
                                         to_radians(got.error.everywhere_deg));
    return out;
  }
  std::optional<std::complex<double>> response(const Block& block, RadPerSecond w) const override {
    return term_of(block).response(w);
  }

 private:
  static FractionalLeadLag term_of(const Block& block) {
    return {block.get("lambda_s"), block.get("x"), block.get("beta")};
  }
};

}  // namespace

const BlockType& fractional_lead_lag_block() {
  static const FractionalLeadLagBlock type;
  return type;
}

}  // namespace bodesmith::chain
