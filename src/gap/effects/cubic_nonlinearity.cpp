#include "gap/effect.hpp"
#include "gap/effects/power_term.hpp"

namespace bodesmith::gap {
namespace {

class CubicNonlinearity final : public Effect {
 public:
  std::string_view name() const override { return "cubic_nonlinearity"; }
  std::string_view what() const override { return "a smooth odd static curve"; }
  std::vector<std::string_view> confused_with() const override {
    return {"saturation", "cubic_stiffness", "dead_zone"};
  }
  std::string_view experiment() const override {
    return "the same drive at two amplitudes with and without a bias";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    propose_power_term(scene, *this, 3, out);
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, cubic_nonlinearity_effect, CubicNonlinearity)

}  // namespace bodesmith::gap
