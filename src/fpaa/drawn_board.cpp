#include "fpaa/drawn_board.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fpaa/cams/cam.hpp"
#include "fpaa/clocked_factors.hpp"
#include "fpaa/multirate_response.hpp"
#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

/// The short way is taken where it agrees with MultirateResponse to this, relative.
constexpr double kSameResponse = 1e-9;
constexpr std::size_t kComparedPoints = 12;
constexpr double kSensitivityStep = 1e-5;

Complex drawn_polynomial(const std::vector<double>& c, Complex d) {
  Complex out = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) out = out * d + c[i];
  return out;
}

/// What reading the held output of a CAM of period `source` (ticks) at clock `reader` does to the sine itself
/// (see MultirateResponse).
Complex read_factor(double cycles_per_tick, const PlanGraph::PlanNode& source, std::int64_t reader) {
  const std::int64_t g = std::gcd(source.period, reader);
  const double late = static_cast<double>((source.delay + g - 1) / g * g);
  const double half = std::numbers::pi * cycles_per_tick * static_cast<double>(g);
  const Complex delay = std::polar(1.0, -2.0 * std::numbers::pi * cycles_per_tick * late);
  return delay * mean_factor(static_cast<double>(source.period / g), half);
}

}  // namespace

DrawnBoard::DrawnBoard(const Plan& plan, std::vector<Hertz> grid)
    : plan_(plan), graph_(value_or_throw(plan_graph(plan))), grid_(std::move(grid)) {
  on_grid_.resize(graph_.nodes.size());
  for (std::size_t i = 0; i < graph_.nodes.size(); ++i) {
    on_grid_[i].first_capacitor = units_.size();
    for (const Capacitor& c : graph_.nodes[i].cam->capacitors) {
      units_.push_back(c.units);
      names_.push_back(graph_.nodes[i].name + "." + c.name);
    }
  }
  for (std::size_t i = 0; i < graph_.nodes.size(); ++i) prepare(i);
  output_hold_.assign(grid_.size(), 1.0);
  if (graph_.output && graph_.output->node) {
    const PlanGraph::PlanNode& last = graph_.nodes[*graph_.output->node];
    const Hertz clock{graph_.tick_rate / static_cast<double>(last.period)};
    const double delay = static_cast<double>(last.delay) / static_cast<double>(last.period);
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      const RadPerSecond w = grid_[k].rad_s();
      output_hold_[k] = cycle_delay(w, clock, delay) * zero_order_hold(w, clock);
    }
  }
  const std::vector<Complex> quick = response(units_);
  const MultirateResponse exact(plan);
  // Whether lines fold is a matter of the clocks: a few frequencies tell.
  const std::size_t step = std::max<std::size_t>(1, grid_.size() / kComparedPoints);
  for (std::size_t k = 0; k < grid_.size() && !folds_; k += step) {
    const Complex whole = exact.as_it_runs(grid_[k].rad_s());
    folds_ = !(std::abs(quick[k] - whole) <= kSameResponse * std::abs(whole));
  }
}

void DrawnBoard::prepare(std::size_t node) {
  NodeOnGrid& at = on_grid_[node];
  const PlanGraph::PlanNode& reader = graph_.nodes[node];
  for (const Hertz f : grid_) {
    const double half = std::numbers::pi * f.value * static_cast<double>(reader.period) / graph_.tick_rate;
    at.d.push_back(difference_factor(half));
  }
  for (const PlanGraph::Input& input : reader.inputs) {
    Read read;
    for (const Hertz f : grid_) {
      read.factor.push_back(input.from.node ? read_factor(f.value / graph_.tick_rate,
                                                          graph_.nodes[*input.from.node], reader.period)
                                            : 1.0);
    }
    at.inputs.push_back(std::move(read));
  }
}

DrawnBoard::Transfers DrawnBoard::transfers(std::span<const double> units) const {
  Transfers out(graph_.nodes.size());
  for (std::size_t n = 0; n < graph_.nodes.size(); ++n) {
    const NodeOnGrid& at = on_grid_[n];
    for (const DeltaTransfer& h : transfers_of(*graph_.nodes[n].cam, units.subspan(at.first_capacitor))) {
      std::vector<Complex> values;
      values.reserve(grid_.size());
      for (const Complex& d : at.d) {
        values.push_back(drawn_polynomial(h.numerator, d) / drawn_polynomial(h.denominator, d));
      }
      out[n].push_back(std::move(values));
    }
  }
  return out;
}

std::vector<std::vector<Complex>> DrawnBoard::nodes(const Transfers& transfers) const {
  std::vector<std::vector<Complex>> out(graph_.nodes.size(), std::vector<Complex>(grid_.size(), 0.0));
  for (const std::size_t n : graph_.order) {
    const std::vector<PlanGraph::Input>& inputs = graph_.nodes[n].inputs;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const std::vector<Complex>& h = transfers[n].at(inputs[i].number - 1);
      const std::vector<Complex>* const source = inputs[i].from.node ? &out[*inputs[i].from.node] : nullptr;
      for (std::size_t k = 0; k < grid_.size(); ++k) {
        out[n][k] += source != nullptr ? h[k] * (*source)[k] * on_grid_[n].inputs[i].factor[k] : h[k];
      }
    }
  }
  return out;
}

std::vector<std::vector<Complex>> DrawnBoard::onward(const Transfers& transfers) const {
  std::vector<std::vector<Complex>> out(graph_.nodes.size(), std::vector<Complex>(grid_.size(), 0.0));
  if (graph_.output && graph_.output->node) out[*graph_.output->node] = output_hold_;
  for (auto n = graph_.order.rbegin(); n != graph_.order.rend(); ++n) {
    const std::vector<PlanGraph::Input>& inputs = graph_.nodes[*n].inputs;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (!inputs[i].from.node) continue;
      const std::vector<Complex>& h = transfers[*n].at(inputs[i].number - 1);
      std::vector<Complex>& source = out[*inputs[i].from.node];
      for (std::size_t k = 0; k < grid_.size(); ++k) {
        source[k] += h[k] * on_grid_[*n].inputs[i].factor[k] * out[*n][k];
      }
    }
  }
  return out;
}

