#include "hysteresis/everett_trace.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::hysteresis {

namespace {

struct TraceCache {
  std::int32_t sample = -1;  ///< at which the turning point was
};

struct TraceStep {
  std::int32_t parent = -1;
  int direction = 0;
  TablePlace high;
  TablePlace low;
};

/// Rule of NestedLoops that writes down what was looked up instead of looking it up.
class TraceRule {
 public:
  using Cache = TraceCache;
  using Turn = LoopTurn<Cache>;

  TraceRule(double u_min, double u_max, std::size_t levels, CellShape shape, std::int32_t* sample,
            TraceStep* step)
      : u_min_(u_min),
        scale_(static_cast<double>(levels) / (u_max - u_min)),
        levels_(static_cast<int>(levels)),
        relays_(shape == CellShape::relays),
        sample_(sample),
        step_(step) {}

  Cache cache(double) const {
    // A turning point is taken one sample late.
    return {*sample_ - 1};
  }
  double output(const Turn& from, const Turn*, int direction, double u) const {
    const double here = position(u);
    const double there = position(from.u);
    step_->parent = from.cache.sample;
    step_->direction = direction;
    const double high = direction > 0 ? here : there;
    const double low = direction > 0 ? there : here;
    step_->high = split(relays_ ? std::floor(high) : high);
    step_->low = split(relays_ ? std::ceil(low) : low);
    if (relays_ && std::ceil(low) >= std::floor(high)) step_->direction = 0;
    return u;
  }
  double input(const Turn&, const Turn*, int, double, double now) const { return now; }

 private:
  double position(double u) const {
    return std::clamp((u - u_min_) * scale_, 0.0, static_cast<double>(levels_));
  }
  TablePlace split(double x) const {
    const int cell = std::min(static_cast<int>(x), levels_ - 1);
    return {cell, x - cell};
  }
  double u_min_;
  double scale_;
  int levels_;
  bool relays_;
  std::int32_t* sample_;
  TraceStep* step_;
};

}  // namespace

EverettTrace::EverettTrace(double u_min, double u_max, std::size_t levels, CellShape shape)
    : u_min_(u_min),
      u_max_(u_max),
      levels_(levels),
      shape_(shape),
      table_((levels + 1) * (levels + 1), 0.0) {}

void EverettTrace::add(const TimeRecord& record, std::size_t skip) {
  auto index = static_cast<std::int32_t>(samples_.size());
  TraceStep step;
  NestedLoops<TraceRule> loops(TraceRule(u_min_, u_max_, levels_, shape_, &index, &step), 4096);
  const auto restart = [&] {
    // All relays off: the turning point at u_min belongs to no sample.
    const std::int32_t keep = index;
    index = 0;
    loops.start(u_min_, u_min_, 1);
    index = keep;
  };
  restart();
  const auto stride = static_cast<std::int32_t>(levels_ + 1);
  for (std::size_t i = 0; i < record.size(); ++i, ++index) {
    Sample sample;
    if (record.u[i] <= u_min_) {
      restart();
    } else if (i > 0 && record.u[i] == loops.u()) {
      sample.parent = index - 1;
    } else {
      step = {};
      loops.step(record.u[i]);
      sample.parent = step.parent;
      sample.sign = static_cast<float>(step.direction);
      sample.high = step.high.cell * stride;
      sample.low = step.low.cell;
      sample.high_fraction = step.high.fraction;
      sample.low_fraction = step.low.fraction;
      sample.corner = shape_ == CellShape::kp ? std::max(0.0, step.high.fraction - step.low.fraction)
                                              : step.high.fraction * (1.0 - step.low.fraction);
    }
    if (i >= skip) sample.row = static_cast<std::int32_t>(rows_++);
    samples_.push_back(sample);
  }
  along_.resize(samples_.size());
}

void EverettTrace::apply(const Eigen::VectorXd& weights, Eigen::VectorXd& y) const {
  const std::size_t stride = levels_ + 1;
  double* table = table_.data();
  table[0] = 0.0;
  for (std::size_t a = 1; a <= levels_; ++a) {
    const double* row = weights.data() + a * (a - 1) / 2;
    double sum = 0.0;
    for (std::size_t b = a; b-- > 0;) {
      sum += row[b];
      table[a * stride + b] = table[(a - 1) * stride + b] + sum;
      if (b == a - 1) table[b * stride + a] = shape_ == CellShape::kp ? 0.0 : -table[a * stride + b];
    }
    table[a * stride + a] = 0.0;
  }
  y.resize(rows_);
  for (std::size_t t = 0; t < samples_.size(); ++t) {
    const Sample& s = samples_[t];
    double value = s.parent >= 0 ? along_[static_cast<std::size_t>(s.parent)] : 0.0;
    if (s.sign != 0.0F) {
      const double* row = table + s.high + s.low;
      const double* next = row + stride;
      value += static_cast<double>(s.sign) *
               (row[1] + s.high_fraction * (next[1] - row[1]) + (1.0 - s.low_fraction) * (row[0] - row[1]) +
                s.corner * (next[0] - row[0] - next[1] + row[1]));
    }
    along_[t] = value;
    if (s.row >= 0) y(s.row) = value;
  }
}

void EverettTrace::adjoint(const Eigen::VectorXd& residual, Eigen::VectorXd& gradient) const {
  const std::size_t stride = levels_ + 1;
  double* table = table_.data();
  std::ranges::fill(table_, 0.0);
  for (std::size_t t = 0; t < samples_.size(); ++t)
    along_[t] = samples_[t].row >= 0 ? residual(samples_[t].row) : 0.0;
  for (std::size_t t = samples_.size(); t-- > 0;) {
    const Sample& s = samples_[t];
    const double value = along_[t];
    if (s.parent >= 0) along_[static_cast<std::size_t>(s.parent)] += value;
    if (s.sign != 0.0F) {
      double* row = table + s.high + s.low;
      double* next = row + stride;
      const double part = static_cast<double>(s.sign) * value;
      row[0] += part * (1.0 - s.low_fraction - s.corner);
      row[1] += part * (s.low_fraction - s.high_fraction + s.corner);
      next[0] += part * s.corner;
      next[1] += part * (s.high_fraction - s.corner);
    }
  }
  // The mirror just above the diagonal is minus its image (0 for kp).
  for (std::size_t a = 1; a <= levels_; ++a) {
    if (shape_ != CellShape::kp) table[a * stride + a - 1] -= table[(a - 1) * stride + a];
    table[(a - 1) * stride + a] = 0.0;
  }
  // w(i, j) is part of T(a, b) for every a > i, b ≤ j: sums from below and from the left.
  gradient.resize(columns());
  std::vector<double>& column = column_;
  column.assign(stride, 0.0);
  for (std::size_t a = levels_; a >= 1; --a) {
    double* out = gradient.data() + a * (a - 1) / 2;
    double sum = 0.0;
    for (std::size_t b = 0; b < a; ++b) {
      column[b] += table[a * stride + b];
      sum += column[b];
      out[b] = sum;
    }
  }
}

}  // namespace bodesmith::hysteresis
