#include "hysteresis/krasnoselskii_pokrovskii.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "hysteresis/everett_trace.hpp"
#include "hysteresis/preisach_identify.hpp"
#include "hysteresis/record_tools.hpp"
#include "hysteresis/registry.hpp"
#include "numeric/least_squares.hpp"
#include "numeric/particle_swarm.hpp"

namespace bodesmith::hysteresis {

KpEverett::KpEverett(std::shared_ptr<const EverettTable> table)
    : table_(std::move(table)),
      data_(table_->values.data()),
      u_min_(table_->u_min),
      scale_(static_cast<double>(table_->levels) / (table_->u_max - table_->u_min)),
      last_(static_cast<double>(table_->levels)),
      step_((table_->u_max - table_->u_min) / static_cast<double>(table_->levels)),
      cells_(static_cast<int>(table_->levels)) {}

double KpEverett::input(const Turn& from, const Turn* toward, int direction, double y, double now) const {
  if (direction > 0) {
    const double wanted = y - from.y;
    int low = cache(now).cell;
    int high = toward != nullptr ? toward->cache.cell : cells_ - 1;
    while (low < high) {
      const int middle = (low + high) >> 1;
      if (everett({middle, 1.0}, from.cache) >= wanted) {
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
    if (wanted <= bend && bend > start) {
      f = knee * (wanted - start) / (bend - start);
    } else if (end > bend) {
      f = knee + (1.0 - knee) * (wanted - bend) / (end - bend);
    }
    return std::max(now, u_min_ + (low + std::clamp(f, 0.0, 1.0)) * step_);
  }
  const double wanted = from.y - y;
  int high = cache(now).cell;
  int low = toward != nullptr ? toward->cache.cell : 0;
  while (low < high) {
    const int middle = (low + high + 1) >> 1;
    if (everett(from.cache, {middle, 0.0}) >= wanted) {
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
  if (wanted <= bend && bend > start) {
    g = 1.0 - (1.0 - knee) * (wanted - start) / (bend - start);
  } else if (end > bend) {
    g = knee - knee * (wanted - bend) / (end - bend);
  }
  return std::min(now, u_min_ + (low + std::clamp(g, 0.0, 1.0)) * step_);
}

KrasnoselskiiPokrovskii KrasnoselskiiPokrovskii::from(const Parameters& values) {
  const double u_min = values.scalar("u_min");
  const double u_max = values.scalar("u_max");
  if (!(u_max > u_min)) throw DesignError("u_max is not above u_min");
  const std::vector<double>& mu = values.array("mu");
  const auto levels = static_cast<std::size_t>(
      std::llround((std::sqrt(8.0 * static_cast<double>(mu.size()) + 1.0) - 1.0) / 2.0));
  if (mu.empty() || levels * (levels + 1) / 2 != mu.size())
    throw DesignError(fmt::format("mu has {} numbers, expected n (n + 1)/2", mu.size()));
  EverettTable table = EverettTable::from_weights(u_min, u_max, levels, mu);
  for (std::size_t a = 0; a <= levels; ++a)
    for (std::size_t b = a + 1; b <= levels; ++b) table.values[a * (levels + 1) + b] = 0.0;
  KrasnoselskiiPokrovskii out;
  out.table = std::make_shared<const EverettTable>(std::move(table));
  out.offset = values.scalar("offset");
  out.a1 = values.scalar("a1");
  out.a2 = values.scalar("a2");
  return out;
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

BruteForceKp::BruteForceKp(double u_min, double u_max, std::size_t levels, std::vector<double> mu)
    : u_min_(u_min),
      scale_(1.0 / (u_max - u_min)),
      levels_(levels),
      mu_(std::move(mu)),
      xi_(mu_.size(), 0.0) {}

double BruteForceKp::reset(double u) {
  std::fill(xi_.begin(), xi_.end(), 0.0);
  v_ = 0.0;
  return step(u);
}

double BruteForceKp::step(double u) {
  const double v = (u - u_min_) * scale_;
  const double a = 1.0 / static_cast<double>(levels_);
  const auto ridge = [a](double x) { return x < 0.0 ? 0.0 : x > a ? 1.0 : x / a; };
  double sum = 0.0;
  std::size_t k = 0;
  for (std::size_t i = 0; i < levels_; ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++k) {
      if (v > v_) xi_[k] = std::max(xi_[k], ridge(v - static_cast<double>(i) * a));
      if (v < v_) xi_[k] = std::min(xi_[k], ridge(v - static_cast<double>(j) * a));
      sum += mu_[k] * xi_[k];
    }
  }
  v_ = v;
  return sum;
}

namespace {

const std::vector<ParameterInfo>& infos() {
  static const std::vector<ParameterInfo> list = {
      scalar("u_min", "u", "input that v = 0 stands for"),
      scalar("u_max", "u", "input that v = 1 stands for"),
      array("mu", "y", "densities of the kernels, n (n + 1)/2 of them, n = L - 1", 0.0),
      optional(scalar("offset", "y", "output with all kernels at 0"), {0.0}),
      optional(scalar("a1", "1", "gain of the rate function", 1e-300), {1.0}),
      optional(scalar("a2", "s/u", "exponent of the rate function, against the input's slope", 0.0), {0.0}),
  };
  return list;
}

void check(const Parameters& values) {
  (void)KrasnoselskiiPokrovskii::from(values);
}

std::unique_ptr<Operator> make(const Parameters& values) {
  return std::make_unique<KpOperator>(KrasnoselskiiPokrovskii::from(values));
}

std::unique_ptr<Inverse> make_inverse_of(const Parameters& values) {
  KrasnoselskiiPokrovskii model = KrasnoselskiiPokrovskii::from(values);
  const EverettTable& table = *model.table;
  if (model.a2 == 0.0) {
    // a1 is a plain gain: the inverse of the static part on y/a1, which scaling the table does once.
    auto scaled = std::make_shared<EverettTable>(table);
    for (double& value : scaled->values) value *= model.a1;
    const double top = scaled->at(table.levels, 0);
    using Op = EverettOperator<KpEverett>;
    return std::make_unique<EverettInverse<KpEverett>>(Op(KpEverett(scaled), table.u_min, model.offset),
                                                       table.u_min, model.offset, model.offset + top);
  }
  return std::make_unique<KpRateInverse>(model);
}

Parameters to_parameters(const Range& u, const std::vector<double>& mu, double offset, double a1, double a2) {
  Parameters out;
  out.set("u_min", u.low)
      .set("u_max", u.high)
      .set("mu", mu)
      .set("offset", offset)
      .set("a1", a1)
      .set("a2", a2);
  return out;
}

/// Mean |u̇| of a record.
double speed(const TimeRecord& record) {
  double way = 0.0;
  for (std::size_t i = 1; i < record.size(); ++i) way += std::abs(record.u[i] - record.u[i - 1]);
  return way / std::max(record.duration_s(), 1e-300);
}

Identified identify(std::span<const TimeRecord> records, const IdentifyOptions& options) {
  const Stopwatch watch;
  const Range u = input_range(records, 0.0);
  if (!(u.width() > 0.0))
    throw InputError(records[0].file, 0, "the input never moves, expected a record that sweeps it");
  // The densities come from the slowest record (004, section 4.1), the rate function from all.
  const TimeRecord* slowest = &records[0];
  double fastest = 0.0;
  for (const TimeRecord& record : records) {
    if (speed(record) < speed(*slowest)) slowest = &record;
    fastest = std::max(fastest, speed(record));
  }
  const bool many_rates = fastest > 1.5 * speed(*slowest);
  const std::span<const TimeRecord> base = many_rates ? std::span<const TimeRecord>(slowest, 1) : records;
  Identified out;
  std::vector<double> mu;
  double offset = 0.0;
  if (options.method == "paper") {
    const auto levels = static_cast<std::size_t>(options.size > 0 ? options.size : 10);
    EverettTrace trace(u.low, u.high, levels, CellShape::kp);
    Eigen::VectorXd y(static_cast<Eigen::Index>(counted_samples(base, options.skip_s)));
    Eigen::Index at = 0;
    for (const TimeRecord& record : base) {
      const std::size_t first = first_counted(record, options.skip_s);
      trace.add(record, first);
      for (std::size_t i = first; i < record.size(); ++i) y(at++) = record.y[i];
    }
    const double mean = y.mean();
    Eigen::VectorXd got;
    const auto cost = [&](const Eigen::VectorXd& x) {
      trace.apply(x, got);
      const double shift = mean - got.mean();
      return (got.array() + shift - y.array()).square().sum();
    };
    PsoCuckooOptions search;
    search.seed = options.seed;
    search.generations = static_cast<int>(300 * options.effort);
    const Eigen::VectorXd lower = Eigen::VectorXd::Zero(trace.columns());
    const double each = 6.0 * (y.maxCoeff() - y.minCoeff()) / static_cast<double>(trace.columns());
    const PsoCuckooResult found =
        pso_cuckoo(cost, lower, Eigen::VectorXd::Constant(trace.columns(), each), search);
    mu.assign(found.x.data(), found.x.data() + found.x.size());
    cost(found.x);
    offset = mean - got.mean();
    out.method = fmt::format("particle swarm with cuckoo search over {} densities, {} evaluations", mu.size(),
                             found.evaluations);
    out.notes.push_back(
        "the problem is convex: `--method best` solves it exactly and finds densities for finer grids too");
  } else {
    const auto levels = static_cast<std::size_t>(options.size > 0 ? options.size : 100);
    const PreisachWeights fit = fit_preisach_weights(base, options.skip_s, u.low, u.high, levels,
                                                     CellShape::kp, static_cast<int>(3000 * options.effort));
    mu = fit.weights;
    offset = fit.offset;
    out.converged = fit.converged;
    out.method = fmt::format(
        "non-negative least squares of {} densities on the stack of extremes (convex), {} iterations",
        mu.size(), fit.iterations);
    out.notes.push_back(fmt::format("{} of {} densities are above 0; {} kernels never move in the record",
                                    fit.active, mu.size(), fit.unseen));
  }
  double a1 = 1.0;
  double a2 = 0.0;
  if (many_rates) {
    Eigen::VectorXd lower(2), upper(2), typical(2), start(2);
    // a2 in units of 1/speed: at 0.3 the factor is e^(∓0.3) in the fastest record.
    lower << 0.05, 0.0;
    upper << 5.0, 0.5;
    typical << 1.0, 0.01;
    start << 1.0, 0.005;
    const LeastSquaresResult solved = least_squares(
        [&](const Eigen::VectorXd& x, Eigen::VectorXd& r) {
          const KrasnoselskiiPokrovskii model =
              KrasnoselskiiPokrovskii::from(to_parameters(u, mu, offset, x(0), x(1) / fastest));
          operator_residual(KpOperator(model), records, options.skip_s, r);
        },
        start, lower, upper, typical, 40);
    a1 = solved.x(0);
    a2 = solved.x(1) / fastest;
    out.uncertainty = {{"a1", a1, solved.deviation(0)}, {"a2", a2, solved.deviation(1) / fastest}};
    out.notes.push_back("densities from the slowest record, a1 and a2 from all");
    if (a2 == 0.0)
      out.notes.push_back("a2 is at its bound 0: the records' loops do not widen the way eq. 3 can follow");
  } else {
    out.notes.push_back("the records have one rate only: a1 = 1, a2 = 0 (classic KP)");
  }
  out.stage.model = checked_model("krasnoselskii_pokrovskii", to_parameters(u, mu, offset, a1, a2));
  out.compute_s = watch.seconds();
  return out;
}

}  // namespace

ModelType krasnoselskii_pokrovskii_type() {
  return {"krasnoselskii_pokrovskii",
          "weighted KP kernels on the stack of extremes, optionally with the rate function a1 exp(-a2 du/dt)",
          "004, eq. 1-14",
          infos(),
          check,
          make,
          make_inverse_of,
          identify};
}

}  // namespace bodesmith::hysteresis
