#include "fit/measured/factored_response.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "numeric/index.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;
using Factor = FactoredResponse::Factor;

Complex factor_value(const Factor& f, Complex s) {
  return f.pair ? s * s + 2.0 * f.damping * f.frequency * s + f.frequency * f.frequency : s + f.frequency;
}

int count_roots(const std::vector<Factor>& factors) {
  int count = 0;
  for (const Factor& f : factors) count += f.pair ? 2 : 1;
  return count;
}

std::vector<Complex> roots_of(const std::vector<Factor>& factors) {
  std::vector<Complex> out;
  for (const Factor& f : factors) {
    for (const Complex& r : f.roots()) out.push_back(r);
  }
  return out;
}

/// The parameters in a row: gain, delay (when free), pole factors, zero factors.
class ParameterRow {
 public:
  explicit ParameterRow(const FactoredResponse& model) : model_(model) {}

  std::vector<SearchVariable> variables() const {
    std::vector<SearchVariable> out{linear(model_.gain, std::abs(model_.gain))};
    if (model_.fits_delay) {
      out.push_back(linear(model_.delay, 1.0));
      out.back().min = 0.0;
    }
    for (const Factor& f : model_.poles) {
      out.push_back(logarithmic(f.frequency, 1e-12, 1e12));
      if (f.pair) out.push_back(logarithmic(f.damping, 1e-9, 1e6));
    }
    for (const Factor& f : model_.zeros) {
      if (f.pair) {
        out.push_back(logarithmic(f.frequency, 1e-12, 1e12));
        out.push_back(linear(f.damping, std::max(std::abs(f.damping), 1e-3)));
      } else {
        out.push_back(linear(f.frequency, std::max(std::abs(f.frequency), 1e-6)));
      }
    }
    return out;
  }

  /// The model with these values; deviations too where they are given.
  FactoredResponse with(const Eigen::VectorXd& values, const Eigen::VectorXd* deviation = nullptr) const {
    FactoredResponse out = model_;
    Eigen::Index at = 0;
    const auto take = [&](double& value, double& spread) {
      value = values(at);
      if (deviation != nullptr) spread = (*deviation)(at);
      ++at;
    };
    take(out.gain, out.gain_deviation);
    if (out.fits_delay) take(out.delay, out.delay_deviation);
    for (auto* factors : {&out.poles, &out.zeros}) {
      for (Factor& f : *factors) {
        take(f.frequency, f.frequency_deviation);
        if (f.pair) take(f.damping, f.damping_deviation);
      }
    }
    return out;
  }

 private:
  static SearchVariable linear(double value, double scale) { return {.value = value, .scale = scale}; }
  static SearchVariable logarithmic(double value, double min, double max) {
    return {.value = std::clamp(value, 2.0 * min, 0.5 * max), .min = min, .max = max, .logarithmic = true};
  }
  const FactoredResponse& model_;
};

/// d ln(factor)/d(frequency) and /d(damping).
struct FactorSlopes {
  Complex by_frequency;
  Complex by_damping;
};
FactorSlopes slopes(const Factor& f, Complex s) {
  Complex value = factor_value(f, s);
  if (value == Complex(0.0)) value = 1e-300;  // a zero exactly on a sample
  if (!f.pair) return {1.0 / value, 0.0};
  return {(2.0 * f.damping * s + 2.0 * f.frequency) / value, 2.0 * f.frequency * s / value};
}

void fill_derivatives(const FactoredResponse& model, const ResponseSamples& samples, Eigen::MatrixXd& out) {
  const Eigen::Index rows = eigen_index(samples.s.size());
  out.resize(2 * rows, model.parameter_count());
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Complex s = samples.s[std_index(i)];
    const Complex h = model.response(s) / samples.deviation[std_index(i)];
    Eigen::Index column = 0;
    const auto put = [&](Complex value) {
      out(i, column) = value.real();
      out(rows + i, column) = value.imag();
      ++column;
    };
    put(h / model.gain);
    if (model.fits_delay) put(-s * h);
    for (const bool pole : {true, false}) {
      for (const Factor& f : pole ? model.poles : model.zeros) {
        const FactorSlopes slope = slopes(f, s);
        put((pole ? -1.0 : 1.0) * h * slope.by_frequency);
        if (f.pair) put((pole ? -1.0 : 1.0) * h * slope.by_damping);
      }
    }
  }
}

}  // namespace

std::vector<Complex> FactoredResponse::Factor::roots() const {
  if (!pair) return {{-frequency, 0.0}};
  const double rest = (1.0 - damping) * (1.0 + damping);
  if (rest > 0.0) {
    const Complex root(-damping * frequency, frequency * std::sqrt(rest));
    return {root, std::conj(root)};
  }
  const double large = -frequency * (damping + std::copysign(std::sqrt(-rest), damping));
  return {{large, 0.0}, {frequency * (frequency / large), 0.0}};
}

/// A pair may become two real roots, so that they may meet and part.
std::vector<Factor> FactoredResponse::factors_of(const std::vector<Complex>& roots) {
  std::vector<Factor> out;
  for (const Complex& r : roots) {
    if (r.imag() > 0.0) out.push_back({true, std::abs(r), -r.real() / std::abs(r)});
    if (r.imag() == 0.0) out.push_back({false, -r.real(), 1.0});
  }
  return out;
}

