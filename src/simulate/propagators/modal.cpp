#include "simulate/propagators/modal.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bodesmith::simulate {
namespace {

/// A state that dies away would pass through denormal numbers, which cost a hundred times as much.
constexpr std::size_t kFlushEvery = 4096;
TwoLanes without_dying(TwoLanes v) {
  constexpr double kNothing = 1e-280;
  return TwoLanes{std::abs(v[0]) < kNothing ? 0.0 : v[0], std::abs(v[1]) < kNothing ? 0.0 : v[1]};
}

/// f<n>() for the number of pairs at hand.
template <class F, std::size_t... N>
void with_pair_count(std::size_t pairs, const F& f, std::index_sequence<N...> /*sizes*/) {
  (void)((pairs == N + 1 && (f(std::integral_constant<std::size_t, N + 1>()), true)) || ...);
}

}  // namespace

bool ModalPropagator::prepare(const StateSpace& system, double h, const HoldNodes& nodes,
                              std::span<const Output> outputs) {
  if (system.order() > 2 * kMaxPairs) return false;
  auto modes = modal_pairs(system);
  if (!modes) return false;
  modes_ = std::move(*modes);
  degree_ = nodes.degree;
  direct_ = system.d;
  offset_ = system.offset;
  const std::size_t width = nodes.size();
  own_ = other_ = constant_ = {};
  input_ = see_ = {};
  direct_rows_ = {};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    constant_rows_[i] = offset_;
    for (std::size_t j = 0; j < width; ++j) direct_rows_[i][j] = direct_ * outputs[i].weights[j];
  }
  for (std::size_t k = 0; k < modes_.b.size(); k += 2) {
    const std::array<const double*, 1> in = {modes_.b.data() + k};
    const DrivenSystem pair{2, modes_.blocks.data() + 2 * k, in,
                            modes_.constant.empty() ? nullptr : modes_.constant.data() + k};
    solver_.solve(pair, h, nodes, 1.0, response_);
    for (std::size_t lane = 0; lane < 2; ++lane) {
      own_[k + lane] = response_.e[2 * lane + lane];
      other_[k + lane] = response_.e[2 * lane + 1 - lane];
      constant_[k + lane] = response_.k[lane];
      for (std::size_t j = 0; j < width; ++j) input_[j][k + lane] = response_.g[0][lane * width + j];
    }
    const double c[2] = {modes_.c[k], modes_.c[k + 1]};
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      solver_.solve(pair, h, nodes, outputs[i].s, response_);
      for (std::size_t lane = 0; lane < 2; ++lane) {
        see_[i][k + lane] = c[0] * response_.e[lane] + c[1] * response_.e[2 + lane];
        constant_rows_[i] += c[lane] * response_.k[lane];
        for (std::size_t j = 0; j < width; ++j)
          direct_rows_[i][j] += c[lane] * response_.g[0][lane * width + j];
      }
    }
  }
  return true;
}

template <std::size_t Pairs, std::size_t Degree, bool Coupled>
void ModalPropagator::run_holds(const double* u, double* y, std::size_t holds) {
  constexpr std::size_t kWidth = Degree + 1;
  TwoLanes w[Pairs];
  for (std::size_t k = 0; k < Pairs; ++k) w[k] = load_lanes(state_.data() + 2 * k);
  for (std::size_t hold = 0; hold < holds; ++hold, u += kWidth, y += kWidth) {
    for (std::size_t i = 0; i < kWidth; ++i) {
      TwoLanes sum = {constant_rows_[i], 0.0};
      for (std::size_t k = 0; k < Pairs; ++k) sum += load_lanes(see_[i].data() + 2 * k) * w[k];
      double value = sum[0] + sum[1];
      for (std::size_t j = 0; j < kWidth; ++j) value += direct_rows_[i][j] * u[j];
      y[i] = value;
    }
    for (std::size_t k = 0; k < Pairs; ++k) {
      TwoLanes next = load_lanes(constant_.data() + 2 * k) + load_lanes(own_.data() + 2 * k) * w[k];
      if constexpr (Coupled) next += load_lanes(other_.data() + 2 * k) * swapped_lanes(w[k]);
      for (std::size_t j = 0; j < kWidth; ++j)
        next += load_lanes(input_[j].data() + 2 * k) * both_lanes(u[j]);
      w[k] = next;
    }
  }
  for (std::size_t k = 0; k < Pairs; ++k) {
    state_[2 * k] = w[k][0];
    state_[2 * k + 1] = w[k][1];
  }
}

void ModalPropagator::run(const double* u, double* y, std::size_t holds) {
  with_pair_count(
      modes_.pairs(),
      [&](auto pairs) {
        constexpr std::size_t kPairs = decltype(pairs)::value;
        if (degree_ == 1) {
          modes_.coupled ? run_holds<kPairs, 1, true>(u, y, holds) : run_holds<kPairs, 1, false>(u, y, holds);
        } else {
          modes_.coupled ? run_holds<kPairs, 3, true>(u, y, holds) : run_holds<kPairs, 3, false>(u, y, holds);
        }
      },
      std::make_index_sequence<kMaxPairs>());
}

// With z = w - (what the input's end of the hold adds), w[i+1] = E w[i] + g0 u[i] + g1 u[i+1] becomes
// z[i+1] = E z[i] + (E g1 + g0) u[i]: one product with the input instead of two.
template <std::size_t Pairs, bool Coupled>
void ModalPropagator::run_straight(double* signal, std::size_t count) {
  TwoLanes z[Pairs], own[Pairs], other[Pairs], in[Pairs], see[Pairs], constant[Pairs];
  TwoLanes direct = {direct_, 0.0};
  for (std::size_t k = 0; k < Pairs; ++k) {
    const TwoLanes end = load_lanes(input_[1].data() + 2 * k);
    own[k] = load_lanes(own_.data() + 2 * k);
    other[k] = load_lanes(other_.data() + 2 * k);
    constant[k] = load_lanes(constant_.data() + 2 * k);
    see[k] = load_lanes(modes_.c.data() + 2 * k);
    in[k] = load_lanes(input_[0].data() + 2 * k) + own[k] * end + other[k] * swapped_lanes(end);
    z[k] = load_lanes(state_.data() + 2 * k) - end * both_lanes(signal[0]);
    direct += see[k] * end;
  }
  const double gain = direct[0] + direct[1];
  for (std::size_t i = 0; i < count;) {
    const std::size_t end = std::min(count, i + kFlushEvery);
    for (; i < end; ++i) {
      const double u = signal[i];
      TwoLanes sum = {offset_, 0.0};
      for (std::size_t k = 0; k < Pairs; ++k) {
        sum += see[k] * z[k];
        TwoLanes next = constant[k] + in[k] * both_lanes(u);
        if constexpr (Coupled) next += other[k] * swapped_lanes(z[k]);
        z[k] = next + own[k] * z[k];
      }
      signal[i] = sum[0] + sum[1] + gain * u;
    }
    for (TwoLanes& state : z) state = without_dying(state);
  }
}

void ModalPropagator::run_samples(double* signal, std::size_t count) {
  if (count == 0) return;
  with_pair_count(
      modes_.pairs(),
      [&](auto pairs) {
        constexpr std::size_t kPairs = decltype(pairs)::value;
        modes_.coupled ? run_straight<kPairs, true>(signal, count)
                       : run_straight<kPairs, false>(signal, count);
      },
      std::make_index_sequence<kMaxPairs>());
}

}  // namespace bodesmith::simulate
