// Grünwald and Letnikov's differences (tool-servo paper, eq. 2) of a linear chain: with s -> (1 - z^-1)/h its response is a power
// series in z^-1 whose coefficients are its impulse response, for powers of s of any order (Podlubny, Fractional Differential
// Equations, 1999, ch. 7; Lubich, Numer. Math. 52 (1988) 129). First order in h: what a paper computed so, not the best there is.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/error.hpp"
#include "chain/kernel.hpp"
#include "numeric/fourier.hpp"
#include "simulate/engines/engine.hpp"

namespace bodesmith::simulate {
namespace {

std::optional<Complex> transfer_of(const chain::Block& block, const chain::Kernel& kernel, Complex s) {
  if (const auto exact = block.transfer(s)) return exact;
  if (const auto* linear = std::get_if<chain::LinearKernel>(&kernel)) return chain::response(*linear, s);
  return std::nullopt;
}

/// The chain's transfer function; InputError where a block has none.
class Transfer {
 public:
  explicit Transfer(const chain::Chain& chain) : chain_(chain) {
    for (const chain::Block& block : chain.blocks) kernels_.push_back(block.kernel());
  }
  Complex operator()(Complex s) const {
    Complex h = 1.0;
    for (std::size_t i = 0; i < kernels_.size(); ++i) {
      const auto factor = transfer_of(chain_.blocks[i], kernels_[i], s);
      if (!factor) {
        throw InputError(
            fmt::format("block {} ({}) is not linear: Grünwald and Letnikov's differences take "
                        "linear blocks only",
                        i + 1, chain_.blocks[i].type_name()));
      }
      h *= *factor;
    }
    return h;
  }

 private:
  const chain::Chain& chain_;
  std::vector<chain::Kernel> kernels_;
};

/// The first n coefficients of H((1 - z)/h), by Cauchy's integral on a circle within the unit one; what the sampled circle adds
/// of later ones is a 1e-10th of them.
std::vector<double> impulse_response(const Transfer& transfer, double h, std::size_t n) {
  const std::size_t points = 2 * n;
  const double radius = std::pow(1e-10, 1.0 / static_cast<double>(points));
  std::vector<Complex> values(points);
  for (std::size_t k = 0; k <= points / 2; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(points);
    values[k] = transfer((1.0 - std::polar(radius, -angle)) / h);
    if (k > 0) values[points - k] = std::conj(values[k]);
  }
  const std::vector<Complex> sums = inverse_fourier(std::move(values));
  std::vector<double> out(n);
  for (std::size_t j = 0; j < n; ++j) out[j] = sums[j].real() * std::pow(radius, -static_cast<double>(j));
  return out;
}

std::vector<double> convolved(const std::vector<double>& f, const std::vector<double>& x) {
  const std::size_t n = f.size();
  std::vector<double> a = f, b = x;
  a.resize(2 * n, 0.0);
  b.resize(2 * n, 0.0);
  std::vector<Complex> product = half_spectrum(a);
  const std::vector<Complex> other = half_spectrum(b);
  for (std::size_t k = 0; k < product.size(); ++k) product[k] *= other[k];
  std::vector<double> y = from_half_spectrum(product, 2 * n);
  y.resize(n);
  return y;
}

class GrunwaldLetnikovEngine final : public ChainEngine {
 public:
  Engine which() const override { return Engine::grunwald_letnikov; }
  std::string_view method(const chain::Kernel& /*kernel*/) const override {
    return "Grünwald and Letnikov's differences";
  }
  std::variant<Result, NoClosedForm> run(const chain::Chain& chain, const TimeRecord& input,
                                         const Options& options) const override {
    const Transfer transfer(chain);
    const std::size_t parts = options.oversample, fine = (input.size() - 1) * parts + 1;
    const double h = input.step_s / static_cast<double>(parts);
    // From rest under the first input: what is beyond it, and its answer at rest.
    double from = 0.0, rest = 0.0;
    if (start_of(chain, options.start) == Start::equilibrium) {
      from = input.u.front();
      rest = from * transfer(0.0).real();
      if (!std::isfinite(rest)) throw InputError("the model has no state of rest under its first input");
    }
    std::vector<double> x(fine);
    for (std::size_t i = 0; i < fine; ++i) {
      const std::size_t k = i / parts;
      const double part = static_cast<double>(i % parts) / static_cast<double>(parts);
      x[i] = input.u[k] + (part > 0.0 ? part * (input.u[k + 1] - input.u[k]) : 0.0) - from;
    }
    const std::vector<double> y = convolved(impulse_response(transfer, h, fine), x);
    // Offsets and drifts: what the chain makes of no input.
    TimeRecord silence = input;
    std::ranges::fill(silence.u, 0.0);
    Options plain;
    plain.estimate_error = false;
    Result out = run_record(chain, silence, plain);
    for (std::size_t i = 0; i < input.size(); ++i) out.y[i] += rest + y[i * parts];
    out.model_error = 0.0;
    out.stats = {};
    out.stats.engine = Engine::grunwald_letnikov;
    out.stats.steps = fine;
    return out;
  }
  /// Of half the step; the error is of first order.
  double estimate_error(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                        const Result& result) const override {
    Options finer = options;
    finer.oversample *= 2;
    const Result half = std::get<Result>(run(chain, input, finer));
    double worst = 0.0;
    for (std::size_t i = 0; i < half.y.size(); ++i)
      worst = std::max(worst, 2.0 * std::abs(half.y[i] - result.y[i]));
    return worst;
  }
};

}  // namespace

BODESMITH_ENTRY(ChainEngine, grunwald_letnikov_engine, GrunwaldLetnikovEngine)

}  // namespace bodesmith::simulate
