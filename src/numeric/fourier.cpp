#include "numeric/fourier.hpp"

#include <algorithm>
#include <bit>
#include <numbers>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "numeric/index.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;
using Bins = std::vector<Complex>;

/// Whether kissfft is fast at n: a prime factor p costs n p.
bool has_small_factors(std::size_t n) {
  if (n == 1) return false;  // kissfft has no plan for one sample
  for (std::size_t p = 2; p <= 31; ++p) {
    while (n % p == 0) n /= p;
  }
  return n == 1;
}

/// A transformer that keeps its tables of sines: one a thread, begun anew before they grow without bound.
class KeptTransform {
 public:
  Eigen::FFT<double>& of(std::size_t n, bool half) {
    if (std::ranges::find(sizes_, n) == sizes_.end()) {
      if (sizes_.size() == kMostSizes) {
        sizes_.clear();
        fft_ = Eigen::FFT<double>();
      }
      sizes_.push_back(n);
    }
    half ? fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum) : fft_.ClearFlag(Eigen::FFT<double>::HalfSpectrum);
    return fft_;
  }

 private:
  static constexpr std::size_t kMostSizes = 8;
  Eigen::FFT<double> fft_;
  std::vector<std::size_t> sizes_;
};

Eigen::FFT<double>& transform_of(std::size_t n, bool half) {
  thread_local KeptTransform kept;
  return kept.of(n, half);
}

Bins transform_smooth(const Bins& x) {
  Bins out;
  transform_of(x.size(), false).fwd(out, x);
  return out;
}

Bins transform_any(const Bins& x) {
  const std::size_t n = x.size();
  // n k = (n^2 + k^2 - (k - n)^2)/2; squares are taken modulo 2 n so that the angles keep their digits.
  Bins chirp(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t square = k * k % (2 * n);
    chirp[k] = std::polar(1.0, -std::numbers::pi * static_cast<double>(square) / static_cast<double>(n));
  }
  const std::size_t size = std::bit_ceil(2 * n - 1);
  Bins signal(size);
  Bins kernel(size);
  for (std::size_t k = 0; k < n; ++k) {
    signal[k] = x[k] * chirp[k];
    kernel[k] = std::conj(chirp[k]);
    if (k > 0) kernel[size - k] = kernel[k];
  }
  signal = transform_smooth(signal);
  kernel = transform_smooth(kernel);
  for (std::size_t k = 0; k < size; ++k) signal[k] *= kernel[k];
  signal = inverse_fourier(std::move(signal));
  signal.resize(n);
  for (std::size_t k = 0; k < n; ++k) signal[k] *= chirp[k];
  return signal;
}

void require_samples(std::size_t n) {
  if (n == 0) throw std::logic_error("a Fourier transform needs at least one sample");
}

}  // namespace

std::vector<Complex> fourier(std::vector<Complex> x) {
  require_samples(x.size());
  if (x.size() == 1) return x;
  return has_small_factors(x.size()) ? transform_smooth(x) : transform_any(x);
}

std::vector<Complex> inverse_fourier(std::vector<Complex> bins) {
  for (Complex& bin : bins) bin = std::conj(bin);
  Bins x = fourier(std::move(bins));
  const double scale = 1.0 / static_cast<double>(x.size());
  for (Complex& v : x) v = std::conj(v) * scale;
  return x;
}

std::vector<Complex> half_spectrum(std::span<const double> x) {
  require_samples(x.size());
  Bins bins;
  if (has_small_factors(x.size())) {
    const std::vector<double> real(x.begin(), x.end());
    transform_of(x.size(), true).fwd(bins, real);
  } else {
    bins = fourier(Bins(x.begin(), x.end()));
    bins.resize(x.size() / 2 + 1);
  }
  return bins;
}

std::vector<double> from_half_spectrum(const std::vector<Complex>& bins, std::size_t n) {
  require_samples(n);
  std::vector<double> x(n);
  if (has_small_factors(n)) {
    transform_of(n, true).inv(x, bins, eigen_index(n));
    return x;
  }
  Bins all(n);
  for (std::size_t k = 0; k <= n / 2; ++k) {
    all[k] = bins[k];
    if (k > 0 && 2 * k != n) all[n - k] = std::conj(bins[k]);
  }
  all = inverse_fourier(std::move(all));
  std::transform(all.begin(), all.end(), x.begin(), [](Complex v) { return v.real(); });
  return x;
}

std::size_t smooth_length(std::size_t n) {
  for (std::size_t m = n; m > 1; --m) {
    std::size_t rest = m;
    for (const std::size_t p : {2U, 3U, 5U}) {
      while (rest % p == 0) rest /= p;
    }
    if (rest == 1 && m % 2 == 0) return m;
  }
  return n;
}

}  // namespace bodesmith
