#include "lti/steep_flanks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith {
namespace {

double turned_back(double rad) {
  return std::remainder(rad, 2.0 * std::numbers::pi);
}

}  // namespace

FlankedCurve::FlankedCurve(const std::vector<Hertz>& grid, const std::vector<Complex>& wanted) : h_(wanted) {
  double largest = 0.0;
  for (const Complex& h : wanted) largest = std::max(largest, std::abs(h));
  const double least = kJudgedFloor * largest;
  floor_ = std::log(least);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double size = std::abs(wanted[i]);
    judged_.push_back(size >= least);
    log_f_.push_back(std::log(grid[i].value));
    log_h_.emplace_back(std::log(std::max(size, least)), std::arg(wanted[i]));
  }
  // How far each point is from the nearest stretch where moving sideways may pay.
  reach_.assign(grid.size(), INFINITY);
  turn_.assign(grid.size(), 0.0);
  std::vector<double> left(grid.size(), INFINITY);
  std::vector<double> right(grid.size(), INFINITY);
  const auto pays = [&](std::size_t k) {  // between k - 1 and k
    const double way = kFlankRate * (log_f_[k] - log_f_[k - 1]);
    const double level = std::abs(log_h_[k].real() - log_h_[k - 1].real());
    turn_[k] = turned_back(log_h_[k].imag() - log_h_[k - 1].imag());
    has_flanks_ = has_flanks_ || level > way;
    return level > way || std::abs(turn_[k]) > way;
  };
  std::vector<bool> steep(grid.size(), false);
  for (std::size_t k = 1; k < grid.size(); ++k) {
    steep[k] = pays(k);
    left[k] = steep[k] ? 0.0 : left[k - 1] + kFlankRate * (log_f_[k] - log_f_[k - 1]);
  }
  for (std::size_t k = grid.size(); k-- > 1;)
    right[k - 1] = steep[k] ? 0.0 : right[k] + kFlankRate * (log_f_[k] - log_f_[k - 1]);
  for (std::size_t k = 0; k < grid.size(); ++k) reach_[k] = std::min(left[k], right[k]);
}

Complex FlankedCurve::difference(std::size_t k, Complex log_got) const {
  const Complex d = log_got - log_h_[k];
  return {d.real(), turned_back(d.imag())};
}

void FlankedCurve::visit(std::size_t i, int step, Complex log_got, const Error& enough, Error& out) const {
  Complex before = difference(i, log_got);
  double way_before = 0.0;
  const std::size_t end = step > 0 ? log_f_.size() - 1 : 0;
  const auto may_fall = [&](double size, double least) { return size > least && size > way_before; };
  for (std::size_t k = i; k != end && (may_fall(out.neper, enough.neper) || may_fall(out.rad, enough.rad) ||
                                       may_fall(out.relative, enough.relative));) {
    const std::size_t next = step > 0 ? k + 1 : k - 1;
    const double way = kFlankRate * std::abs(log_f_[next] - log_f_[i]);
    const double turn = step > 0 ? turn_[next] : -turn_[k];
    const Complex after{log_got.real() - log_h_[next].real(), before.imag() - turn};
    const auto at = [&](double t) { return way_before + t * (way - way_before); };
    const auto crossing = [&](double from, double to, double& least) {
      least = std::min(least, from * to < 0.0 ? at(from / (from - to)) : way + std::abs(to));
    };
    crossing(before.real(), after.real(), out.neper);
    crossing(before.imag(), after.imag(), out.rad);
    const Complex along = before - after;
    const double across = before.real() * along.real() + before.imag() * along.imag();
    const double t = across > 0.0 ? std::min(across / std::norm(along), 1.0) : 0.0;
    out.relative = std::min(out.relative, std::min(at(t) + std::sqrt(std::norm(before - t * along)),
                                                   way + std::sqrt(std::norm(after))));
    before = after;
    way_before = way;
    k = next;
  }
}

FlankedCurve::Error FlankedCurve::error(std::size_t i, Complex got, const Error& enough) const {
  const Complex log_got(std::max(std::log(std::abs(got)), floor_), std::arg(got));
  const Complex here = difference(i, log_got);
  Error out{std::abs(here.real()), std::abs(here.imag()), std::abs(got / h_[i] - 1.0)};
  if (std::max({out.neper, out.rad, out.relative}) <= reach_[i]) return out;
  visit(i, 1, log_got, enough, out);
  visit(i, -1, log_got, enough, out);
  return out;
}

bool has_flanks(const std::function<Complex(Hertz)>& response, Band band) {
  constexpr int kPoints = 121;
  const std::vector<Hertz> grid = judging_grid(response, band, kPoints);
  std::vector<Complex> values;
  for (const Hertz f : grid) values.push_back(response(f));
  return FlankedCurve(grid, values).has_flanks();
}

}  // namespace bodesmith
