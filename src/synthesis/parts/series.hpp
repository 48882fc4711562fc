#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::synthesis {

/// The preferred values of IEC 60063: E3, E6, E12, E24 (table values) and E48, E96, E192 (round(10^(i/N), 2
/// decimals), with the table's one exception, 9.20 in E192), or `exact`: every value. A list of values in
/// stock, given as numbers, may stand in their place.
class Series {
 public:
  /// "E12" … "E192" or "exact". Throws InputError that lists the names.
  static Series named(std::string_view name);
  /// Only these values (ohm or farad, all above 0), e.g. a drawer of parts. `name` is what parts lists show.
  static Series stock(std::string name, std::vector<double> values);

  const std::string& name() const { return name_; }
  bool is_exact() const { return mantissas_.empty() && stock_.empty(); }
  /// At most six values a decade: E3, E6.
  bool is_coarse() const { return !mantissas_.empty() && mantissas_.size() <= 6; }
  bool is_stock() const { return !stock_.empty(); }
  /// Every value in [low, high], rising. Empty for `exact`.
  std::vector<double> values(double low, double high) const;
  /// Nearest in log; the value itself for `exact`. Rounds up a decade when that is nearer (9.95 to 10).
  double nearest(double value) const;
  /// The nearest that is not below; the value itself for `exact`.
  double nearest_above(double value) const;
  /// The `count` nearest values, nearest first; the value itself for `exact`.
  std::vector<double> nearest(double value, int count) const;

 private:
  std::string name_;
  std::vector<double> mantissas_;  ///< in [1, 10)
  std::vector<double> stock_;
};

}  // namespace bodesmith::synthesis
