#include "fpaa/stage_view.hpp"

#include <cmath>

#include "fpaa/grid_arithmetic.hpp"
#include "numeric/clones.hpp"
#include "numeric/complex_four.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// a0 + a1 D + a2 D^2.
[[gnu::always_inline]] inline ComplexFour at(const InD& f, const ComplexFour& d) {
  const ComplexFour out = d * ComplexFour{f.a1 + f.a2 * d.re, f.a2 * d.im};
  return {f.a0 + out.re, out.im};
}

/// sum -= way numerator/denominator, four points at a time: the digits of StageOnGrid.
BODESMITH_CLONES void add_share(const InD& numerator, const InD& denominator, const GridNumbers& d,
                                const GridNumbers& way, GridNumbers& sum) {
  for (std::size_t k = 0; k < d.re.size(); k += 4) {
    const ComplexFour points = four_at(&d.re[k], &d.im[k]);
    const ComplexFour quotient = at(numerator, points) * inverse(at(denominator, points));
    const ComplexFour share = ComplexFour{-quotient.re, -quotient.im} * four_at(&way.re[k], &way.im[k]);
    *four_at(&sum.re[k]) += share.re;
    *four_at(&sum.im[k]) += share.im;
  }
}

}  // namespace

GridNumbers::GridNumbers(std::size_t points_of)
    : points(points_of), re((points + 3) / 4 * 4, 0.0), im(re.size(), 0.0) {}

GridNumbers::GridNumbers(const std::vector<Complex>& from, Complex fill) : GridNumbers(from.size()) {
  for (std::size_t k = 0; k < re.size(); ++k) {
    const Complex value = k < points ? from[k] : fill;
    re[k] = value.real();
    im[k] = value.imag();
  }
}

StageView::StageView(const Network& network, std::size_t s, const NetworkResponse& response)
    : d_(response.d_of(network.stages[s].divisor), 1.0) {
  const NetworkStage& stage = network.stages[s];
  const NetworkTarget& target = response.target();
  const auto transfers = response.transfers(network);
  const auto nodes = response.nodes(network, transfers);
  const auto onward = response.onward(network, transfers);
  const std::vector<Complex>& hold = response.hold_of(network.stages.back().divisor);
  std::vector<Complex> errors = nodes.back();
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const double scale = target.weight[k] * target.reciprocal[k];
    errors[k] = scale * (product(errors[k], hold[k]) - target.wanted[k]);
  }
  errors_ = GridNumbers(errors, 0.0);
  for (const int from : stage.from) {
    std::vector<Complex> way = onward[s];
    for (std::size_t k = 0; k < way.size(); ++k) way[k] *= target.weight[k] * target.reciprocal[k];
    if (from != NetworkStage::kBoardInput) {
      const auto source = static_cast<std::size_t>(from);
      const std::vector<Complex>& read = response.read_of(network.stages[source].divisor, stage.divisor);
      GridValues reads = read;
      multiply(reads, nodes[source]);
      multiply(way, reads);
    }
    ways_.emplace_back(way, 0.0);
  }
  share_of(stage, share_);
}

void StageView::share_of(const NetworkStage& stage, GridNumbers& out) const {
  out.points = d_.points;
  out.re.assign(d_.re.size(), 0.0);
  out.im.assign(d_.im.size(), 0.0);
  const InD denominator = denominator_of(stage);
  for (std::size_t i = 0; i < ways_.size(); ++i)
    add_share(numerator_of(stage, i), denominator, d_, ways_[i], out);
}

double StageView::largest_error_with(const NetworkStage& stage) const {
  GridNumbers got;
  share_of(stage, got);
  double out = 0.0;
  for (std::size_t k = 0; k < got.points; ++k) {
    const double squared = std::norm(errors_.at(k) + got.at(k) - share_.at(k));
    // Not std::max: a NaN has to come out as the worst.
    if (!(squared <= out)) out = std::isnan(squared) ? 1e300 : squared;
  }
  return std::sqrt(out);
}

}  // namespace bodesmith::fpaa
