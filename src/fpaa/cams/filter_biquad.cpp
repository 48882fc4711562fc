#include "fpaa/cams/filter_biquad.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {
namespace {

struct Near {
  double off;
  BiquadCapacitors capacitors;
};

constexpr size_t kJudged = 400;

/// Keeps the best kJudged, cheaply.
class Shortlist {
 public:
  void add(double off, const BiquadCapacitors& c) {
    if (list_.size() >= 2 * kJudged) cut();
    if (off < limit_) list_.push_back({off, c});
  }
  std::vector<Near> take() {
    cut();
    return std::move(list_);
  }

 private:
  void cut() {
    std::stable_sort(list_.begin(), list_.end(), [](const Near& a, const Near& b) { return a.off < b.off; });
    if (list_.size() > kJudged) {
      list_.resize(kJudged);
      limit_ = list_.back().off;
    }
  }
  std::vector<Near> list_;
  double limit_ = std::numeric_limits<double>::infinity();
};

void collect(const BiquadTarget& target, Hertz clock, int largest, bool high_q, Shortlist& list) {
  const double root = 2.0 * std::sin(0.5 * target.natural.value / clock.value);  // w0/fc by LDI
  const int bank = 2 * largest;
  for (int cb = 1; cb <= bank; ++cb) {
    const int middle = static_cast<int>(std::lround(root * cb));
    for (int c3 = std::max(1, middle - 2); c3 <= std::min(largest, middle + 2); ++c3) {
      const double c2_per_ca = root * root * cb / c3;
      for (int ca = 1; ca <= bank; ++ca) {
        const int c2 = static_cast<int>(std::lround(c2_per_ca * ca));
        if (c2 < 1 || c2 > largest) continue;
        const double corner_off = 0.5 * std::abs(std::log(c2 / (c2_per_ca * ca)));
        const double c4_wanted = high_q ? std::sqrt(static_cast<double>(ca) * cb * c2 / c3) / target.quality
                                        : cb * root / target.quality;
        const int c4 = static_cast<int>(std::lround(c4_wanted));
        if (c4 < 1 || c4 > largest) continue;
        BiquadCapacitors c;
        c.kind = target.kind;
        c.high_q = high_q;
        c.c2 = c2;
        c.c3 = c3;
        c.c4 = c4;
        c.ca = ca;
        c.cb = cb;
        double exact_input = 0.0;
        switch (target.kind) {
          case BiquadCapacitors::Kind::low_pass:
            exact_input = target.gain * c2;
            break;
          case BiquadCapacitors::Kind::band_pass:
            exact_input = target.gain * c4;
            break;
          case BiquadCapacitors::Kind::high_pass:
            exact_input = target.gain * cb;
            break;
        }
        c.input = static_cast<int>(std::lround(std::min(exact_input, 1e6)));
        if (c.input < 1 || c.input > largest) continue;
        list.add(corner_off + std::abs(std::log(c4 / c4_wanted)) + std::abs(std::log(c.input / exact_input)),
                 c);
      }
    }
  }
}

}  // namespace

ZTransfer BiquadCapacitors::transfer() const {
  const double a = ca, b = cb, two = c2, three = c3, four = c4, in = input;
  ZTransfer h;
  h.denominator = high_q
                      ? std::vector<double>{a * b, -2.0 * a * b + three * (two + four), a * b - three * four}
                      : std::vector<double>{a * (b + four), -a * (2.0 * b + four) + two * three, a * b};
  switch (kind) {
    case Kind::low_pass:
      h.numerator = {0.0, -in * three};
      break;
    case Kind::band_pass:
      h.numerator =
          high_q ? std::vector<double>{0.0, -in * three, in * three} : std::vector<double>{-in * a, in * a};
      break;
    case Kind::high_pass:
      h.numerator = {-in * a, 2.0 * in * a, -in * a};
      break;
  }
  return h;
}

Hertz BiquadCapacitors::corner(Hertz clock) const {
  const double root = std::sqrt(static_cast<double>(c2) * c3 / (static_cast<double>(ca) * cb));
  return {clock.value / std::numbers::pi * std::asin(std::min(1.0, 0.5 * root))};
}

double BiquadCapacitors::quality(Hertz) const {
  const double root = std::sqrt(static_cast<double>(c2) * c3 / (static_cast<double>(ca) * cb));
  if (high_q) return std::sqrt(static_cast<double>(ca) * cb * c2 / c3) / c4;
  return cb * root / c4;
}

double BiquadCapacitors::gain() const {
  switch (kind) {
    case Kind::low_pass:
      return static_cast<double>(input) / c2;
    case Kind::band_pass:
      return static_cast<double>(input) / c4;
    case Kind::high_pass:
      break;
  }
  return static_cast<double>(input) / cb;
}

std::complex<double> BiquadTarget::response(RadPerSecond w) const {
  const std::complex<double> s(0.0, w.value / natural.value);
  const std::complex<double> below = 1.0 + s / quality + s * s;
  switch (kind) {
    case BiquadCapacitors::Kind::low_pass:
      return gain / below;
    case BiquadCapacitors::Kind::band_pass:
      return gain * s / quality / below;
    case BiquadCapacitors::Kind::high_pass:
      break;
  }
  return gain * s * s / below;
}

BiquadSolution search_biquad(const BiquadTarget& target, Hertz clock, const std::vector<RadPerSecond>& grid,
                             int largest) {
  Shortlist list;
  collect(target, clock, largest, false, list);
  collect(target, clock, largest, true, list);
  BiquadSolution best;
  best.max_complex_error = std::numeric_limits<double>::infinity();
  for (const Near& near : list.take()) {
    const ZTransfer h = near.capacitors.transfer();
    if (!h.is_stable()) continue;
    double worst = 0.0;
    for (const RadPerSecond w : grid) {
      worst = std::max(worst, std::abs(-h.response(w, clock) / target.response(w) - 1.0));
      if (worst >= best.max_complex_error) break;
    }
    if (worst < best.max_complex_error) {
      best.max_complex_error = worst;
      best.capacitors = near.capacitors;
      best.made = true;
    }
  }
  return best;
}

const CamType& filter_biquad_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "FilterBiquad";
    t.options = {"Low Pass", "Band Pass", "High Pass", "Pole and Zero"};
    t.parameters = {"corner_hz", "quality", "gain"};
    t.resources = Resources{.opamps = 2, .capacitors = 8};
    t.transfer = "see filter_biquad.hpp; Pole and Zero: not publicly known, not made";
    t.transfer_ground = Ground::assumed;
    t.limits = "CA and CB to 510 units, the others to 255";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
