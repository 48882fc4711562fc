#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "hysteresis/model_type.hpp"
#include "hysteresis/nested_loops.hpp"

namespace bodesmith::hysteresis {

/// The discretised Preisach model (Mayergoyz, Mathematical Models of Hysteresis, 1991; the rival in the disturbance paper
/// with L = 200 levels and L(L+1)/2 = 20100 relays). The input range [u_min, u_max] has L + 1 nodes n_0 …
/// n_L; relay (i, j), j ≤ i, switches to 1 when u rises to n_{i+1}, back to 0 when u falls to n_j, and weighs
/// w(i, j) ≥ 0:
///   y = offset + Σ w(i, j) R_ij[u].
/// Instead of all relays, the Everett function at the nodes
///   T(a, b) = Σ_{b ≤ j ≤ i < a} w(i, j),
/// what y gains when u rises from n_b to n_a, all relays of it being off,
/// and the stack of turning points serve: on a branch that left (u_t, y_t), y = y_t ± T(max, min).
///  * interpolation "bilinear" (default): T is bilinear between the nodes (and −T mirrored above the
///    diagonal), i.e. a relay's weight is spread evenly over its cell, the narrowest ones (i, i) become
///    reversible. Continuous; the inverse is exact (search among nodes, then a linear equation).
///  * interpolation "relays": the relays as they are, a staircase. Equal to all relays by brute force to
///    rounding.
/// Outside [u_min, u_max] y stays saturated. A reset comes up from u_min (all relays off). Rate-independent;
/// wiping-out, congruency, return-point memory hold exactly. w ≥ 0 makes y rise with u and loops run
/// counter-clockwise: ∮ u dy ≥ 0.
struct EverettTable {
  double u_min = 0.0;
  double u_max = 1.0;
  std::size_t levels = 1;      ///< L
  std::vector<double> values;  ///< T(a, b), row a of L + 1 numbers; antisymmetric

  double at(std::size_t a, std::size_t b) const { return values[a * (levels + 1) + b]; }
  double node(std::size_t a) const {
    return u_min + (u_max - u_min) * static_cast<double>(a) / static_cast<double>(levels);
  }
  /// From weights in row order: (0,0), (1,0), (1,1), (2,0), …
  static EverettTable from_weights(double u_min, double u_max, std::size_t levels,
                                   const std::vector<double>& w);
  /// Of u_min, u_max and the list of weights of that name. Throws DesignError where they do not go together.
  static EverettTable from_parameters(const Parameters& values, const char* weights);
};

/// A place in the table: cell and fraction of it.
struct TablePlace {
  int cell = 0;
  double fraction = 0.0;
};

/// What the rules of NestedLoops over an EverettTable share; `Rule` gives double everett(high, low), the Everett
/// function between the nodes.
template <class Rule>
class TableRule {
 public:
  using Cache = TablePlace;
  using Turn = LoopTurn<Cache>;

  Cache cache(double u) const {
    const double x = (u - u_min_) * scale_;
    if (!(x > 0.0)) return {0, 0.0};
    if (x >= last_) return {cells_ - 1, 1.0};
    const int cell = static_cast<int>(x);
    return {cell, x - cell};
  }
  double output(const Turn& from, const Turn*, int direction, double u) const {
    const Rule& rule = static_cast<const Rule&>(*this);
    const TablePlace here = cache(u);
    return direction > 0 ? from.y + rule.everett(here, from.cache) : from.y - rule.everett(from.cache, here);
  }

 protected:
  explicit TableRule(std::shared_ptr<const EverettTable> table)
      : table_(std::move(table)),
        data_(table_->values.data()),
        u_min_(table_->u_min),
        scale_(static_cast<double>(table_->levels) / (table_->u_max - table_->u_min)),
        last_(static_cast<double>(table_->levels)),
        step_((table_->u_max - table_->u_min) / static_cast<double>(table_->levels)),
        cells_(static_cast<int>(table_->levels)) {}

  std::shared_ptr<const EverettTable> table_;
  const double* data_;
  double u_min_;
  double scale_;
  double last_;
  double step_;
  int cells_;
};

/// Rule of NestedLoops: bilinear Everett function.
class BilinearEverett : public TableRule<BilinearEverett> {
 public:
  explicit BilinearEverett(std::shared_ptr<const EverettTable> table) : TableRule(std::move(table)) {}
  /// T(high, low).
  double everett(const TablePlace& high, const TablePlace& low) const {
    const double* row = data_ + static_cast<std::ptrdiff_t>(high.cell) * (cells_ + 1) + low.cell;
    const double* next = row + cells_ + 1;
    const double lower = row[0] + low.fraction * (row[1] - row[0]);
    const double upper = next[0] + low.fraction * (next[1] - next[0]);
    return lower + high.fraction * (upper - lower);
  }
  double input(const Turn& from, const Turn* toward, int direction, double y, double now) const;
};

/// Rule of NestedLoops: the relays as they are. No inverse (a staircase has none).
class RelayEverett {
 public:
  using Cache =
      int;  ///< the last node at or below u for a rising end, kept as twice the node + (1 when above it)
  using Turn = LoopTurn<Cache>;

  explicit RelayEverett(std::shared_ptr<const EverettTable> table);
  Cache cache(double u) const;
  double output(const Turn& from, const Turn*, int direction, double u) const;
  double input(const Turn&, const Turn*, int, double, double now) const { return now; }

 private:
  std::shared_ptr<const EverettTable> table_;
};

struct Preisach {
  std::shared_ptr<const EverettTable> table;
  double offset = 0.0;
  bool bilinear = true;

  static Preisach from(const Parameters& values);
};

template <class Rule>
class EverettOperator final : public Operator {
 public:
  EverettOperator(Rule rule, double u_min, double offset)
      : loops_(std::move(rule), 4096), u_min_(u_min), offset_(offset) {
    reset(u_min);
  }
  double reset(double u) override {
    loops_.start(u_min_, offset_, 1);
    return step(u, 0.0);
  }
  double step(double u, double) override {
    // All relays are off at the lower end whatever came before: no rounding survives it.
    if (u <= u_min_) {
      loops_.start(u_min_, offset_, 1);
      return offset_;
    }
    return loops_.step(u);
  }
  double peek(double u, double) const override { return u <= u_min_ ? offset_ : loops_.peek(u); }
  bool rate_independent() const override { return true; }
  std::size_t depth() const { return loops_.depth(); }
  NestedLoops<Rule>& loops() { return loops_; }
  const NestedLoops<Rule>& loops() const { return loops_; }

 private:
  NestedLoops<Rule> loops_;
  double u_min_;
  double offset_;
};

template <class Rule>
class EverettInverse final : public Inverse {
 public:
  EverettInverse(EverettOperator<Rule> forward, double u_min, double y_min, double y_max)
      : forward_(std::move(forward)), u_min_(u_min), y_min_(y_min), y_max_(y_max) {}
  double reset(double y) override {
    forward_.reset(u_min_);
    return step(y, 0.0);
  }
  double step(double y, double) override {
    if (y <= y_min_) {
      forward_.reset(u_min_);
      return u_min_;
    }
    return forward_.loops().invert(y < y_max_ ? y : y_max_);
  }
  double achieved() const override { return forward_.loops().y(); }

 private:
  EverettOperator<Rule> forward_;
  double u_min_;
  double y_min_;
  double y_max_;
};

Identified identify_preisach(std::span<const TimeRecord> records, const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
