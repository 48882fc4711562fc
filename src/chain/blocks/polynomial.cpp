#include <algorithm>

#include "chain/block.hpp"
#include "chain/inverse.hpp"
#include "numeric/four.hpp"

namespace bodesmith::chain {
namespace {

class PolynomialCurve final : public CurveKernel {
 public:
  explicit PolynomialCurve(std::vector<double> coefficients) : c_(std::move(coefficients)) {}
  double value(double u) const override { return polynomial_at(c_, u); }
  double slope(double u) const override {
    double sum = 0.0;
    for (std::size_t i = c_.size(); i-- > 1;) sum = sum * u + static_cast<double>(i) * c_[i];
    return sum;
  }
  const std::vector<double>* polynomial() const override { return &c_; }
  void values(const double* u, double* y, std::size_t count) const override {
    std::size_t i = 0;
    for (; i + 4 <= count; i += 4) {
      const Four at = *four_at(u + i);
      Four sum = {0.0, 0.0, 0.0, 0.0};
      for (std::size_t k = c_.size(); k-- > 0;) sum = sum * at + c_[k];
      *four_at(y + i) = sum;
    }
    for (; i < count; ++i) y[i] = PolynomialCurve::value(u[i]);
  }

 private:
  std::vector<double> c_;
};

/// y = sum c_i u^i.
class Polynomial final : public BlockType {
 public:
  Polynomial()
      : BlockType("polynomial", "smooth static curve",
                  {list_of(any_number("coefficients", "y/uⁿ", "[c0, c1, ...]"))}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<PolynomialCurve>(block.list("coefficients"));
  }
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    const std::vector<double> c = block.list("coefficients");
    if (std::all_of(c.begin() + (c.empty() ? 0 : 1), c.end(), [](double v) { return v == 0.0; }))
      return std::nullopt;
    return inverse_of_polynomial(c, wanted);
  }
  std::vector<PolynomialList> polynomials() const override { return {{"coefficients", 1}}; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, polynomial_block, Polynomial)

}  // namespace bodesmith::chain
