#include "lti/bulk_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "numeric/four.hpp"
#include "numeric/log_and_angle.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith {
namespace {

using Quadratic = BulkResponse::Quadratic;

constexpr std::size_t kLanes = 64;       // side by side: what is known of them stays in the first cache
constexpr std::size_t kPerDivision = 4;  // quadratics: their product stays far from overflow

/// (s - a)(s - b) or (s - a), divided by `scale`.
Quadratic quadratic(const std::vector<Complex>& roots, double scale) {
  Quadratic q;
  if (roots.empty()) {
    q = {1.0, 0.0, 0.0};
  } else if (roots.size() == 1) {
    q = {-roots[0].real(), 1.0, 0.0};
  } else {
    q = {(roots[0] * roots[1]).real(), -(roots[0] + roots[1]).real(), 1.0};
  }
  q.c0 /= scale;
  q.c1 /= scale;
  q.c2 /= scale;
  return q;
}

/// Size of the product of roots, each at least `least`.
double scale_of(const std::vector<Complex>& roots, double least) {
  double scale = 1.0;
  for (const Complex& r : roots) scale *= std::max(std::abs(r), least);
  return scale;
}

BODESMITH_CLONES void response_lanes(const double* w, Complex* out, std::size_t lanes, double gain,
                                     const Quadratic* n, const Quadratic* d, std::size_t count) {
  double v[kLanes];
  double w2[kLanes];
  double re[kLanes];
  double im[kLanes];
  for (std::size_t l = 0; l < lanes; ++l) {
    v[l] = w[l];
    w2[l] = v[l] * v[l];
    re[l] = gain;
    im[l] = 0.0;
  }
  for (std::size_t i = 0; i < count;) {
    double br[kLanes];
    double bi[kLanes];
    for (std::size_t l = 0; l < lanes; ++l) {
      br[l] = 1.0;
      bi[l] = 0.0;
    }
    const std::size_t end = std::min(count, i + kPerDivision);
    for (; i < end; ++i) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const double nr = n[i].c0 - n[i].c2 * w2[l];
        const double ni = n[i].c1 * v[l];
        const double dr = d[i].c0 - d[i].c2 * w2[l];
        const double di = d[i].c1 * v[l];
        const double a = re[l] * nr - im[l] * ni;
        im[l] = re[l] * ni + im[l] * nr;
        re[l] = a;
        const double b = br[l] * dr - bi[l] * di;
        bi[l] = br[l] * di + bi[l] * dr;
        br[l] = b;
      }
    }
    for (std::size_t l = 0; l < lanes; ++l) {
      const double scale = 1.0 / (br[l] * br[l] + bi[l] * bi[l]);
      const double a = (re[l] * br[l] + im[l] * bi[l]) * scale;
      im[l] = (im[l] * br[l] - re[l] * bi[l]) * scale;
      re[l] = a;
    }
  }
  for (std::size_t l = 0; l < lanes; ++l) out[l] = {re[l], im[l]};
}

}  // namespace

BulkResponse::BulkResponse(const Sections& sections) : gain_(sections.gain), delay_s_(sections.delay_s) {
  // First-order sections go two by two.
  std::vector<Complex> waiting_zeros;
  std::vector<Complex> waiting_poles;
  bool waiting = false;
  const auto add = [&](const std::vector<Complex>& zeros, const std::vector<Complex>& poles) {
    const double least = 1e-3 * std::max(scale_of(poles, 0.0), 1e-30);
    const double top = scale_of(zeros, poles.empty() ? 1.0 : std::min(1.0, least) + 1e-300);
    const double bottom = scale_of(poles, 1e-300);
    numerators_.push_back(quadratic(zeros, top));
    denominators_.push_back(quadratic(poles, bottom));
    gain_ *= top / bottom;
  };
  for (const Section& s : sections.sections) {
    gain_ *= s.gain;
    const bool single = s.poles.size() == 1;
    if (!single) {
      add(s.zeros, s.poles);
    } else if (!waiting) {
      waiting_zeros = s.zeros;
      waiting_poles = s.poles;
      waiting = true;
    } else {
      waiting_zeros.insert(waiting_zeros.end(), s.zeros.begin(), s.zeros.end());
      waiting_poles.insert(waiting_poles.end(), s.poles.begin(), s.poles.end());
      add(waiting_zeros, waiting_poles);
      waiting = false;
    }
  }
  if (waiting) add(waiting_zeros, waiting_poles);
}

