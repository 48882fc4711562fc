#include "simulate/exact_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "chain/linear_kernel.hpp"
#include "simulate/dense_signal.hpp"
#include "simulate/exact_propagator.hpp"

namespace bodesmith::simulate {
namespace {

using chain::CurveKernel;
using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::SourceKernel;
using Segment = ExactPropagator::Segment;

/// Replaces v(s), a polynomial of s, by p(v(s)).
bool compose(Segment& segment, const std::vector<double>& p) {
  int order = static_cast<int>(p.size()) - 1;
  while (order > 0 && p[static_cast<std::size_t>(order)] == 0.0) --order;
  if (p.empty() || order * segment.degree > ExactPropagator::kMostInputDegree) return false;
  double sum[ExactPropagator::kMostInputDegree + 1] = {p[static_cast<std::size_t>(order)]};
  int degree = 0;
  for (int k = order - 1; k >= 0; --k) {
    double next[ExactPropagator::kMostInputDegree + 1] = {};
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; j <= segment.degree; ++j) next[i + j] += sum[i] * segment.coefficients[j];
    }
    degree += segment.degree;
    next[0] += p[static_cast<std::size_t>(k)];
    std::copy(next, next + ExactPropagator::kMostInputDegree + 1, sum);
  }
  segment.degree = degree;
  std::copy(sum, sum + ExactPropagator::kMostInputDegree + 1, segment.coefficients);
  return true;
}

std::vector<Segment> segments_of(const DenseSignal& signal) {
  std::vector<Segment> out;
  for (const auto& piece : signal.pieces()) {
    Segment s;
    s.begin = piece.begin;
    s.end = piece.end;
    s.degree = 1;
    s.coefficients[0] = piece.nodes[0];
    s.coefficients[1] = piece.nodes[1] - piece.nodes[0];
    out.push_back(s);
  }
  return out;
}

bool by_branches(std::vector<Segment>& segments, const MemoryKernel& memory) {
  const auto up = memory.branch_polynomial(1);
  const auto down = memory.branch_polynomial(-1);
  if (up.empty() || down.empty()) return false;
  bool rising = segments.front().coefficients[0] >= 0.0;
  for (Segment& s : segments) {
    if (s.degree > 1) return false;  // its slope may change sign inside
    if (s.coefficients[1] != 0.0) rising = s.coefficients[1] > 0.0;
    if (!compose(s, rising ? up : down)) return false;
  }
  return true;
}

}  // namespace

std::optional<ExactOutcome> run_exact_engine(const chain::Chain& chain, const TimeRecord& input, Start start,
                                             bool any_input, std::string& why_not) {
  const auto no = [&](std::string reason) {
    why_not = std::move(reason);
    return std::nullopt;
  };
  const std::size_t n = input.size();
  if (n < 2) return no("the record has one sample");
  std::vector<Kernel> kernels;
  for (const auto& block : chain.blocks) kernels.push_back(block.kernel());
  // Cheap refusals first: what a kernel can never be.
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    const auto* curve = std::get_if<std::unique_ptr<CurveKernel>>(&kernels[i]);
    const auto* source = std::get_if<std::unique_ptr<SourceKernel>>(&kernels[i]);
    const auto* memory = std::get_if<std::unique_ptr<MemoryKernel>>(&kernels[i]);
    const bool fits =
        std::holds_alternative<LinearKernel>(kernels[i]) ||
        (curve != nullptr && (*curve)->polynomial() != nullptr) ||
        (source != nullptr && (*source)->straight()) ||
        (memory != nullptr && !(*memory)->branch_polynomial(1).empty() && (*memory)->switch_delay_s() == 0.0);
    if (!fits)
      return no(fmt::format("block {} ({}) is neither linear nor a polynomial", i + 1,
                            chain.blocks[i].type_name()));
  }
  const DenseSignal signal = DenseSignal::from_record(input);
  if (!any_input && signal.pieces().size() > n / 8)
    return no("the input has a corner at nearly every sample");

  std::vector<Segment> segments = segments_of(signal);
  double rest = input.u.front();
  const bool equilibrium = start == Start::equilibrium;
  LinearKernel linear = chain::gain_kernel(1.0);
  double after = 0.0;
  double model_error = 0.0;
  bool dynamic = false;
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    if (const auto* k = std::get_if<LinearKernel>(&kernels[i])) {
      model_error += k->approximation_error;
      if (!dynamic && k->order() == 0 && k->delay_s == 0.0) {
        for (Segment& s : segments) compose(s, {k->offset, k->d});
        rest = k->offset + k->d * rest;
        continue;
      }
      dynamic = true;
      if (k->order() > 0 && after != 0.0)
        return no(fmt::format("a constant enters between dynamics in front of block {}", i + 1));
      if (!k->constant.empty()) return no(fmt::format("block {} is driven by a constant", i + 1));
      after = k->d * after + k->offset;
      LinearKernel plain = *k;
      plain.offset = 0.0;
      linear = chain::in_series(linear, plain);
      continue;
    }
    if (dynamic)
      return no(
          fmt::format("block {} ({}) stands behind linear dynamics", i + 1, chain.blocks[i].type_name()));
    if (const auto* curve = std::get_if<std::unique_ptr<CurveKernel>>(&kernels[i])) {
      rest = (*curve)->value(rest);
      for (Segment& s : segments) {
        if (!compose(s, *(*curve)->polynomial()))
          return no(fmt::format("block {} makes a polynomial of too high a degree", i + 1));
      }
    } else if (const auto* source = std::get_if<std::unique_ptr<SourceKernel>>(&kernels[i])) {
      rest += (*source)->value(input.start_s);
      for (Segment& s : segments) {
        const double at = (*source)->value(s.begin);
        s.degree = std::max(s.degree, 1);
        s.coefficients[0] += at;
        s.coefficients[1] += (*source)->value(s.end) - at;
      }
    } else {
      auto& memory = *std::get<std::unique_ptr<MemoryKernel>>(kernels[i]);
      if (!by_branches(segments, memory)) return no(fmt::format("block {} turns inside a segment", i + 1));
      rest = memory.reset(rest, true);
    }
  }
  ExactOutcome out;
  out.model_error = model_error;
  out.segments = segments.size();
  ModalSystem modes = ModalSystem::from(linear);
  if (!(modes.condition <= ModalSystem::kMostCondition)) {
    return no(
        fmt::format("the linear part has nearly equal poles (its modes are {:.1g} times what they add up to)",
                    modes.condition));
  }
  const double condition = modes.condition;
  ExactPropagator propagator(std::move(modes), input.step_s);
  double before = 0.0;
  if (equilibrium) {
    propagator.rest_under(rest);
    before = rest * response(linear, 0.0).real();
  }
  out.y.assign(n, before + after);
  // With a delay the output at t is that of t - delay: the first samples still show what was before.
  const double shift = linear.delay_s / input.step_s;
  const auto skipped = static_cast<std::size_t>(std::min(std::ceil(shift - 1e-9), static_cast<double>(n)));
  const std::span<double> y(out.y.data() + skipped, n - skipped);
  propagator.run(segments, input.time_s(skipped) - linear.delay_s, y);
  double size = 0.0;
  for (double& v : y) {
    size = std::max(size, std::abs(v));
    v += after;
  }
  out.rounding = 4e-16 * condition * size * (1.0 + static_cast<double>(linear.order()));
  return out;
}

}  // namespace bodesmith::simulate
