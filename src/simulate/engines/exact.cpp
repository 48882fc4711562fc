// Closed form: a chain whose signal stays a polynomial of time between the corners of its input until it
// meets linear dynamics: gains and straight sources, then at most one polynomial curve or one hysteresis of
// polynomial branches, then linear blocks and delays, by the modes of the linear part (exact_propagator.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/whole_number.hpp"
#include "chain/kernel.hpp"
#include "simulate/engines/engine.hpp"
#include "simulate/record/dense_signal.hpp"
#include "simulate/record/exact_propagator.hpp"

namespace bodesmith::simulate {
namespace {

using chain::CurveKernel;
using chain::Kernel;
using chain::LinearKernel;
using chain::MemoryKernel;
using chain::OdeKernel;
using chain::SampledKernel;
using chain::SourceKernel;
using ExactSegment = ExactPropagator::Segment;
constexpr std::size_t kMaxPolynomial = ExactPropagator::kMaxInputDegree;

/// Replaces v(s), a polynomial of s, by p(v(s)). False, and nothing done, when its degree were too high.
bool compose(ExactSegment& segment, const std::vector<double>& p) {
  if (p.empty()) return false;
  std::size_t order = p.size() - 1;
  while (order > 0 && p[order] == 0.0) --order;
  if (order * segment.degree > kMaxPolynomial) return false;
  double sum[kMaxPolynomial + 1] = {p[order]};
  std::size_t degree = 0;
  for (std::size_t k = order; k-- > 0;) {
    double next[kMaxPolynomial + 1] = {};
    for (std::size_t i = 0; i <= degree; ++i) {
      for (std::size_t j = 0; j <= segment.degree; ++j) next[i + j] += sum[i] * segment.coefficients[j];
    }
    degree += segment.degree;
    next[0] += p[k];
    std::copy(next, next + kMaxPolynomial + 1, sum);
  }
  segment.degree = degree;
  std::copy(sum, sum + kMaxPolynomial + 1, segment.coefficients);
  return true;
}

std::vector<ExactSegment> straight_segments(const DenseSignal& signal) {
  std::vector<ExactSegment> out;
  for (const auto& piece : signal.pieces()) {
    ExactSegment s;
    s.begin = piece.begin;
    s.end = piece.end;
    s.degree = 1;
    s.coefficients[0] = piece.nodes[0];
    s.coefficients[1] = piece.nodes[1] - piece.nodes[0];
    out.push_back(s);
  }
  return out;
}

/// False when the input turns, or may turn, inside a segment.
bool by_branches(std::vector<ExactSegment>& segments, const MemoryKernel& memory) {
  const auto up = memory.branch_polynomial(true);
  const auto down = memory.branch_polynomial(false);
  if (up.empty() || down.empty()) return false;
  bool rising = segments.front().coefficients[0] >= 0.0;
  for (ExactSegment& s : segments) {
    if (s.degree > 1) return false;
    if (s.coefficients[1] != 0.0) rising = s.coefficients[1] > 0.0;
    if (!compose(s, rising ? up : down)) return false;
  }
  return true;
}

/// Whether a block can ever be worked out so: cheap to ask.
struct MayHaveClosedForm {
  bool operator()(const LinearKernel&) const { return true; }
  bool operator()(const std::unique_ptr<CurveKernel>& k) const { return k->polynomial() != nullptr; }
  bool operator()(const std::unique_ptr<SourceKernel>& k) const { return k->straight(); }
  bool operator()(const std::unique_ptr<MemoryKernel>& k) const {
    return !k->branch_polynomial(true).empty() && k->switch_delay_s() == 0.0;
  }
  bool operator()(const std::unique_ptr<OdeKernel>&) const { return false; }
  bool operator()(const std::unique_ptr<SampledKernel>&) const { return false; }
};

/// The input's polynomials through the blocks in front of the dynamics, and these as one linear system.
class ClosedForm {
 public:
  ClosedForm(const chain::Chain& chain, const TimeRecord& input)
      : chain_(chain), input_(input), rest_(input.u.front()) {}

  using Refusal = std::optional<NoClosedForm>;
  Refusal build(bool any_input);
  std::variant<Result, NoClosedForm> run(Start start) const;

 private:
  Refusal add(std::size_t block, const LinearKernel& linear);
  Refusal add(std::size_t block, const std::unique_ptr<CurveKernel>& curve);
  Refusal add(std::size_t block, const std::unique_ptr<SourceKernel>& source);
  Refusal add(std::size_t block, const std::unique_ptr<MemoryKernel>& memory);
  template <class Other>
  Refusal add(std::size_t block, const std::unique_ptr<Other>&) {
    return no_polynomial(block);
  }
  NoClosedForm no_polynomial(std::size_t block) const {
    return {fmt::format("block {} ({}) is neither linear nor a polynomial", block + 1,
                        chain_.blocks[block].type_name())};
  }

