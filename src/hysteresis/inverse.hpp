#pragma once

#include <memory>

namespace bodesmith::hysteresis {

/// A scalar operator with memory, y(t) = H[u](t), driven along a piecewise monotone input. Nothing allocates
/// in step() and peek(). Rate-independent operators ignore dt_s.
class Operator {
 public:
  virtual ~Operator() = default;

  /// Forgets everything and rests under the input u; returns the output there.
  virtual double reset(double u) = 0;
  /// The input moves monotonically from where it was to u within dt_s seconds; returns the output at its end.
  virtual double step(double u, double dt_s) = 0;
  /// What step() would return, without taking the step.
  virtual double peek(double u, double dt_s) const = 0;
  virtual bool rate_independent() const = 0;
};

/// The right inverse of an Operator along a reference: step(y) returns the input u for which H[…, u] = y,
/// and remembers that it was applied. Nothing allocates in step().
class Inverse {
 public:
  virtual ~Inverse() = default;

  /// Forgets everything; the model rests under the returned input, at the reference y where it can be
  /// reached.
  virtual double reset(double y) = 0;
  /// The reference moves to y within dt_s seconds; returns the input at its end.
  virtual double step(double y, double dt_s) = 0;
  /// What the model puts out under the input returned last: the reference, unless that is out of reach.
  virtual double achieved() const { return achieved_; }

 protected:
  double achieved_ = 0.0;
};

/// One that tries inputs in [u_min, u_max] on the operator itself.
class SearchedInverse : public Inverse {
 public:
  SearchedInverse(std::unique_ptr<Operator> forward, double u_min, double u_max);

 protected:
  std::unique_ptr<Operator> forward_;
  double u_min_;
  double u_max_;
  double u_;
};

/// Works for every Operator whose output rises with its input: brackets the input from where it was by
/// growing steps inside [u_min, u_max], then narrows on peek() (Alefeld, Potra and Shi, TOMS 748) down to the last bits.
class BracketingInverse final : public SearchedInverse {
 public:
  using SearchedInverse::SearchedInverse;
  double reset(double y) override;
  double step(double y, double dt_s) override;

 private:
  double stride_ = 0.0;  ///< size of the last move, the first guess for the next
};

/// The paper's recursive search (KP paper, eq. 13, 14): the input moves by delta_u until the output passes the
/// reference, then the last two outputs are interpolated linearly. Slower and less exact than
/// BracketingInverse; kept for the comparison. Gives up at [u_min, u_max].
class RecursiveInverse final : public SearchedInverse {
 public:
  RecursiveInverse(std::unique_ptr<Operator> forward, double delta_u, double u_min, double u_max)
      : SearchedInverse(std::move(forward), u_min, u_max), delta_u_(delta_u) {}
  double reset(double y) override;
  double step(double y, double dt_s) override;

 private:
  double delta_u_;
};

}  // namespace bodesmith::hysteresis
