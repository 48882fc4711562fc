#include "numeric/power_of_two_transform.hpp"

#include <bit>
#include <numbers>
#include <stdexcept>

#include "numeric/clones.hpp"
#include "numeric/four.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

Complex turn_of(std::size_t k, std::size_t n) {
  return std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
}

/// Four numbers each of four transforms side by side.
struct Quarter {
  Four re[4], im[4];
};

/// The four of every transform become their four sums, which turn by w, w^2 and w^3 (re and im of each).
__attribute__((always_inline)) inline void butterfly(Quarter& v, const Four* w) {
  const Four a_re = v.re[0] + v.re[2], a_im = v.im[0] + v.im[2];
  const Four b_re = v.re[0] - v.re[2], b_im = v.im[0] - v.im[2];
  const Four c_re = v.re[1] + v.re[3], c_im = v.im[1] + v.im[3];
  const Four d_re = v.re[1] - v.re[3], d_im = v.im[1] - v.im[3];  // times -j: (d_im, -d_re)
  v.re[0] = a_re + c_re;
  v.im[0] = a_im + c_im;
  const Four one_re = b_re + d_im, one_im = b_im - d_re;
  const Four two_re = a_re - c_re, two_im = a_im - c_im;
  const Four three_re = b_re - d_im, three_im = b_im + d_re;
  v.re[1] = one_re * w[0] - one_im * w[1];
  v.im[1] = one_re * w[1] + one_im * w[0];
  v.re[2] = two_re * w[2] - two_im * w[3];
  v.im[2] = two_re * w[3] + two_im * w[2];
  v.re[3] = three_re * w[4] - three_im * w[5];
  v.im[3] = three_re * w[5] + three_im * w[4];
}

__attribute__((always_inline)) inline void load(Quarter& v, const double* re, const double* im,
                                                std::size_t apart) {
  for (std::size_t i = 0; i < 4; ++i) {
    v.re[i] = *four_at(re + i * apart);
    v.im[i] = *four_at(im + i * apart);
  }
}

/// The first pass: the numbers of one transform, four neighbours at a time; `turns` are six rows of them.
BODESMITH_CLONES void first_pass(const double* re, const double* im, double* to_re, double* to_im,
                                 std::size_t length, const double* turns) {
  const std::size_t quarter = length / 4;
  for (std::size_t p = 0; p < quarter; p += 4) {
    Quarter v;
    load(v, re + p, im + p, quarter);
    Four w[6];
    for (std::size_t i = 0; i < 6; ++i) w[i] = *four_at(turns + i * quarter + p);
    butterfly(v, w);
    for (int lane = 0; lane < 4; ++lane, to_re += 4, to_im += 4) {
      const Four out_re = {v.re[0][lane], v.re[1][lane], v.re[2][lane], v.re[3][lane]};
      const Four out_im = {v.im[0][lane], v.im[1][lane], v.im[2][lane], v.im[3][lane]};
      *four_at(to_re) = out_re;
      *four_at(to_im) = out_im;
    }
  }
}

/// A later one, of transforms of `length` that lie `stride` apart, four of them at a time; `turns` are six for each number.
BODESMITH_CLONES void later_pass(const double* re, const double* im, double* to_re, double* to_im,
                                 std::size_t length, std::size_t stride, const double* turns) {
  const std::size_t quarter = length / 4;
  const Four zero = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t p = 0; p < quarter; ++p, turns += 6) {
    Four w[6];
    for (std::size_t i = 0; i < 6; ++i) w[i] = zero + turns[i];
    for (std::size_t q = 0; q < stride; q += 4) {
      Quarter v;
      load(v, re + stride * p + q, im + stride * p + q, stride * quarter);
      butterfly(v, w);
      for (std::size_t i = 0; i < 4; ++i) {
        *four_at(to_re + stride * (4 * p + i) + q) = v.re[i];
        *four_at(to_im + stride * (4 * p + i) + q) = v.im[i];
      }
    }
  }
}

/// The last pass where the length is no power of four: sums and differences.
BODESMITH_CLONES void pass_of_two(const double* re, const double* im, double* to_re, double* to_im,
                                  std::size_t stride) {
  for (std::size_t q = 0; q < stride; ++q) {
    to_re[q] = re[q] + re[q + stride];
    to_im[q] = im[q] + im[q + stride];
    to_re[q + stride] = re[q] - re[q + stride];
    to_im[q + stride] = im[q] - im[q + stride];
  }
}

}  // namespace

