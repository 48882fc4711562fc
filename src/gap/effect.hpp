#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/registry.hpp"
#include "gap/proposal.hpp"

namespace bodesmith::gap {

/// What there is to say of an effect.
struct EffectFacts {
  std::string_view name;          ///< as in docs/gap.md
  std::string_view what;          ///< a sentence for the report: what it does to a signal
  std::string_view experiment;    ///< that tells it from those
  bool linear = false;            ///< shows in a frequency response
  std::string_view told_as = {};  ///< the name of which it is another form to whoever reads the answer
  /// A model may hold more than one of it: each is another thing, and not one thing with more freedom.
  bool repeatable = false;
  bool repeatable_in_response =
      false;  ///< the same in frequency responses, where each shows at a place of its own
  /// A circuit whose capacitors and op-amps are known has no dynamics but theirs: next to them this is implausible.
  bool of_no_circuit = false;
  /// What it does is a small part of many other shapes (far above the band a zero is a delay): when another effect fits as well, that has
  /// the name.
  bool far_fetched = false;
  /// Every place it can sit, with start values from the data.
  std::function<void(const Scene&, std::vector<Proposal>&)> propose;
  /// The values of its term in a model make it no name: it is another effect's form (a loop without width is a curve), or
  /// less than the records can tell. The scene is of that model, or of the one without the term.
  std::function<bool(const Model&, const Term&, const Scene&)> is_no_name = {};

  bool may_repeat(bool in_response) const { return repeatable || (in_response && repeatable_in_response); }
};

/// One kind of thing that a model can lack. Every effect is a file in effects/ and one line in registry.cpp.
class Effect {
 public:
  explicit Effect(EffectFacts facts) : facts_(std::move(facts)) {}
  const EffectFacts& facts() const { return facts_; }
  std::string_view name() const { return facts_.name; }
  std::string_view told() const { return facts_.told_as.empty() ? facts_.name : facts_.told_as; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const {
    const std::size_t before = out.size();
    facts_.propose(scene, out);
    for (auto& proposal : std::span(out).subspan(before)) proposal.model.set_effect_of_last(*this);
  }
  bool is_no_name(const Model& model, const Term& term, const Scene& scene) const {
    return facts_.is_no_name && facts_.is_no_name(model, term, scene);
  }
  bool is_implausible(const Model& model) const {
    return facts_.far_fetched || (facts_.of_no_circuit && model.opamps_are_known());
  }

 private:
  EffectFacts facts_;
};

/// Defines the function that the registry's table names.
#define BODESMITH_EFFECT(effect, ...)                        \
  const Effect& effect##_effect() {                          \
    static const Effect one({.name = #effect, __VA_ARGS__}); \
    return one;                                              \
  }

/// All of them, in the order of the documentation.
Registry<Effect>& effect_registry();

}  // namespace bodesmith::gap