  const chain::Chain& chain_;
  const TimeRecord& input_;
  std::vector<ExactSegment> segments_;
  double rest_;                                    ///< of the polynomial signal, before the start
  LinearKernel linear_ = chain::gain_kernel(1.0);  ///< the dynamics without offsets
  double after_ = 0.0;                             ///< what the offsets add behind them
  double model_error_ = 0.0;
  bool dynamic_ = false;
};

ClosedForm::Refusal ClosedForm::build(bool any_input) {
  if (input_.size() < 2) return NoClosedForm{"the record has one sample"};
  std::vector<Kernel> kernels;
  for (const auto& block : chain_.blocks) kernels.push_back(block.kernel());
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    if (!std::visit(MayHaveClosedForm{}, kernels[i])) return no_polynomial(i);
  }
  const std::size_t most = input_.size() / 8;
  if (!any_input && DenseSignal::count_lines(input_, most) > most)
    return NoClosedForm{"the input has a corner at nearly every sample"};
  segments_ = straight_segments(DenseSignal::from_record(input_));
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    if (dynamic_ && !std::holds_alternative<LinearKernel>(kernels[i])) {
      return NoClosedForm{
          fmt::format("block {} ({}) follows linear dynamics", i + 1, chain_.blocks[i].type_name())};
    }
    if (auto refusal = std::visit([&](const auto& kernel) { return add(i, kernel); }, kernels[i]))
      return refusal;
  }
  return std::nullopt;
}

ClosedForm::Refusal ClosedForm::add(std::size_t block, const LinearKernel& k) {
  model_error_ += k.approximation_error;
  if (!dynamic_ && k.order() == 0 && k.delay_s == 0.0) {
    for (ExactSegment& s : segments_) compose(s, {k.offset, k.d});
    rest_ = k.offset + k.d * rest_;
    return std::nullopt;
  }
  dynamic_ = true;
  if (k.order() > 0 && after_ != 0.0) {
    return NoClosedForm{fmt::format("a constant enters between dynamics in front of block {}", block + 1)};
  }
  if (!k.constant.empty()) {
    return NoClosedForm{fmt::format("block {} is driven by a constant", block + 1)};
  }
  after_ = k.d * after_ + k.offset;
  LinearKernel plain = k;
  plain.offset = 0.0;
  linear_ = chain::in_series(linear_, plain);
  return std::nullopt;
}

ClosedForm::Refusal ClosedForm::add(std::size_t block, const std::unique_ptr<CurveKernel>& curve) {
  rest_ = curve->value(rest_);
  for (ExactSegment& s : segments_) {
    if (!compose(s, *curve->polynomial())) {
      return NoClosedForm{fmt::format("block {} makes a polynomial of too high a degree", block + 1)};
    }
  }
  return std::nullopt;
}

ClosedForm::Refusal ClosedForm::add(std::size_t /*block*/, const std::unique_ptr<SourceKernel>& source) {
  rest_ += source->value(input_.start_s);
  for (ExactSegment& s : segments_) {
    const double at = source->value(s.begin);
    s.degree = std::max<std::size_t>(s.degree, 1);
    s.coefficients[0] += at;
    s.coefficients[1] += source->value(s.end) - at;
  }
  return std::nullopt;
}

ClosedForm::Refusal ClosedForm::add(std::size_t block, const std::unique_ptr<MemoryKernel>& memory) {
  if (!by_branches(segments_, *memory)) {
    return NoClosedForm{fmt::format("block {} turns inside a segment", block + 1)};
  }
  rest_ = memory->reset(rest_, true);
  return std::nullopt;
}

std::variant<Result, NoClosedForm> ClosedForm::run(Start start) const {
  ModalSystem modes = ModalSystem::from(linear_);
  const double condition = modes.condition;
  if (!(condition <= ModalSystem::kMaxCondition)) {
    return NoClosedForm{
        fmt::format("the linear part has nearly equal poles (its modes are {:.1g} times what they add up to)",
                    condition)};
  }
  ExactPropagator propagator(std::move(modes), input_.step_s);
  double before = 0.0;
  if (start == Start::equilibrium) {
    propagator.rest_under(rest_);
    before = rest_ * response(linear_, 0.0).real();
  }
  Result out;
  out.stats.engine = Engine::exact;
  out.stats.steps = segments_.size();
  out.model_error = model_error_;
  const std::size_t n = input_.size();
  out.y.assign(n, before + after_);
  // With a delay the output at t is that of t - delay: the first samples still show what was before.
  const double shift = linear_.delay_s / input_.step_s;
  const auto skipped = whole_number<std::size_t>(std::min(std::ceil(shift - 1e-9), static_cast<double>(n)));
  const std::span<double> y(out.y.data() + skipped, n - skipped);
  propagator.run(segments_, input_.time_s(skipped) - linear_.delay_s, y);
  double size = 0.0;
  for (double& v : y) {
    size = std::max(size, std::abs(v));
    v += after_;
  }
  out.error_estimate = 4e-16 * condition * size * (1.0 + static_cast<double>(linear_.order()));
  return out;
}

class ExactEngine final : public ChainEngine {
 public:
  Engine which() const override { return Engine::exact; }
  std::string_view method(const Kernel& /*kernel*/) const override { return "closed form between corners"; }
  /// An input with a corner at nearly every sample is refused unless the engine was asked for by name: the
  /// record engine does it faster.
  std::variant<Result, NoClosedForm> run(const chain::Chain& chain, const TimeRecord& input,
                                         const Options& options) const override {
    ClosedForm form(chain, input);
    if (auto refusal = form.build(options.engine == Engine::exact)) return *refusal;
    return form.run(start_of(chain, options.start));
  }
  /// What rounding may have done is known without another run.
  double estimate_error(const chain::Chain& /*chain*/, const TimeRecord& /*input*/,
                        const Options& /*options*/, const Result& result) const override {
    return *result.error_estimate;
  }
};

}  // namespace

BODESMITH_ENTRY(ChainEngine, exact_engine, ExactEngine)

}  // namespace bodesmith::simulate