FactoredResponse FactoredResponse::of(const RationalRoots& roots, double largest_s, double reach) {
  FactoredResponse out;
  out.gain = roots.gain;
  std::vector<Complex> near;
  Complex folded = 1.0;
  for (const Complex& z : roots.zeros) {
    if (std::abs(z) > reach * largest_s) {
      folded *= -z;
    } else {
      near.push_back(z);
    }
  }
  out.gain *= folded.real();
  out.poles = factors_of(roots.poles);
  out.zeros = factors_of(near);
  return out;
}

int FactoredResponse::pole_count() const {
  return count_roots(poles);
}
int FactoredResponse::zero_count() const {
  return count_roots(zeros);
}
int FactoredResponse::parameter_count() const {
  return 1 + (fits_delay ? 1 : 0) + pole_count() + zero_count();
}

Complex FactoredResponse::response(Complex s) const {
  Complex h = gain;
  if (delay != 0.0) h *= std::exp(-s * delay);
  for (std::size_t i = 0; i < std::max(poles.size(), zeros.size()); ++i) {
    if (i < zeros.size()) h *= factor_value(zeros[i], s);
    if (i < poles.size()) h /= factor_value(poles[i], s);
  }
  return h;
}

std::vector<Complex> FactoredResponse::pole_roots() const {
  return roots_of(poles);
}
std::vector<Complex> FactoredResponse::zero_roots() const {
  return roots_of(zeros);
}

FactoredResponse refine(const FactoredResponse& start, const ResponseSamples& samples, int iterations) {
  const ParameterRow row(start);
  const std::size_t count = samples.s.size();
  const Residuals residuals = [&](const Eigen::VectorXd& values, Eigen::VectorXd& out) {
    const FactoredResponse model = row.with(values);
    out.resize(eigen_index(2 * count));
    for (std::size_t i = 0; i < count; ++i) {
      const Complex e = (model.response(samples.s[i]) - samples.response[i]) / samples.deviation[i];
      if (!std::isfinite(e.real()) || !std::isfinite(e.imag())) return false;
      out(eigen_index(i)) = e.real();
      out(eigen_index(count + i)) = e.imag();
    }
    return true;
  };
  LeastSquaresOptions options;
  options.max_iterations = iterations;
  options.cost_tolerance = 1e-9;
  options.broyden = false;
  options.stop = interrupted;
  options.jacobian = [&](const Eigen::VectorXd& values, Eigen::MatrixXd& derivatives) {
    fill_derivatives(row.with(values), samples, derivatives);
  };
  const LeastSquaresResult result = least_squares(row.variables(), residuals, options);
  if (result.residuals.size() == 0) {
    FactoredResponse unchanged = start;
    unchanged.cost = INFINITY;
    return unchanged;
  }
  FactoredResponse out = row.with(result.values, &result.deviation);
  out.cost = result.cost;
  out.converged = result.termination == Termination::gradient || result.termination == Termination::step ||
                  result.termination == Termination::cost;
  return out;
}

FactoredResponse without_far_zeros(FactoredResponse model, const ResponseSamples& samples) {
  const double top = samples.s.back().imag();
  const double price_of_one = std::log(2.0 * static_cast<double>(samples.s.size()));
  // All beyond the band at once, then only those farther out.
  for (const double reach : {1.03, 1.5, 2.5, 5.0, 10.0}) {
    FactoredResponse simpler = model;
    std::erase_if(simpler.zeros, [&](const Factor& f) {
      if (std::abs(f.frequency) < reach * top) return false;
      simpler.gain *= f.pair ? f.frequency * f.frequency : f.frequency;
      return true;
    });
    const int removed = model.zero_count() - simpler.zero_count();
    if (removed == 0) break;
    simpler = refine(simpler, samples, 30);
    if (simpler.cost > model.cost + price_of_one * removed) continue;
    model = std::move(simpler);
    break;
  }
  return model;
}

FactoredResponse with_zeros_at_rest(FactoredResponse model, const ResponseSamples& samples) {
  const double price_of_one = std::log(2.0 * static_cast<double>(samples.s.size()));
  const double lowest = samples.s.front().imag();
  for (std::size_t i = 0; i < model.zeros.size(); ++i) {
    if (!(std::abs(model.zeros[i].frequency) < lowest)) continue;
    FactoredResponse simpler = model;
    Factor at_rest;
    at_rest.frequency = 0.0;
    at_rest.frequency_deviation = model.zeros[i].frequency_deviation;
    simpler.zeros[i] = at_rest;
    if (model.zeros[i].pair) simpler.zeros.push_back(at_rest);
    simpler.cost = 0.0;
    for (std::size_t k = 0; k < samples.s.size(); ++k)
      simpler.cost +=
          std::norm((simpler.response(samples.s[k]) - samples.response[k]) / samples.deviation[k]);
    if (simpler.cost <= model.cost + price_of_one * (model.zeros[i].pair ? 2.0 : 1.0))
      model = std::move(simpler);
  }
  return model;
}

}  // namespace bodesmith
