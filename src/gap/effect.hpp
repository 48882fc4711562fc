#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "base/registry.hpp"
#include "gap/proposal.hpp"

namespace bodesmith::gap {

/// One kind of thing that a model can lack. Every effect is one file in effects/ and one line in
/// registry.cpp.
class Effect {
 public:
  virtual ~Effect() = default;
  /// As in the contract's table.
  virtual std::string_view name() const = 0;
  /// A sentence for the report: what it does to a signal.
  virtual std::string_view what() const = 0;
  /// Effects that leave much the same traces.
  virtual std::vector<std::string_view> confused_with() const = 0;
  /// The experiment that tells it from those.
  virtual std::string_view experiment() const = 0;
  /// Shows in a frequency response.
  virtual bool linear() const { return false; }
  /// Need not repeat when the input repeats: it may be missing even where all that repeats is explained.
  virtual bool independent_of_input() const { return false; }
  /// What it adds has a size and no form (a corner, a frequency, a limit) by which it could fit what is only chance.
  virtual bool adds_one_signal() const { return false; }
  /// A model may hold more than one of it (each is another thing, and not one thing with more freedom).
  virtual bool repeatable() const { return false; }
  /// The same in frequency responses, where each shows at a place of its own.
  virtual bool repeatable_in_response() const { return repeatable(); }
  /// Its start values are found in the residual, so they are worth finding from more than one model.
  virtual bool starts_from_residual() const { return false; }
  /// Places of it that a round fits at the most, one more when it is of another form.
  virtual int places_a_round() const { return 2; }
  /// The values of its term, a model's last one, lie where another effect is the usual cause of the same traces (docs/gap.md, 7): when that one
  /// fits as well, it has the name.
  virtual bool is_far_fetched(const Model& /*model*/, const Scene& /*scene*/) const { return false; }
  /// The values of its term in a model make it no name: it is another effect's form (a loop without width is a curve), or
  /// less than the records can tell. `scene`: of that model, or of the one without the term.
  virtual bool is_no_name(const Model& /*model*/, const Term& /*term*/, const Scene& /*scene*/) const {
    return false;
  }
  /// It is a name only where it leaves nothing: what it explains of these records may be another effect's as well.
  virtual bool must_explain_all(const Scene& /*scene*/) const { return false; }
  /// Every place it can sit, with start values from the data.
  virtual void propose(const Scene& scene, std::vector<Proposal>& out) const = 0;
};

/// Whether the one says that it leaves much the same traces as the other.
inline bool is_confused_with(const Effect& effect, const Effect& other) {
  const auto names = effect.confused_with();
  return std::find(names.begin(), names.end(), other.name()) != names.end();
}

/// All of them, in the order of the documentation.
Registry<Effect>& effect_registry();

}  // namespace bodesmith::gap
