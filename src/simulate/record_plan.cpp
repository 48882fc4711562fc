#include "simulate/record_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "chain/kernel.hpp"

namespace bodesmith::simulate {
namespace {

using chain::CurveKernel;
using chain::Kernel;
using chain::LinearKernel;
using chain::OdeKernel;
using chain::SourceKernel;

/// Merged state spaces cost the square of their order.
constexpr std::size_t kMaxMerged = 12;

/// Whether `next` may join: a second delay would hold back what runs beside, and the order stays small.
bool may_join(const RecordStage& stage, const LinearKernel& next) {
  if (next.delay_s > 0.0 && (stage.beside.order() > 0 || stage.beside.offset != 0.0)) return false;
  return stage.merged.order() + next.order() <= kMaxMerged || next.order() == 0;
}

void join_stage(RecordStage& stage, LinearKernel next) {
  if (stage.merged.delay_s > 0.0) {
    stage.beside = chain::in_series(stage.beside, next);
    stage.beside.delay_s = 0.0;
    next.offset = 0.0;
    next.constant.clear();
  }
  stage.merged = chain::in_series(stage.merged, next);
  if (stage.merged.delay_s == 0.0) stage.front = stage.merged.order();
}

}  // namespace

bool KernelSlot::Built::is_of(const chain::Block& block) const {
  const auto& parameters = block.parameters();
  return kernel.has_value() &&
         std::equal(values.begin(), values.end(), parameters.begin(), parameters.end(),
                    [](double value, const auto& parameter) { return value == parameter.value; });
}

bool KernelSlot::refresh(const chain::Block& block) {
  if (now_.is_of(block)) return false;
  std::swap(now_, before_);
  if (now_.is_of(block)) return true;
  now_.kernel.reset();  // should the new one not be had, there is none
  now_.values.clear();
  for (const auto& parameter : block.parameters()) now_.values.push_back(parameter.value);
  now_.kernel = block.kernel();
  return true;
}

std::size_t state_count(const Kernel& kernel) {
  if (const auto* linear = std::get_if<LinearKernel>(&kernel)) return linear->order();
  if (const auto* ode = std::get_if<std::unique_ptr<OdeKernel>>(&kernel)) return (*ode)->linear().order();
  return 0;
}

std::vector<RecordStage> record_stages(const std::vector<KernelSlot>& slots, std::size_t blocks) {
  std::vector<RecordStage> stages;
  std::size_t state = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    const Kernel& kernel = slots[i].kernel();
    const auto* linear = std::get_if<LinearKernel>(&kernel);
    const bool extends =
        linear != nullptr && !stages.empty() && stages.back().linear && may_join(stages.back(), *linear);
    if (!extends) {
      RecordStage stage;
      stage.first = i;
      stage.linear = linear != nullptr;
      stage.state = state;
      stage.merged.d = 1.0;
      stages.push_back(std::move(stage));
    }
    if (linear != nullptr) join_stage(stages.back(), *linear);
    state += state_count(kernel);
  }
  return stages;
}

std::size_t needed_degree(const std::vector<RecordStage>& stages, const std::vector<KernelSlot>& slots,
                          double h) {
  bool straight = true;
  for (const RecordStage& stage : stages) {
    const Kernel& kernel = slots[stage.first].kernel();
    if (stage.linear) {
      const double delay = stage.merged.delay_s / h;
      const bool whole = std::abs(delay - std::round(delay)) < 1e-12;
      const bool dynamics = stage.merged.order() > 0 || !whole;
      if (dynamics && !straight) return 3;
      if (dynamics) straight = false;
    } else if (std::holds_alternative<std::unique_ptr<OdeKernel>>(kernel)) {
      return 3;
    } else if (const auto* source = std::get_if<std::unique_ptr<SourceKernel>>(&kernel)) {
      straight = straight && (*source)->straight();
    } else if (std::holds_alternative<std::unique_ptr<CurveKernel>>(kernel)) {
      straight = false;
    } else {
      if (!straight) return 3;  // an extreme or an edge inside a hold is then met
      straight = false;
    }
  }
  return 1;
}

}  // namespace bodesmith::simulate
