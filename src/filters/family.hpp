#pragma once

#include <complex>
#include <string_view>
#include <vector>

#include "base/registry.hpp"

namespace bodesmith::filters {

/// A low-pass filter with its corner at 1 rad/s,
///   H(s) = gain * prod (s - zero)/prod (s - pole),
/// stable, no more zeros than poles, complex roots in conjugate pairs. The greatest gain of the pass band is 1.
struct Prototype {
  double gain = 1.0;
  std::vector<std::complex<double>> zeros;
  std::vector<std::complex<double>> poles;

  std::complex<double> response(std::complex<double> s) const;
  /// -20 log10 |H(j w)| at w times the corner.
  double attenuation_db(double w) const;
};

struct PrototypeTask {
  int order = 4;
  double ripple_db = 0.5;  ///< of the pass band, where the family has one
  double stop_db = 60.0;   ///< least attenuation of the stop band, where the family has one
};

/// One family of standard filters; the table of them stands in registry.cpp.
class Family {
 public:
  /// What the corner at 1 rad/s is.
  enum class Corner { half_power, ripple_edge, stop_edge, six_db };

  virtual ~Family() = default;
  /// As users name it.
  virtual std::string_view name() const = 0;
  /// One line for a person.
  virtual std::string_view what() const = 0;
  virtual Corner corner() const { return Corner::half_power; }
  virtual bool has_ripple() const { return false; }
  virtual bool has_stop() const { return false; }
  virtual int highest_order() const { return 30; }
  /// Only even orders exist.
  virtual bool only_even() const { return false; }
  /// `task` is within what the functions above allow.
  virtual Prototype prototype(const PrototypeTask& task) const = 0;
};

/// Every family.
Registry<Family>& family_registry();

/// The prototype of a checked task: throws InputError for an order, ripple or attenuation that the family does not
/// have, in one line.
Prototype make_prototype(const Family& family, const PrototypeTask& task);

}  // namespace bodesmith::filters
