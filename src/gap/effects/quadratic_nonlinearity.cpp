#include "gap/effect.hpp"
#include "gap/effects/power_term.hpp"

namespace bodesmith::gap {
namespace {

class QuadraticNonlinearity final : public Effect {
 public:
  std::string_view name() const override { return "quadratic_nonlinearity"; }
  std::string_view what() const override { return "a smooth even static curve"; }
  std::vector<std::string_view> confused_with() const override {
    return {"offset", "quadratic_stiffness", "saturation"};
  }
  std::string_view experiment() const override {
    return "the same drive at two amplitudes with and without a bias";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    propose_power_term(scene, *this, 2, out);
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, quadratic_nonlinearity_effect, QuadraticNonlinearity)

}  // namespace bodesmith::gap
