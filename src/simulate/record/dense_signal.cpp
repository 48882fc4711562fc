#include "simulate/record/dense_signal.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::simulate {

namespace {

/// The record as straight lines: each(first, last) for the samples at the ends of every one, until it says false.
template <class Each>
void each_line(const std::vector<double>& u, const Each& each) {
  const std::size_t n = u.size();
  double scale = 0.0;
  for (const double v : u) scale = std::max(scale, std::abs(v));
  // Samples belong to one line while a straight line from its first sample passes all of them within
  // rounding, that of whoever made the record included: the slopes that do are an interval that only gets
  // narrower.
  const double close = 2e-13 * scale;
  std::size_t first = 0;
  while (first + 1 < n) {
    std::size_t last = first + 1;
    double min_slope = u[last] - u[first] - close;
    double max_slope = u[last] - u[first] + close;
    while (last + 1 < n) {
      const auto steps = static_cast<double>(last + 1 - first);
      const double rise = u[last + 1] - u[first];
      if (rise < min_slope * steps || rise > max_slope * steps) break;
      const double part = 1.0 / steps;
      min_slope = std::max(min_slope, (rise - close) * part);
      max_slope = std::min(max_slope, (rise + close) * part);
      ++last;
    }
    if (!each(first, last)) return;
    first = last;
  }
}

}  // namespace

std::size_t DenseSignal::count_lines(const TimeRecord& record, std::size_t most) {
  std::size_t count = 0;
  each_line(record.u, [&](std::size_t, std::size_t) { return ++count <= most; });
  return count;
}

DenseSignal DenseSignal::from_record(const TimeRecord& record) {
  DenseSignal out;
  const auto& u = record.u;
  out.before = 0.0;
  each_line(u, [&](std::size_t first, std::size_t last) {
    Piece p;
    p.begin = record.time_s(first);
    p.end = record.time_s(last);
    p.nodes[0] = u[first];
    p.nodes[1] = u[last];
    out.append(p);
    if (last + 1 < u.size()) out.corner(p.end);
    return true;
  });
  return out;
}

const DenseSignal::Piece& DenseSignal::Reader::find(double t, bool from_left) {
  const auto& pieces = signal_->pieces_;
  at_ = std::min(at_, pieces.size() - 1);
  // A few steps either way, else a bisection.
  for (int tries = 0; tries < 4; ++tries) {
    const Piece& p = pieces[at_];
    if (t > p.end || (t == p.end && !from_left)) {
      if (at_ + 1 == pieces.size()) return p;
      ++at_;
    } else if (t < p.begin || (t == p.begin && from_left)) {
      if (at_ == 0) return p;
      --at_;
    } else {
      return p;
    }
  }
  const auto later = from_left ? std::lower_bound(pieces.begin(), pieces.end(), t,
                                                  [](const Piece& p, double v) { return p.end < v; })
                               : std::partition_point(pieces.begin(), pieces.end(),
                                                      [&](const Piece& p) { return p.end <= t; });
  at_ = std::min(static_cast<std::size_t>(later - pieces.begin()), pieces.size() - 1);
  return pieces[at_];
}

double DenseSignal::Reader::value(double t, bool from_left) {
  if (t < signal_->begin() || (from_left && t == signal_->begin())) return signal_->before;
  const Piece& p = find(t, from_left);
  const double length = p.end - p.begin;
  return hold_nodes(p.degree).value(p.nodes, std::clamp((t - p.begin) / length, 0.0, 1.0));
}

double DenseSignal::Reader::slope(double t, bool from_left) {
  if (t < signal_->begin()) return 0.0;
  const Piece& p = find(t, from_left);
  const double length = p.end - p.begin;
  return hold_nodes(p.degree).slope(p.nodes, std::clamp((t - p.begin) / length, 0.0, 1.0)) / length;
}

}  // namespace bodesmith::simulate
