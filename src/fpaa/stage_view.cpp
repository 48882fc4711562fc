#include "fpaa/stage_view.hpp"

#include <cmath>

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

}  // namespace

StageView::StageView(const Network& network, std::size_t s, const NetworkResponse& response)
    : d_(response.d_of(network.stages[s].divisor)) {
  const NetworkStage& stage = network.stages[s];
  const NetworkTarget& target = response.target();
  const auto transfers = response.transfers(network);
  const auto nodes = response.nodes(network, transfers);
  const auto onward = response.onward(network, transfers);
  const std::vector<Complex>& hold = response.hold_of(network.stages.back().divisor);
  errors_ = nodes.back();
  for (std::size_t k = 0; k < errors_.size(); ++k) {
    const double scale = target.weight[k] * target.reciprocal[k];
    errors_[k] = scale * (product(errors_[k], hold[k]) - target.wanted[k]);
  }
  for (const int from : stage.from) {
    std::vector<Complex> way = onward[s];
    for (std::size_t k = 0; k < way.size(); ++k) way[k] *= target.weight[k] * target.reciprocal[k];
    if (from != NetworkStage::kBoardInput) {
      const auto source = static_cast<std::size_t>(from);
      const std::vector<Complex>& read = response.read_of(network.stages[source].divisor, stage.divisor);
      for (std::size_t k = 0; k < way.size(); ++k) {
        way[k] = product(way[k], product(read[k], nodes[source][k]));
      }
    }
    ways_.push_back(std::move(way));
  }
  share_ = share_of(stage);
}

std::vector<Complex> StageView::share_of(const NetworkStage& stage) const {
  const StageOnGrid on_grid(stage, d_);
  std::vector<Complex> out(d_.size(), 0.0);
  for (std::size_t i = 0; i < ways_.size(); ++i) {
    const std::vector<Complex> own = on_grid.response(i);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += product(own[k], ways_[i][k]);
  }
  return out;
}

double StageView::largest_error_with(const NetworkStage& stage) const {
  const std::vector<Complex> got = share_of(stage);
  double out = 0.0;
  for (std::size_t k = 0; k < got.size(); ++k) {
    const double squared = std::norm(errors_[k] + got[k] - share_[k]);
    // Not std::max: a NaN has to come out as the worst.
    if (!(squared <= out)) out = std::isnan(squared) ? 1e300 : squared;
  }
  return std::sqrt(out);
}

}  // namespace bodesmith::fpaa