std::vector<Complex> DrawnBoard::response(const Transfers& transfers) const {
  std::vector<Complex> out(grid_.size(), graph_.output ? 1.0 : 0.0);
  if (!graph_.output || !graph_.output->node) return out;
  out = nodes(transfers)[*graph_.output->node];
  for (std::size_t k = 0; k < grid_.size(); ++k) out[k] *= output_hold_[k];
  return out;
}

void DrawnBoard::response(std::span<const double> units, std::span<Complex> out) const {
  if (folds_) return folded_response(units, out);
  const std::vector<Complex> got = response(transfers(units));
  std::copy(got.begin(), got.end(), out.begin());
}

std::vector<Complex> DrawnBoard::response(std::span<const double> units) const {
  std::vector<Complex> out(grid_.size());
  response(units, out);
  return out;
}

void DrawnBoard::folded_response(std::span<const double> units, std::span<Complex> out) const {
  Plan board = plan_;
  std::size_t first = 0;
  for (ChipPlan& chip : board.chips) {
    for (PlacedCam& cam : chip.cams) {
      const std::vector<DeltaTransfer> h = transfers_of(cam, units.subspan(first));
      first += cam.capacitors.size();
      cam.z = h[0].in_z();
      for (std::size_t i = 1; i < h.size(); ++i) cam.more_numerators[i - 1] = h[i].in_z().numerator;
    }
  }
  const MultirateResponse exact(board);
  for (std::size_t k = 0; k < grid_.size(); ++k) out[k] = exact.as_it_runs(grid_[k].rad_s());
}

std::vector<std::vector<Complex>> DrawnBoard::sensitivities() const {
  return sensitivities(units_);
}

std::vector<std::vector<Complex>> DrawnBoard::sensitivities(std::span<const double> units) const {
  std::vector<double> moved(units.begin(), units.end());
  std::vector<std::vector<Complex>> out(moved.size(), std::vector<Complex>(grid_.size(), 0.0));
  std::vector<Complex> up(grid_.size());
  std::vector<Complex> down(grid_.size());
  for (std::size_t c = 0; c < moved.size(); ++c) {
    if (!(units[c] > 0.0)) continue;
    moved[c] = units[c] * std::exp(kSensitivityStep);
    response(moved, up);
    moved[c] = units[c] * std::exp(-kSensitivityStep);
    response(moved, down);
    moved[c] = units[c];
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      out[c][k] = (up[k] - down[k]) / (kSensitivityStep * (up[k] + down[k]));
    }
  }
  return out;
}

std::vector<double> DrawnBoard::drawn(const MismatchModel& mismatch, Random& random) const {
  std::vector<double> out;
  out.reserve(units_.size());
  for (const double units : units_) out.push_back(mismatch.drawn(units, random.normal()));
  return out;
}

namespace {

/// Where the first-order variance of the complex response is largest, each capacitor's share of it.
std::vector<MismatchSpread::Share> variance_shares(const DrawnBoard& board, const MismatchModel& mismatch) {
  const auto slopes = board.sensitivities();
  const std::vector<double>& units = board.nominal_units();
  const auto variance = [&](std::size_t c, std::size_t k) {
    return std::pow(mismatch.relative_sigma(units[c]), 2) * std::norm(slopes[c][k]);
  };
  std::size_t loudest = 0;
  double largest = 0.0;
  for (std::size_t k = 0; k < board.grid().size(); ++k) {
    double sum = 0.0;
    for (std::size_t c = 0; c < units.size(); ++c) sum += variance(c, k);
    if (sum > largest) {
      largest = sum;
      loudest = k;
    }
  }
  std::vector<MismatchSpread::Share> out;
  for (std::size_t c = 0; c < units.size() && largest > 0.0; ++c) {
    out.push_back({board.names()[c], variance(c, loudest) / largest});
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
  return out;
}

double sorted_quantile(const std::vector<double>& sorted, double p) {
  return sorted[static_cast<std::size_t>(p * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

MismatchSpread mismatch_spread(const DrawnBoard& board, const MismatchModel& mismatch, int draws,
                               std::uint64_t seed) {
  MismatchSpread out;
  out.draws = draws;
  out.shares = variance_shares(board, mismatch);
  if (draws <= 0) return out;
  const std::vector<Complex> designed = board.response(board.nominal_units());
  std::vector<Complex> got(designed.size());
  std::vector<double> percent;
  std::vector<double> decibel;
  Random random(seed);
  for (int draw = 0; draw < draws; ++draw) {
    board.response(board.drawn(mismatch, random), got);
    double worst = 0.0;
    double worst_db = 0.0;
    for (std::size_t k = 0; k < got.size(); ++k) {
      worst = std::max(worst, 100.0 * std::abs(got[k] / designed[k] - 1.0));
      worst_db = std::max(worst_db, std::abs(to_decibel(std::abs(got[k] / designed[k]))));
    }
    percent.push_back(worst);
    decibel.push_back(worst_db);
  }
  std::sort(percent.begin(), percent.end());
  std::sort(decibel.begin(), decibel.end());
  out.median_percent = sorted_quantile(percent, 0.5);
  out.p95_percent = sorted_quantile(percent, 0.95);
  out.max_percent = percent.back();
  out.p95_db = sorted_quantile(decibel, 0.95);
  return out;
}

}  // namespace bodesmith::fpaa