void BulkResponse::responses(std::span<const RadPerSecond> w, std::span<Complex> out) const {
  if (w.size() != out.size()) throw std::logic_error("bulk response: lengths differ");
  double lanes[kLanes];
  for (std::size_t i = 0; i < w.size(); i += kLanes) {
    const std::size_t count = std::min(kLanes, w.size() - i);
    for (std::size_t l = 0; l < count; ++l) lanes[l] = w[i + l].value;
    response_lanes(lanes, out.data() + i, count, gain_, numerators_.data(), denominators_.data(),
                   numerators_.size());
  }
  if (delay_s_ == 0.0) return;
  for (std::size_t i = 0; i < w.size(); ++i) out[i] *= std::polar(1.0, -w[i].value * delay_s_);
}

void for_pieces(const Sections& sections, const std::vector<Hertz>& grid, const PieceOfResponse& use) {
  const std::size_t n = grid.size();
  const BulkResponse bulk(sections);
  // On the stack of whoever works on it, in the first cache: memory that is asked for is new to every thread, page by page.
  constexpr std::size_t kPiece = 1024;
  const int threads = n >= 32 * kPiece ? thread_count(0) : 1;
  parallel_for((n + kPiece - 1) / kPiece, threads, [&](std::size_t piece) {
    const std::size_t begin = piece * kPiece;
    const std::size_t count = std::min(n - begin, kPiece);
    std::array<RadPerSecond, kPiece> lanes;
    std::array<Complex, kPiece> values;
    const std::span<RadPerSecond> w = std::span(lanes).first(count);
    const std::span<Complex> h = std::span(values).first(count);
    for (std::size_t i = 0; i < count; ++i) w[i] = grid[begin + i].rad_s();
    bulk.responses(w, h);
    for (std::size_t i = 0; i < count; ++i) {
      const double size = std::norm(h[i]);
      // Written so that a NaN counts as outside.
      if (!(size > 1e-200 && size < 1e200)) h[i] = sections.response(w[i]);
    }
    use(begin, h);
  });
}

std::vector<Complex> responses(const Sections& sections, const std::vector<Hertz>& grid) {
  std::vector<Complex> out(grid.size());
  for_pieces(sections, grid, [&out](std::size_t begin, std::span<const Complex> h) {
    std::copy(h.begin(), h.end(), out.begin() + static_cast<std::ptrdiff_t>(begin));
  });
  return out;
}

