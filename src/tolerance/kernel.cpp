#include "tolerance/kernel.hpp"

#include <cmath>

#include "numeric/random.hpp"

namespace bodesmith::tolerance {
namespace {

bool first_order(const synthesis::Biquad& h) {
  return h.b2 == 0.0 && h.a2 == 0.0;
}

/// Relative.
Departure departure_of(const Part& part, const Spread& spread) {
  const bool corners = spread.kind == Spread::Kind::corners;
  if (part.kind == Part::Kind::switched_capacitor) {
    const double sigma = spread.mismatch.relative_sigma(part.nominal);
    return corners ? Departure{Departure::Law::corners, sigma * spread.sigmas}
                   : Departure{Departure::Law::normal, sigma};
  }
  const double limit =
      (part.kind == Part::Kind::resistor ? spread.resistor_percent : spread.capacitor_percent) / 100.0;
  if (spread.kind == Spread::Kind::gaussian) return {Departure::Law::normal, limit / spread.sigmas};
  return {corners ? Departure::Law::corners : Departure::Law::uniform, limit};
}

}  // namespace

Kernel::Kernel(const Design& design, const Options& options) : design_(design), options_(options) {
  for (const Part& part : design.parts) {
    values_.push_back(part.nominal);
    departure_.push_back(departure_of(part, options.spread));
    const bool there = part.kind == Part::Kind::switched_capacitor && part.nominal > 0.0;
    extra_.push_back(there ? options.spread.mismatch.systematic_units : 0.0);
    ppm_.push_back(part.kind == Part::Kind::resistor    ? options.spread.resistor_ppm_per_k * 1e-6
                   : part.kind == Part::Kind::capacitor ? options.spread.capacitor_ppm_per_k * 1e-6
                                                        : 0.0);
  }
  warm_ = options.spread.temperature_low_c != 25.0 || options.spread.temperature_high_c != 25.0;
  quick_ = design.is_quick();
  for (int i = 0; quick_ && i < static_cast<int>(design.stages.size()); ++i) {
    const Stage& stage = design.stages[static_cast<size_t>(i)];
    const synthesis::Biquad h =
        stage.transfer(std::span(values_).subspan(stage.first_part, stage.part_count));
    Pair* open = nullptr;
    if (first_order(h)) {
      for (Pair& pair : pairs_) {
        if (pair.second == -1) open = &pair;
      }
    }
    if (open != nullptr) {
      open->second = i;
    } else {
      pairs_.push_back({i, first_order(h) ? -1 : -2});
    }
  }
  if (design.board) {
    board_.emplace(*design.board, options.grid);
  } else if (design.stages.empty()) {
    network_.emplace(*design.netlist, options.grid,
                     schematic::Assumptions{.ideal_opamps = design.ideal_opamps});
  }
  const size_t lanes = pairs_.size() * kBlock, points = options.grid.size();
  for (auto* list : {&b0_, &b1_, &b2_, &a1_, &a2_}) list->assign(lanes, 0.0);
  for (auto* list : {&nr_, &ni_, &dr_, &di_}) list->assign(kBlock, 0.0);
  decibel_.assign(points * kBlock, 0.0);
  degrees_.assign(points * kBlock, 0.0);
  drawn_.resize(points);
  for (const Hertz f : options.grid) {
    const Complex inverse = 1.0 / design.reference(f);
    w_.push_back(f.rad_s().value);
    reference_re_.push_back(inverse.real());
    reference_im_.push_back(inverse.imag());
  }
}

void Kernel::draw(std::uint64_t sample) {
  const Spread& spread = options_.spread;
  for_each_drawn(options_.seed, sample, values_.size(), [&](std::size_t i, double u) {
    // Many sigmas of a wide tolerance must not turn a part negative.
    values_[i] = design_.parts[i].nominal * std::max(1.0 + departure_[i].drawn(u), 1e-3) + extra_[i];
  });
  if (!warm_) return;
  const double kelvin = spread.temperature_low_c - 25.0 +
                        (spread.temperature_high_c - spread.temperature_low_c) *
                            uniform_pair(options_.seed, sample, 0xFFFFFFFFU)[0];
  for_each_drawn(
      options_.seed, sample, values_.size(),
      [&](std::size_t i, double u) { values_[i] *= 1.0 + ppm_[i] * (2.0 * u - 1.0) * kelvin; }, 0x80000000U);
}

void Kernel::coefficients(int lane) {
  const auto transfer = [&](int index) {
    const Stage& stage = design_.stages[static_cast<size_t>(index)];
    return stage.transfer(std::span(values_).subspan(stage.first_part, stage.part_count));
  };
  for (size_t p = 0; p < pairs_.size(); ++p) {
    synthesis::Biquad h = transfer(pairs_[p].first);
    if (pairs_[p].second >= 0) {
      const synthesis::Biquad g = transfer(pairs_[p].second);
      h = {h.b0 * g.b0, h.b0 * g.b1 + h.b1 * g.b0, h.b1 * g.b1,
           h.a0 * g.a0, h.a0 * g.a1 + h.a1 * g.a0, h.a1 * g.a1};
    }
    const size_t at = p * kBlock + static_cast<size_t>(lane);
    const double unit = 1.0 / h.a0;
    b0_[at] = h.b0 * unit;
    b1_[at] = h.b1 * unit;
    b2_[at] = h.b2 * unit;
    a1_[at] = h.a1 * unit;
    a2_[at] = h.a2 * unit;
  }
}

void Kernel::evaluate_one_by_one(std::uint64_t first, int count) {
  for (int lane = 0; lane < count; ++lane) {
    draw(first + static_cast<std::uint64_t>(lane));
    if (board_) {
      drawn_ = board_->response(values_);
    } else if (network_) {
      drawn_ = network_->at(values_);
    } else {
      for (size_t i = 0; i < drawn_.size(); ++i) drawn_[i] = design_.response(options_.grid[i], values_);
    }
    for (size_t i = 0; i < drawn_.size(); ++i) {
      const Complex ratio = drawn_[i] * Complex(reference_re_[i], reference_im_[i]);
      decibel_[i * kBlock + static_cast<size_t>(lane)] = to_decibel(std::abs(ratio));
      degrees_[i * kBlock + static_cast<size_t>(lane)] = to_degrees(std::arg(ratio));
    }
  }
}

void Kernel::evaluate(std::uint64_t first, int count) {
  if (!quick_) return evaluate_one_by_one(first, count);
  for (int lane = 0; lane < count; ++lane) {
    draw(first + static_cast<std::uint64_t>(lane));
    coefficients(lane);
  }
  const size_t points = options_.grid.size();
  for (size_t i = 0; i < points; ++i) {
    double* const nr = nr_.data();
    double* const ni = ni_.data();
    double* const dr = dr_.data();
    double* const di = di_.data();
    for (int k = 0; k < kBlock; ++k) {
      nr[k] = reference_re_[i];
      ni[k] = reference_im_[i];
      dr[k] = 1.0;
      di[k] = 0.0;
    }
    const double w = w_[i], square = w * w;
    for (size_t p = 0; p < pairs_.size(); ++p) {
      const double* const b0 = b0_.data() + p * kBlock;
      const double* const b1 = b1_.data() + p * kBlock;
      const double* const b2 = b2_.data() + p * kBlock;
      const double* const a1 = a1_.data() + p * kBlock;
      const double* const a2 = a2_.data() + p * kBlock;
      for (int k = 0; k < kBlock; ++k) {
        const double br = b0[k] - b2[k] * square, bi = b1[k] * w;
        const double ar = 1.0 - a2[k] * square, ai = a1[k] * w;
        const double r = nr[k] * br - ni[k] * bi;
        ni[k] = nr[k] * bi + ni[k] * br;
        nr[k] = r;
        const double q = dr[k] * ar - di[k] * ai;
        di[k] = dr[k] * ai + di[k] * ar;
        dr[k] = q;
      }
    }
    double* const db = decibel_.data() + i * kBlock;
    double* const deg = degrees_.data() + i * kBlock;
    for (int k = 0; k < count; ++k) {
      const double re = nr[k] * dr[k] + ni[k] * di[k], im = ni[k] * dr[k] - nr[k] * di[k];
      db[k] = 10.0 * std::log10((nr[k] * nr[k] + ni[k] * ni[k]) / (dr[k] * dr[k] + di[k] * di[k]));
      deg[k] = to_degrees(std::atan2(im, re));
    }
  }
}

}  // namespace bodesmith::tolerance
