#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

/// A Butterworth filter of half the order, squared: low pass and high pass of one corner add up to an all-pass
/// (S. H. Linkwitz, "Active crossover networks for noncoincident drivers", 1976).
class LinkwitzRiley final : public Family {
 public:
  std::string_view name() const override { return "linkwitz-riley"; }
  std::string_view what() const override { return "crossovers that add up to an all-pass; corner = -6 dB"; }
  Corner corner() const override { return Corner::six_db; }
  bool only_even() const override { return true; }
  Prototype prototype(const PrototypeTask& task) const override {
    const int half = task.order / 2;
    std::vector<std::complex<double>> poles;
    for (int twice = 0; twice < 2; ++twice) {
      for (const std::complex<double>& point : upper_unit_points(half)) {
        add_pair(poles, {-point.imag(), point.real()});
      }
      if (half % 2 != 0) poles.emplace_back(-1.0, 0.0);
    }
    Prototype out = all_pole(std::move(poles));
    out.gain = 1.0;
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Family, linkwitz_riley_family, LinkwitzRiley)

}  // namespace bodesmith::filters
