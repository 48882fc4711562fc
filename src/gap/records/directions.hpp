#pragma once

#include <span>
#include <vector>

namespace bodesmith::gap {

/// Orthonormal directions over the samples of a record, found one after the other (Gram and Schmidt; each twice, which is enough: Giraud,
/// Langou, Rozloznik, Computers & Mathematics with Applications 50 (2005) 1069).
class Directions {
 public:
  /// Adds what is v's own in addition to those before; nothing where they explain it but for a hundred thousandth.
  void add(std::vector<double> v);
  /// Takes out of a signal over the same samples what they explain.
  void take_out(std::span<double> v) const;
  const std::vector<std::vector<double>>& all() const { return all_; }

 private:
  std::vector<std::vector<double>> all_;
};

}  // namespace bodesmith::gap
