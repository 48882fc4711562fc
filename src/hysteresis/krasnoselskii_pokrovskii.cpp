#include "hysteresis/krasnoselskii_pokrovskii.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::hysteresis {

double KpEverett::input(const Turn& from, const Turn* toward, int direction, double y, double now) const {
  if (direction > 0) {
    const double target = y - from.y;
    int low = cache(now).cell;
    int high = toward != nullptr ? toward->cache.cell : cells_ - 1;
    while (low < high) {
      const int middle = (low + high) >> 1;
      if (everett({middle, 1.0}, from.cache) >= target) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    // Two straight pieces: up to f = g, and beyond.
    const double knee = from.cache.fraction;
    const double start = everett({low, 0.0}, from.cache);
    const double bend = everett({low, knee}, from.cache);
    const double end = everett({low, 1.0}, from.cache);
    double f = 1.0;
    if (target <= bend && bend > start) {
      f = knee * (target - start) / (bend - start);
    } else if (end > bend) {
      f = knee + (1.0 - knee) * (target - bend) / (end - bend);
    }
    return std::max(now, u_min_ + (low + std::clamp(f, 0.0, 1.0)) * step_);
  }
  const double target = from.y - y;
  int high = cache(now).cell;
  int low = toward != nullptr ? toward->cache.cell : 0;
  while (low < high) {
    const int middle = (low + high + 1) >> 1;
    if (everett(from.cache, {middle, 0.0}) >= target) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  const double knee = from.cache.fraction;
  const double start = everett(from.cache, {low, 1.0});
  const double bend = everett(from.cache, {low, knee});
  const double end = everett(from.cache, {low, 0.0});
  double g = 0.0;
  if (target <= bend && bend > start) {
    g = 1.0 - (1.0 - knee) * (target - start) / (bend - start);
  } else if (end > bend) {
    g = knee - knee * (target - bend) / (end - bend);
  }
  return std::min(now, u_min_ + (low + std::clamp(g, 0.0, 1.0)) * step_);
}

KrasnoselskiiPokrovskii KrasnoselskiiPokrovskii::from(const Parameters& values) {
  EverettTable table = EverettTable::from_parameters(values, "mu");
  const std::size_t levels = table.levels;
  for (std::size_t a = 0; a <= levels; ++a)
    for (std::size_t b = a + 1; b <= levels; ++b) table.values[a * (levels + 1) + b] = 0.0;
  return {.table = std::make_shared<const EverettTable>(std::move(table)),
          .offset = values.number("offset"),
          .a1 = values.number("a1"),
          .a2 = values.number("a2")};
}

KpOperator::KpOperator(const KrasnoselskiiPokrovskii& model)
    : static_(KpEverett(model.table), model.table->u_min, 0.0),
      offset_(model.offset),
      a1_(model.a1),
      a2_(model.a2),
      u_(model.table->u_min) {}

double KpOperator::rate(double u, double dt_s) const {
  if (a2_ == 0.0 || !(dt_s > 0.0)) return a1_;
  // Held where the exponential would leave the doubles.
  return a1_ * std::exp(std::clamp(-a2_ * (u - u_) / dt_s, -600.0, 600.0));
}

double KpOperator::reset(double u) {
  u_ = u;
  return offset_ + a1_ * static_.reset(u);
}

double KpOperator::step(double u, double dt_s) {
  const double psi = rate(u, dt_s);
  u_ = u;
  return offset_ + psi * static_.step(u, dt_s);
}

double KpOperator::peek(double u, double dt_s) const {
  return offset_ + rate(u, dt_s) * static_.peek(u, dt_s);
}

namespace {

/// Of the sum of kernels alone.
EverettInverse<KpEverett> static_inverse(const std::shared_ptr<const EverettTable>& table) {
  return {EverettOperator<KpEverett>(KpEverett(table), table->u_min, 0.0), table->u_min, 0.0,
          table->at(table->levels, 0)};
}

}  // namespace

KpRateInverse::KpRateInverse(const KrasnoselskiiPokrovskii& model)
    : slow_(static_inverse(model.table)),
      fast_(static_inverse(model.table)),
      forward_(model),
      offset_(model.offset),
      a1_(model.a1),
      a2_(model.a2) {
  reset(model.offset);
}

double KpRateInverse::reset(double y) {
  slow_u_ = slow_.reset((y - offset_) / a1_);
  const double u = fast_.reset((y - offset_) / a1_);
  achieved_ = forward_.reset(u);
  return u;
}

double KpRateInverse::step(double y, double dt_s) {
  const double before = slow_u_;
  slow_u_ = slow_.step((y - offset_) / a1_, dt_s);
  const double slope = dt_s > 0.0 ? (slow_u_ - before) / dt_s : 0.0;
  const double u =
      fast_.step((y - offset_) / (a1_ * std::exp(std::clamp(-a2_ * slope, -600.0, 600.0))), dt_s);
  achieved_ = forward_.step(u, dt_s);
  return u;
}

namespace {

class KrasnoselskiiPokrovskiiType final : public ShapedModelType<KrasnoselskiiPokrovskii, KpOperator> {
 public:
  KrasnoselskiiPokrovskiiType()
      : ShapedModelType(
            "krasnoselskii_pokrovskii",
            "weighted KP kernels on the stack of extremes, optionally with the rate function a1 exp(-a2 du/dt)",
            {
                any_number("u_min", "u", "input that v = 0 stands for"),
                any_number("u_max", "u", "input that v = 1 stands for"),
                list_of(not_negative("mu", "y", "densities of the kernels, n (n + 1)/2 of them, n = L - 1")),
                any_number("offset", "y", "output with all kernels at 0").with_default(0.0),
                above_zero("a1", "1", "gain of the rate function").with_default(1.0),
                not_negative("a2", "s/u", "exponent of the rate function, against the input's slope")
                    .with_default(0.0),
            }) {}

 protected:
  std::unique_ptr<Inverse> inverse_of(const KrasnoselskiiPokrovskii& model) const override {
    if (model.a2 != 0.0) return std::make_unique<KpRateInverse>(model);
    // a1 is a plain gain: the inverse of the static part on y/a1, which scaling the table does once.
    const EverettTable& table = *model.table;
    auto scaled = std::make_shared<EverettTable>(table);
    for (double& value : scaled->values) value *= model.a1;
    const double top = scaled->at(table.levels, 0);
    using Op = EverettOperator<KpEverett>;
    return std::make_unique<EverettInverse<KpEverett>>(Op(KpEverett(scaled), table.u_min, model.offset),
                                                       table.u_min, model.offset, model.offset + top);
  }
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_krasnoselskii_pokrovskii(records, options);
  }
};

}  // namespace

BODESMITH_ENTRY(ModelType, krasnoselskii_pokrovskii_type, KrasnoselskiiPokrovskiiType)

}  // namespace bodesmith::hysteresis
