#include "circuit/realisation.hpp"
#include "circuit/stages/stage_chain.hpp"

namespace bodesmith::circuit {
namespace {

class OpAmpRc final : public Realisation {
 public:
  std::string_view name() const override { return "opamp-rc"; }
  std::string_view description() const override { return "chooses a form for each stage"; }
  Outcome<Realised> design(const Sections& sections, const RealiseOptions& options) const override {
    return realise_as_stages(sections, nullptr, options);
  }
};

}  // namespace

const Realisation& opamp_rc() {
  static const OpAmpRc realisation;
  return realisation;
}

Outcome<const StageRealisation*> best_form(const Section& section) {
  const StageRealisation* best = nullptr;
  int highest = 0;
  for (const Realisation* one : realisation_registry().all()) {
    const StageRealisation* form = one->stage_realisation();
    if (form == nullptr || form->bid(section) <= highest || form->refusal(section)) continue;
    highest = form->bid(section);
    best = form;
  }
  if (best == nullptr) return Refusal{"a section fits none of the op-amp RC forms"};
  return best;
}

}  // namespace bodesmith::circuit
