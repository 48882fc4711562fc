#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace bodesmith::hysteresis {

/// A turning point, and what the branch's rule wants kept with it.
template <class Cache>
struct LoopTurn {
  double u = 0.0;
  double y = 0.0;
  Cache cache{};
};

/// The memory of every operator with wiping-out: the stack of turning points (u, y) that later motion has not
/// yet passed (Mayergoyz, Mathematical Models of Hysteresis, 1991; the "extreme stacks" of the exponential-operator paper, condition
/// 1-4). The input leaves the last turning point `from` and heads for the one before it, `toward`; reaching
/// that closes the inner loop, both are forgotten and the enclosing branch goes on (return-point memory).
/// Passing the oldest point leaves only the newest one. Amortised O(1) a step, worst O(depth).
///
/// `Rule` gives the shape of a branch:
///   using Cache = …;
///   Cache cache(double u) const;                                 what it wants kept with a turning point
///   double output(from, toward, int direction, u) const;         y on the branch
///   double input(from, toward, int direction, y, u_now) const;   its inverse, for outputs that rise with u
/// where from and toward (which may be null) are Turns (u, y, cache) and u_now is where the input is before the
/// move.
///
/// Memory is fixed: when more than `capacity` loops are nested, the innermost (smallest) closed one is
/// forgotten. Nothing allocates after construction.
template <class Rule>
class NestedLoops {
 public:
  using Turn = LoopTurn<typename Rule::Cache>;

  NestedLoops(Rule rule, std::size_t capacity)
      : rule_(std::move(rule)), capacity_(capacity < 8 ? 8 : capacity) {
    turns_.reserve(capacity_);
    start(0.0, 0.0, 1);
  }
  NestedLoops(const NestedLoops& other)
      : rule_(other.rule_),
        capacity_(other.capacity_),
        u_(other.u_),
        y_(other.y_),
        direction_(other.direction_) {
    turns_.reserve(capacity_);
    turns_ = other.turns_;
  }
  NestedLoops& operator=(const NestedLoops&) = delete;

  /// Rests at (u, y), having left there in `direction` (+1: rising).
  void start(double u, double y, int direction) {
    turns_.clear();
    turns_.push_back({u, y, rule_.cache(u)});
    u_ = u;
    y_ = y;
    direction_ = direction;
  }

  double step(double u) {
    if (u == u_) return y_;
    const int direction = u > u_ ? 1 : -1;
    if (direction != direction_) turn();
    const double way = static_cast<double>(direction_);
    while (turns_.size() >= 2 && (u - turns_[turns_.size() - 2].u) * way >= 0.0) pop();
    u_ = u;
    return y_ = rule_.output(turns_.back(), toward(turns_.size()), direction_, u);
  }

  double peek(double u) const {
    if (u == u_) return y_;
    const int direction = u > u_ ? 1 : -1;
    const double way = static_cast<double>(direction);
    std::size_t size = turns_.size();
    if (direction != direction_) {
      if (u_ == turns_.back().u) {
        // Turning back at once undoes the last turn.
        if (size == 1) return rule_.output(turns_[0], nullptr, direction, u);
        --size;
      } else {
        if ((u - turns_.back().u) * way < 0.0) {
          const Turn here{u_, y_, rule_.cache(u_)};
          return rule_.output(here, &turns_.back(), direction, u);
        }
        if (size == 1) {
          const Turn here{u_, y_, rule_.cache(u_)};
          return rule_.output(here, nullptr, direction, u);
        }
        --size;
      }
    }
    while (size >= 3 && (u - turns_[size - 2].u) * way >= 0.0) size -= 2;
    const Turn* beyond = size >= 2 ? &turns_[size - 2] : nullptr;
    if (size == 2 && (u - turns_[0].u) * way >= 0.0) beyond = nullptr;
    return rule_.output(turns_[size - 1], beyond, direction, u);
  }

  /// The input that makes the output y, and goes there. Outputs must rise with the input.
  double invert(double y) {
    if (y == y_) return u_;
    const int direction = y > y_ ? 1 : -1;
    const double way = static_cast<double>(direction);
    if (direction != direction_) turn();
    while (turns_.size() >= 2 && (y - turns_[turns_.size() - 2].y) * way >= 0.0) pop();
    const double u = rule_.input(turns_.back(), toward(turns_.size()), direction_, y, u_);
    u_ = u;
    y_ = rule_.output(turns_.back(), toward(turns_.size()), direction_, u);
    return u;
  }

  double u() const { return u_; }
  double y() const { return y_; }
  int direction() const { return direction_; }
  std::size_t depth() const { return turns_.size(); }
  const Rule& rule() const { return rule_; }

 private:
  const Turn* toward(std::size_t size) const { return size >= 2 ? &turns_[size - 2] : nullptr; }

  void turn() {
    direction_ = -direction_;
    if (u_ == turns_.back().u) {
      if (turns_.size() >= 2) turns_.pop_back();
      return;
    }
    if (turns_.size() == capacity_) {
      // The innermost closed loop goes: its two turning points are the newest.
      turns_.pop_back();
      turns_.pop_back();
    }
    turns_.push_back({u_, y_, rule_.cache(u_)});
  }

  void pop() {
    if (turns_.size() == 2) {
      turns_[0] = turns_[1];
      turns_.pop_back();
    } else {
      turns_.pop_back();
      turns_.pop_back();
    }
  }

  Rule rule_;
  std::size_t capacity_;
  std::vector<Turn> turns_;
  double u_ = 0.0;
  double y_ = 0.0;
  int direction_ = 1;
};

}  // namespace bodesmith::hysteresis
