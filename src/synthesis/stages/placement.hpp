#pragma once

#include <memory>
#include <string>
#include <vector>

#include "synthesis/realise.hpp"
#include "synthesis/stages/stage_form.hpp"

namespace bodesmith::circuit {

/// Nodes of one stage of a chain, by their local names: "in" and "out" at the ends of the chain and n1, n2, …
/// between; the stage's own prefixed by s1_, s2_, …
class StageNodes {
 public:
  StageNodes(std::size_t stage, std::size_t stages) : stage_(stage), stages_(stages) {}
  std::string operator()(const std::string& local) const;
  /// Back again.
  static std::string local_name(const Stage& stage, std::size_t index, const std::string& node);

 private:
  std::size_t stage_, stages_;
};

/// A stage with its values, before it is placed in a chain.
struct StageDesign {
  std::string realisation;
  std::vector<StagePart> parts;
  std::vector<StageOpAmp> opamps;
  std::vector<double> wanted_values, realised_values;  ///< in the order of `parts`
  std::vector<Biquad> wanted, realised;                ///< factors of its transfer
  std::shared_ptr<const StageForm> form;               ///< null: no equations
};

/// Adds it as the next of `stages` stages.
void add_stage(Circuit& circuit, const StageDesign& design, std::size_t stages,
               const RealiseOptions& options);

}  // namespace bodesmith::circuit
