#include "simulate/record/record_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/whole_number.hpp"
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
/// Holds of a sample interval in which a switch acts late; fewer where that would more than double the holds of the record.
constexpr std::size_t kParts = 32;
/// A switch that acts nearer to a sample than this part of the interval acts there.
constexpr double kLeastPart = 1e-6;

/// Whether `next` may join: a second delay would hold back what runs alongside, and the order stays small.
bool may_join(const RecordStage& stage, const LinearKernel& next) {
  if (next.delay_s > 0.0 && (stage.undelayed.order() > 0 || stage.undelayed.offset != 0.0)) return false;
  return stage.merged.order() + next.order() <= kMaxMerged || next.order() == 0;
}

void join_stage(RecordStage& stage, LinearKernel next) {
  if (stage.merged.delay_s > 0.0) {
    stage.undelayed = chain::in_series(stage.undelayed, next);
    stage.undelayed.delay_s = 0.0;
    next.offset = 0.0;
    next.constant.clear();
  }
  stage.merged = chain::in_series(stage.merged, next);
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

std::vector<RecordStage> record_stages(const std::vector<KernelSlot>& slots, std::size_t blocks) {
  std::vector<RecordStage> stages;
  for (std::size_t i = 0; i < blocks; ++i) {
    const Kernel& kernel = slots[i].kernel();
    const auto* linear = std::get_if<LinearKernel>(&kernel);
    const bool extends =
        linear != nullptr && !stages.empty() && stages.back().linear && may_join(stages.back(), *linear);
    if (!extends) {
      RecordStage stage;
      stage.first = i;
      stage.linear = linear != nullptr;
      stage.merged.d = 1.0;
      stages.push_back(std::move(stage));
    }
    if (linear != nullptr) join_stage(stages.back(), *linear);
  }
  return stages;
}

/// Delays of the late switches that something stands behind, and of those up to each together, in steps. Empty as well where a
/// propagator goes over a record in one: of pure delays and of clocks.
std::vector<double> late_switches(const std::vector<RecordStage>& stages,
                                  const std::vector<KernelSlot>& slots, double step_s) {
  std::vector<double> late;
  double together = 0.0;
  for (const RecordStage& stage : stages) {
    const Kernel& kernel = slots[stage.first].kernel();
    if (stage.merged.delay_s > 0.0 || std::holds_alternative<std::unique_ptr<chain::SampledKernel>>(kernel))
      return {};
    const auto* memory = std::get_if<std::unique_ptr<chain::MemoryKernel>>(&kernel);
    const double delay = memory == nullptr ? 0.0 : (*memory)->switch_delay_s() / step_s;
    if (!(delay > 0.0) || &stage == &stages.back()) continue;
    late.push_back(delay);
    if (together > 0.0) late.push_back(together + delay);
    together += delay;
  }
  return late;
}

HoldPlan plan_holds(const std::vector<RecordStage>& stages, const std::vector<KernelSlot>& slots,
                    std::span<const double> u, double step_s, std::size_t oversample) {
  const std::size_t intervals = u.size() - 1;
  std::vector<std::pair<std::size_t, double>>
      cuts;  // of intervals, at these parts of them; 1: shorter holds alone
  bool rising = true;
  const std::vector<double> late = late_switches(stages, slots, step_s);
  for (std::size_t i = 0; i < intervals && !late.empty(); ++i) {
    if (u[i + 1] == u[i] || (u[i + 1] > u[i]) == rising) continue;
    rising = !rising;
    cuts.emplace_back(i, 1.0);
    for (const double delay : late) {
      const double whole = std::floor(delay);
      if (whole >= static_cast<double>(intervals - i)) continue;
      const std::size_t at = i + whole_number<std::size_t>(whole);
      cuts.insert(cuts.end(), {{at, delay - whole}, {at, 1.0}, {at + 1, 1.0}});
    }
  }
  std::ranges::sort(cuts);
  const std::size_t parts = std::min(kParts, cuts.empty() ? 1 : intervals / cuts.size() + 1);
  HoldPlan out;
  out.ends.reserve(intervals);
  std::size_t holds = 0;
  const auto add = [&](std::size_t count, double h) {
    if (out.spans.empty() || out.spans.back().h != h) out.spans.push_back({0, h});
    out.spans.back().holds += count;
    holds += count;
  };
  auto cut = cuts.begin();
  for (std::size_t i = 0; i < intervals; ++i) {
    if (cut == cuts.end() || cut->first != i) add(oversample, step_s / static_cast<double>(oversample));
    for (double from = 0.0; cut != cuts.end() && cut->first == i; ++cut) {
      const double length = cut->second - from;
      if (length < kLeastPart || (cut->second < 1.0 && 1.0 - cut->second < kLeastPart)) continue;
      const auto count =
          whole_number<std::size_t>(std::ceil(length * static_cast<double>(parts * oversample)));
      add(count, length * step_s / static_cast<double>(count));
      from = cut->second;
    }
    out.ends.push_back(holds);
  }
  return out;
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
