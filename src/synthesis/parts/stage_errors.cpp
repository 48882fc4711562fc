#include "synthesis/parts/stage_errors.hpp"

#include <algorithm>
#include <cmath>

#include "lti/steep_flanks.hpp"
#include "numeric/four.hpp"
#include "numeric/log_and_angle.hpp"

namespace bodesmith::synthesis {
namespace {

/// |d ln H / d ln f|, each root's share by itself.
double slope(const Sections& wanted, Hertz f) {
  const Complex s(0.0, f.rad_s().value);
  Complex out = 0.0;
  for (const Section& section : wanted.sections) {
    for (const Complex& zero : section.zeros) out += s / (s - zero);
    for (const Complex& pole : section.poles) out -= s / (s - pole);
  }
  return std::abs(out);
}

/// weight ln(H/wanted) as re, im, re, …; `wanted` is laid out so too.
BODESMITH_CLONES void weighted_logarithms(const Biquad& h, const double* w, const double* weight,
                                          const double* wanted, double* out, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const double top_re = h.b0 - w[k] * w[k] * h.b2;
    const double top_im = w[k] * h.b1;
    const double low_re = h.a0 - w[k] * w[k] * h.a2;
    const double low_im = w[k] * h.a1;
    const double aim_re = wanted[2 * k] * low_re - wanted[2 * k + 1] * low_im;
    const double aim_im = wanted[2 * k] * low_im + wanted[2 * k + 1] * low_re;
    const double square = (top_re * top_re + top_im * top_im) / (aim_re * aim_re + aim_im * aim_im);
    out[2 * k] = weight[k] * (0.5 * log_of(square));
    out[2 * k + 1] =
        weight[k] * angle_of(top_re * aim_re + top_im * aim_im, top_im * aim_re - top_re * aim_im);
  }
}

}  // namespace

SearchGrid::SearchGrid(const Sections& wanted, Band band, int count) {
  /// Between points of a flank; parts are told apart by less than it takes to state an error.
  constexpr double kMostChange = 0.5;
  const auto response = [&](Hertz f) { return wanted.response(f.rad_s()); };
  const std::vector<Hertz> grid =
      has_flanks(response, band) ? judging_grid(response, band, count, kMostChange) : log_grid(band, count);
  double largest = 0.0;
  for (const Hertz f : grid) largest = std::max(largest, std::abs(response(f)));
  for (const Hertz f : grid) {
    if (!(std::abs(response(f)) >= kJudgedFloor * largest)) continue;
    at.push_back(f);
    weight.push_back(std::min(1.0, kFlankRate / slope(wanted, f)));
  }
}

StageErrors::StageErrors(const StageForm& form, const SearchGrid& grid) : form_(form), weight_(grid.weight) {
  for (const Hertz f : grid.at) {
    w_.push_back(f.rad_s().value);
    wanted_.push_back(form.wanted().response(f.rad_s()));
  }
}

std::vector<Complex> StageErrors::logarithms(const std::vector<double>& values) const {
  const Biquad h = form_.aim(values);
  std::vector<Complex> out(w_.size());
  weighted_logarithms(h, w_.data(), weight_.data(), reinterpret_cast<const double*>(wanted_.data()),
                      reinterpret_cast<double*>(out.data()), w_.size());
  for (std::size_t k = 0; k < w_.size(); ++k) {
    constexpr double kSafe = 300.0;  // beyond it a square may have left the range of a double
    if (!(std::abs(out[k].real()) < kSafe * weight_[k]) || std::isnan(out[k].imag()))
      out[k] = weight_[k] * std::log(h.response(RadPerSecond{w_[k]}) / wanted_[k]);
  }
  return out;
}

double StageErrors::worst_square(const std::vector<double>& values, double enough) const {
  const Biquad h = form_.aim(values);
  double out = 0.0;
  for (std::size_t k = 0; k < w_.size() && out <= enough; ++k) {
    const double w = w_[k];
    const Complex top(h.b0 - w * w * h.b2, w * h.b1);
    const Complex aim = wanted_[k] * Complex(h.a0 - w * w * h.a2, w * h.a1);
    out = std::max(out, weight_[k] * weight_[k] * std::norm(top - aim) / std::norm(aim));
  }
  return out;
}

}  // namespace bodesmith::synthesis