PowerOfTwoTransform::PowerOfTwoTransform(std::size_t n)
    : half_(n / 2), re_(half_), im_(half_), other_re_(half_), other_im_(half_) {
  if (n < 32 || !std::has_single_bit(n)) throw std::logic_error("a transform of no power of two from 32 on");
  std::size_t length = half_, stride = 1;
  for (; length >= 4; length /= 4, stride *= 4) {
    const std::size_t quarter = length / 4;
    Pass pass{4, length, stride, std::vector<double>(6 * quarter)};
    // A row of each in the first pass, six in a row in the others.
    const std::size_t between = stride == 1 ? quarter : 1, next = stride == 1 ? 1 : 6;
    for (std::size_t p = 0; p < quarter; ++p) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Complex turn = turn_of((k + 1) * p, length);
        pass.turns[p * next + 2 * k * between] = turn.real();
        pass.turns[p * next + (2 * k + 1) * between] = turn.imag();
      }
    }
    passes_.push_back(std::move(pass));
  }
  if (length == 2) passes_.push_back({2, 2, stride, {}});
  for (std::size_t k = 0; k <= n / 4; ++k) turn_.push_back(turn_of(k, n));
}

void PowerOfTwoTransform::run() {
  for (const Pass& pass : passes_) {
    if (pass.stride == 1) {
      first_pass(re_.data(), im_.data(), other_re_.data(), other_im_.data(), pass.length, pass.turns.data());
    } else if (pass.radix == 4) {
      later_pass(re_.data(), im_.data(), other_re_.data(), other_im_.data(), pass.length, pass.stride,
                 pass.turns.data());
    } else {
      pass_of_two(re_.data(), im_.data(), other_re_.data(), other_im_.data(), pass.stride);
    }
    re_.swap(other_re_);
    im_.swap(other_im_);
  }
}

void PowerOfTwoTransform::forward(std::span<Complex> x) {
  for (std::size_t k = 0; k < half_; ++k) {
    re_[k] = x[k].real();
    im_[k] = x[k].imag();
  }
  run();
  for (std::size_t k = 0; k < half_; ++k) x[k] = {re_[k], im_[k]};
}

// Even samples as real, odd ones as imaginary parts: Z. With E = (Z_k + conj Z_(h-k))/2 and O = (Z_k - conj Z_(h-k))/(2j) the
// bins are X_k = E + w^k O and X_(h-k) = conj(E - w^k O).
void PowerOfTwoTransform::forward(std::span<const double> x, Complex* bins) {
  for (std::size_t k = 0; k < half_; ++k) {
    re_[k] = x[2 * k];
    im_[k] = x[2 * k + 1];
  }
  run();
  bins[0] = re_[0] + im_[0];
  bins[half_] = re_[0] - im_[0];
  for (std::size_t k = 1; k <= half_ / 2; ++k) {
    const std::size_t m = half_ - k;
    const double even_re = 0.5 * (re_[k] + re_[m]), even_im = 0.5 * (im_[k] - im_[m]);
    const double odd_re = 0.5 * (im_[k] + im_[m]), odd_im = 0.5 * (re_[m] - re_[k]);
    const double w_re = turn_[k].real(), w_im = turn_[k].imag();
    const double part_re = odd_re * w_re - odd_im * w_im, part_im = odd_re * w_im + odd_im * w_re;
    bins[k] = {even_re + part_re, even_im + part_im};
    bins[m] = {even_re - part_re, part_im - even_im};
  }
}

void PowerOfTwoTransform::inverse(const Complex* bins, std::span<double> x) {
  // Z from X by the same sums, then forward with the parts exchanged, which is backward.
  const double scale = 1.0 / static_cast<double>(half_);
  const double first = bins[0].real(), last = bins[half_].real();
  im_[0] = 0.5 * scale * (first + last);
  re_[0] = 0.5 * scale * (first - last);
  for (std::size_t k = 1; k <= half_ / 2; ++k) {
    const std::size_t m = half_ - k;
    const double even_re = 0.5 * (bins[k].real() + bins[m].real());
    const double even_im = 0.5 * (bins[k].imag() - bins[m].imag());
    const double part_re = 0.5 * (bins[k].real() - bins[m].real());
    const double part_im = 0.5 * (bins[k].imag() + bins[m].imag());
    const double w_re = turn_[k].real(), w_im = turn_[k].imag();
    const double odd_re = part_re * w_re + part_im * w_im, odd_im = part_im * w_re - part_re * w_im;
    im_[k] = scale * (even_re - odd_im);
    re_[k] = scale * (even_im + odd_re);
    im_[m] = scale * (even_re + odd_im);
    re_[m] = scale * (odd_re - even_im);
  }
  run();
  for (std::size_t k = 0; k < half_; ++k) {
    x[2 * k] = im_[k];
    x[2 * k + 1] = re_[k];
  }
}

}  // namespace bodesmith