namespace {

constexpr double kDecibelPerLog = 10.0 / std::numbers::ln10;  // of a square
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

BODESMITH_CLONES void levels_and_angles(const Complex* response, double* level_db, double* angle_deg,
                                        std::size_t count) {
  const auto* parts =
      reinterpret_cast<const double*>(response);  // [complex.numbers.general]: re, im, re, ...
  for (std::size_t i = 0; i < count; ++i) {
    const double re = parts[2 * i];
    const double im = parts[2 * i + 1];
    level_db[i] = kDecibelPerLog * log_of(re * re + im * im);
    angle_deg[i] = kDegreesPerRadian * angle_of(re, im);
  }
}

/// One piece, the turns not yet followed.
void put(std::span<const Complex> response, std::size_t begin, LevelAndPhase& out) {
  levels_and_angles(response.data(), &out.magnitude_db[begin], &out.phase_deg[begin], response.size());
  for (std::size_t i = 0; i < response.size(); ++i) {
    // The square of a gain may leave the range of a double where the gain does not.
    constexpr double kSafeDb = 2900.0;
    double& level = out.magnitude_db[begin + i];
    if (std::abs(level) < kSafeDb) continue;
    level = to_decibel(std::abs(response[i]));
    out.phase_deg[begin + i] = to_degrees(std::arg(response[i]));
  }
}

LevelAndPhase of_length(std::size_t n) {
  LevelAndPhase out;
  out.magnitude_db.resize(n);
  out.phase_deg.resize(n);
  return out;
}

/// How far the roots turn the phase from one frequency to another; a zero on the axis as one just left of it.
double turn_deg(const Sections& sections, RadPerSecond from, RadPerSecond to) {
  double out = 0.0;
  const auto turned = [&](const Complex& root) {
    if (root.real() == 0.0)
      return from.value < root.imag() && root.imag() <= to.value ? std::numbers::pi : 0.0;
    return std::atan((root.imag() - to.value) / root.real()) -
           std::atan((root.imag() - from.value) / root.real());
  };
  for (const Section& section : sections.sections) {
    for (const Complex& zero : section.zeros) out += turned(zero);
    for (const Complex& pole : section.poles) out -= turned(pole);
  }
  return to_degrees(out);
}

/// What all roots together turn the phase by over a neper of frequency, rad, at the most: one at -sigma +- j w0 by
/// w sigma/|jw - p|^2, which is largest at w = |p|: (|p| + |w0|)/(2 sigma).
double steepest_turn(const Sections& sections) {
  double sum = 0.0;
  const auto add = [&](Complex root) {
    if (root != Complex(0.0)) sum += (std::abs(root) + std::abs(root.imag())) / (2.0 * std::abs(root.real()));
  };
  for (const Section& section : sections.sections) {
    std::ranges::for_each(section.poles, add);
    std::ranges::for_each(section.zeros, add);
  }
  return sum;
}

/// Takes out the jumps between one frequency and the next, i - 1 and i, of more than half a turn besides `turn(i)`, degrees. Each is told
/// from the angles as they come: a step behind the turns so far would have to wait for the one before it.
template <typename Turn>
void follow_turns(std::vector<double>& phase_deg, const Turn& turn) {
  double turns = 0.0, last = phase_deg.empty() ? 0.0 : phase_deg[0];
  for (std::size_t i = 1; i < phase_deg.size(); ++i) {
    const double step = phase_deg[i] - last - turn(i);
    if (std::abs(step) > 180.0) turns -= 360.0 * std::round(step / 360.0);
    last = phase_deg[i];
    phase_deg[i] += turns;
  }
}

}  // namespace

double group_delay_s(const Sections& sections, RadPerSecond w) {
  double delay = sections.delay_s;
  const Complex s(0.0, w.value);
  for (const Section& section : sections.sections) {
    for (const Complex& p : section.poles) delay += (1.0 / (s - p)).real();
    // A zero on the axis turns the phase at one frequency and nowhere else.
    for (const Complex& z : section.zeros) {
      if (z.real() != 0.0) delay -= (1.0 / (s - z)).real();
    }
  }
  return delay;
}

double group_delay_s(const std::function<Complex(Hertz)>& response, Hertz f) {
  constexpr double kStep = 1e-4;
  const Complex above = response(Hertz{f.value * (1.0 + kStep)});
  const Complex below = response(Hertz{f.value * (1.0 - kStep)});
  return -std::arg(above / below) / (2.0 * kStep * f.rad_s().value);
}

LevelAndPhase level_and_phase(std::span<const Complex> response) {
  LevelAndPhase out = of_length(response.size());
  if (!response.empty()) put(response, 0, out);
  follow_turns(out.phase_deg, [](std::size_t) { return 0.0; });
  return out;
}

LevelAndPhase level_and_phase(const Sections& sections, const std::vector<Hertz>& grid) {
  LevelAndPhase out = of_length(grid.size());
  for_pieces(sections, grid, [&out](std::size_t begin, std::span<const Complex> h) { put(h, begin, out); });
  // On a coarse grid the phase may turn by any angle between two frequencies; where it cannot by half a turn, the angles tell it.
  const double coarse = 1.0 + 0.95 * std::numbers::pi / steepest_turn(sections);
  follow_turns(out.phase_deg, [&](std::size_t i) {
    const bool near = grid[i].value < coarse * grid[i - 1].value && !(grid[i] < grid[i - 1]);
    return near ? 0.0 : turn_deg(sections, grid[i - 1].rad_s(), grid[i].rad_s());
  });
  return out;
}

}  // namespace bodesmith
