// y = u + a(t).
#include "simulate/ode_parts/ode_part.hpp"

namespace bodesmith::simulate {
namespace {

class SourcePart final : public OdePart {
 public:
  explicit SourcePart(const chain::SourceKernel& source) : source_(source) {}

  double start(double t, double u, bool /*still*/, double* /*x*/) override { return u + source_.value(t); }
  std::optional<double> output(double t, double u, const double* /*x*/) const override {
    return u + source_.value(t);
  }
  double newton(double /*gamma*/, double du, const double* /*x*/, double* /*z*/) override { return du; }

 private:
  SlopedValue pass(double t, SlopedValue in, const double* /*x*/, double* /*dx*/, Walk purpose) override {
    const double slope = purpose == Walk::rates ? in.slope : in.slope + source_.rate(t);
    return {in.value + source_.value(t), slope};
  }

  const chain::SourceKernel& source_;
};

}  // namespace

std::unique_ptr<OdePart> make_source_part(const chain::SourceKernel& source) {
  return std::make_unique<SourcePart>(source);
}

}  // namespace bodesmith::simulate
