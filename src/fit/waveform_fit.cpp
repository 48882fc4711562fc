#include "fit/waveform_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "fit/cascade_fit.hpp"
#include "fit/curve_search.hpp"
#include "fit/start_builder.hpp"
#include "fit/triangle_series.hpp"
#include "lti/section_making.hpp"
#include "numeric/quadratic_program.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int kHarmonics = 48;  ///< in the search; the error reported has 400

/// The error of one operating frequency as a linear function of G at its harmonics: e = B G - d, |e|^2 = mean
/// square error of the waveform, from harmonics 0 ... kHarmonics. B is real-linear: rows for real and
/// imaginary parts.
class ErrorMap {
 public:
  ErrorMap(const Disturbance& disturbance, DrivenPath path) : path_(path) {
    series_ = triangle_series(disturbance, path, kHarmonics);
    if (path == DrivenPath::whole) {
      up_ = half(disturbance, true);
      down_ = half(disturbance, false);
      return;
    }
    // Only one half of the period counts: its samples, as a factor of their Gram matrix to keep rows few.
    const int samples = 4 * kHarmonics;
    MatrixXd map(samples / 2, 2 * kHarmonics + 1);
    for (int m = 0; m < samples / 2; ++m) {
      const double phase = (m + 0.5) / samples + (path == DrivenPath::descending ? 0.5 : 0.0);
      map(m, 0) = series_.coefficient[0].real();
      for (int k = 1; k <= kHarmonics; ++k) {
        const Complex turn = 2.0 * series_.coefficient[static_cast<size_t>(k)] *
                             std::polar(1.0, 2.0 * std::numbers::pi * std::fmod(k * phase, 1.0));
        map(m, 2 * k - 1) = turn.real();
        map(m, 2 * k) = -turn.imag();
      }
    }
    map /= std::sqrt(static_cast<double>(samples));
    const Eigen::HouseholderQR<MatrixXd> qr(map);
    const Index rank = std::min(map.rows(), map.cols());
    window_ = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
  }

  Index rows() const { return path_ == DrivenPath::whole ? 2 * kHarmonics + 1 : window_.rows(); }

  /// e for G(k f), k = 0 ... kHarmonics, and its derivatives; gains of the two branches at f.
  void apply(const VectorXcd& g, const MatrixXcd* g_slope, double gain_up, double gain_down, VectorXd& e,
             MatrixXd* slope) const {
    if (path_ == DrivenPath::whole) {
      e.resize(rows());
      if (slope != nullptr) slope->resize(rows(), g_slope->cols());
      for (int k = 0; k <= kHarmonics; ++k) {
        const auto at = static_cast<size_t>(k);
        const Complex u = series_.coefficient[at];
        const double size = k == 0 ? 1.0 : std::numbers::sqrt2;
        const Complex miss = size * (g(k) * u - gain_up * up_[at] - gain_down * down_[at]);
        const Index row = k == 0 ? 0 : 2 * k - 1;
        e(row) = miss.real();
        if (k > 0) e(row + 1) = miss.imag();
        if (slope == nullptr) continue;
        const Eigen::RowVectorXcd change = size * u * g_slope->row(k);
        slope->row(row) = change.real();
        if (k > 0) slope->row(row + 1) = change.imag();
      }
      return;
    }
    const double gain = path_ == DrivenPath::ascending ? gain_up : gain_down;
    VectorXd parts(2 * kHarmonics + 1);
    parts(0) = g(0).real() - gain;
    for (int k = 1; k <= kHarmonics; ++k) {
      parts(2 * k - 1) = g(k).real() - gain;
      parts(2 * k) = g(k).imag();
    }
    e = window_ * parts;
    if (slope == nullptr) return;
    MatrixXd changes(2 * kHarmonics + 1, g_slope->cols());
    changes.row(0) = g_slope->row(0).real();
    for (int k = 1; k <= kHarmonics; ++k) {
      changes.row(2 * k - 1) = g_slope->row(k).real();
      changes.row(2 * k) = g_slope->row(k).imag();
    }
    *slope = window_ * changes;
  }

  /// Real-linear map of (Re G_0, Re G_1, Im G_1, ...) and the wanted part, for the lower bound.
  MatrixXd matrix() const {
    if (path_ != DrivenPath::whole) return window_;
    MatrixXd out = MatrixXd::Zero(rows(), rows());
    out(0, 0) = series_.coefficient[0].real();
    for (int k = 1; k <= kHarmonics; ++k) {
      const Complex u = std::numbers::sqrt2 * series_.coefficient[static_cast<size_t>(k)];
      out(2 * k - 1, 2 * k - 1) = u.real();
      out(2 * k - 1, 2 * k) = -u.imag();
      out(2 * k, 2 * k - 1) = u.imag();
      out(2 * k, 2 * k) = u.real();
    }
    return out;
  }

 private:
  static std::vector<Complex> half(const Disturbance& disturbance, bool rising) {
    Disturbance one = disturbance;
    (rising ? one.descending : one.ascending) = {0.0, 0.0, 0.0};
    return triangle_series(one, DrivenPath::whole, kHarmonics).coefficient;
  }

  DrivenPath path_;
  TriangleSeries series_;
  std::vector<Complex> up_;
  std::vector<Complex> down_;
  MatrixXd window_;
};

class Problem {
 public:
  Problem(const Disturbance& disturbance, const std::vector<Hertz>& operating, DrivenPath path)
      : map_(disturbance, path), operating_(operating) {
    for (const Hertz f : operating) {
      up_.push_back(disturbance.rate_gain(Disturbance::Branch::ascending, f));
      down_.push_back(disturbance.rate_gain(Disturbance::Branch::descending, f));
    }
  }

  size_t count() const { return operating_.size(); }

  /// Error vector of one frequency.
  void error(const RootModel& model, const VectorXd& theta, size_t i, VectorXd& e, MatrixXd* slope) const {
    VectorXcd g(kHarmonics + 1);
    MatrixXcd g_slope;
    if (slope != nullptr) g_slope.resize(kHarmonics + 1, theta.size());
    Eigen::RowVectorXcd row(theta.size());
    const RootResponse response(model, theta);
    for (int k = 0; k <= kHarmonics; ++k) {
      const double at = operating_[i].value * (k == 0 ? 1e-9 : static_cast<double>(k));
      const Complex log_g = response.at(Hertz{at}.rad_s(), slope != nullptr ? &row : nullptr, true);
      g(k) = std::exp(log_g);
      if (k == 0) g(k) = g(k).real();
      if (slope != nullptr) g_slope.row(k) = g(k) * row;
    }
    map_.apply(g, slope != nullptr ? &g_slope : nullptr, up_[i], down_[i], e, slope);
  }

  /// All of them, weighted: |miss|^2 = sum weight_i * mean square error_i.
  void misses(const RootModel& model, const std::vector<double>& weight, const VectorXd& theta,
              VectorXd& miss, MatrixXd* slope) const {
    const Index rows = map_.rows();
    miss.resize(rows * static_cast<Index>(count()));
    if (slope != nullptr) slope->resize(miss.size(), theta.size());
    VectorXd e;
    MatrixXd part;
    for (size_t i = 0; i < count(); ++i) {
      error(model, theta, i, e, slope != nullptr ? &part : nullptr);
      const double root = std::sqrt(weight[i]);
      miss.segment(static_cast<Index>(i) * rows, rows) = root * e;
      if (slope != nullptr) slope->middleRows(static_cast<Index>(i) * rows, rows) = root * part;
    }
  }

  /// Largest mean square error made smallest: sequential quadratic programming with Gauss-Newton curvature.
  SearchResult make_worst_smallest(const RootModel& model, const RootLimits& limits, VectorXd theta,
                                   int iterations) const {
    const Index n = theta.size();
    std::vector<VectorXd> e(count());
    std::vector<MatrixXd> slope(count());
    const auto square = [&](const VectorXd& at) {
      double worst = 0.0;
      VectorXd miss;
      for (size_t i = 0; i < count(); ++i) {
        error(model, at, i, miss, nullptr);
        worst = std::max(worst, miss.squaredNorm());
      }
      return worst;
    };
    double worst = square(theta);
    VectorXd share = VectorXd::Constant(static_cast<Index>(count()), 1.0 / static_cast<double>(count()));
    double radius = 0.3;
    for (int iteration = 0; iteration < iterations && radius > 1e-9; ++iteration) {
      for (size_t i = 0; i < count(); ++i) error(model, theta, i, e[i], &slope[i]);
      std::vector<Eigen::RowVectorXd> limit_rows;
      std::vector<double> limit_most;
      add_limits(model, limits, theta, limit_rows, limit_most);
      const auto own = static_cast<Index>(count());
      const Index rows = own + static_cast<Index>(limit_rows.size()) + 2 * n;
      QuadraticProgram p;
      p.q = MatrixXd::Zero(n + 1, n + 1);
      p.c = VectorXd::Zero(n + 1);
      p.c(n) = 1.0;
      p.a = MatrixXd::Zero(rows, n + 1);
      p.b = VectorXd::Zero(rows);
      Index at = 0;
      for (size_t i = 0; i < count(); ++i, ++at) {
        p.a.block(at, 0, 1, n) = (2.0 * radius / worst) * (slope[i].transpose() * e[i]).transpose();
        p.a(at, n) = -1.0;
        p.b(at) = -e[i].squaredNorm() / worst;
        p.q.topLeftCorner(n, n) +=
            (2.0 * share(static_cast<Index>(i)) * radius * radius / worst) * slope[i].transpose() * slope[i];
      }
      for (size_t i = 0; i < limit_rows.size(); ++i, ++at) {
        p.a.block(at, 0, 1, n) = limit_rows[i];
        p.b(at) = std::max(0.0, limit_most[i]) / radius;
      }
      for (Index i = 0; i < n; ++i) {
        p.a(at, i) = 1.0;
        p.b(at++) = 1.0;
        p.a(at, i) = -1.0;
        p.b(at++) = 1.0;
      }
      VectorXd start = VectorXd::Zero(n + 1);
      start(n) = 1.1;
      const QuadraticProgramResult solution = solve_quadratic_program(p, start);
      VectorXd trial = theta + radius * solution.x.head(n);
      clamp(model, limits, trial);
      const double trial_worst = square(trial);
      const VectorXd multiplier = solution.multiplier.head(own);
      if (multiplier.sum() > 0.0 && multiplier.allFinite())
        share = 0.5 * share + 0.5 * multiplier / multiplier.sum();
      if (trial_worst < worst) {
        const double won = worst - trial_worst;
        theta = trial;
        worst = trial_worst;
        radius = std::min(1.0, radius * 1.5);
        if (won < 1e-8 * worst) break;
      } else {
        radius *= 0.35;
      }
    }
    return {theta, std::sqrt(worst)};
  }

  const ErrorMap& map() const { return map_; }
  const std::vector<double>& up() const { return up_; }
  const std::vector<double>& down() const { return down_; }

 private:
  ErrorMap map_;
  std::vector<Hertz> operating_;
  std::vector<double> up_;
  std::vector<double> down_;
};

std::vector<Hertz> checked_operating(const Disturbance& disturbance, std::vector<Hertz> operating) {
  if (operating.empty()) operating = operating_frequencies(disturbance);
  if (operating.empty()) {
    throw InputError(
        "the disturbance has no rate gains, expected a 'rate' table (a static disturbance needs no filter)");
  }
  std::sort(operating.begin(), operating.end());
  return operating;
}

/// Mean square errors of the best G at each harmonic for given weights, and their weighted sum.
std::vector<double> best_possible(const Problem& problem, const std::vector<Hertz>& operating,
                                  const std::vector<double>& weight) {
  // Unknowns: Re and Im of G at each distinct frequency (Re only at 0).
  std::map<long long, Index> place;
  const auto key = [](double f) { return std::llround(f * 1e7); };
  Index unknowns = 1;
  for (const Hertz f : operating) {
    for (int k = 1; k <= kHarmonics; ++k) {
      if (place.emplace(key(f.value * k), unknowns).second) unknowns += 2;
    }
  }
  const MatrixXd map = problem.map().matrix();
  const Index rows = map.rows();
  MatrixXd normal = MatrixXd::Zero(unknowns, unknowns);
  VectorXd right = VectorXd::Zero(unknowns);
  const MatrixXd gram = map.transpose() * map;
  const auto column = [&](size_t i, Index c) {
    if (c == 0) return Index{0};
    const Index k = (c + 1) / 2;
    return place.at(key(operating[i].value * static_cast<double>(k))) + (c + 1) % 2;
  };
  std::vector<VectorXd> wanted;
  for (size_t i = 0; i < operating.size(); ++i) {
    // -e at G = 0.
    VectorXd e;
    problem.map().apply(VectorXcd::Zero(kHarmonics + 1), nullptr, problem.up()[i], problem.down()[i], e,
                        nullptr);
    wanted.push_back(-e);
    const VectorXd pull = map.transpose() * wanted.back();
    for (Index a = 0; a < map.cols(); ++a) {
      right(column(i, a)) += weight[i] * pull(a);
      for (Index b = 0; b < map.cols(); ++b) normal(column(i, a), column(i, b)) += weight[i] * gram(a, b);
    }
  }
  normal.diagonal().array() += 1e-13 * normal.diagonal().maxCoeff();
  const VectorXd g = normal.ldlt().solve(right);
  std::vector<double> out;
  VectorXd own(rows);
  for (size_t i = 0; i < operating.size(); ++i) {
    VectorXd part(map.cols());
    for (Index a = 0; a < map.cols(); ++a) part(a) = g(column(i, a));
    out.push_back((map * part - wanted[i]).squaredNorm());
  }
  return out;
}

}  // namespace

double waveform_lower_bound(const Disturbance& disturbance, const std::vector<Hertz>& given, DrivenPath path,
                            bool worst) {
  const std::vector<Hertz> operating = checked_operating(disturbance, given);
  const Problem problem(disturbance, operating, path);
  const double count = static_cast<double>(operating.size());
  std::vector<double> weight(operating.size(), 1.0 / count);
  double bound = 0.0;
  for (int iteration = 0; iteration < (worst ? 60 : 1); ++iteration) {
    const std::vector<double> square = best_possible(problem, operating, weight);
    double sum = 0.0;
    double total = 0.0;
    for (size_t i = 0; i < square.size(); ++i) sum += weight[i] * square[i];
    bound = std::max(bound, sum);
    for (size_t i = 0; i < square.size(); ++i) {
      weight[i] *= std::sqrt(square[i] + 1e-12 * sum) + 1e-300;
      total += weight[i];
    }
    for (double& w : weight) w /= total;
  }
  return 100.0 * std::sqrt(bound);
}

DrivenPath path_to_compensate(const Disturbance& disturbance) {
  using Branch = Disturbance::Branch;
  const bool up = !disturbance.is_static(Branch::ascending);
  const bool down = !disturbance.is_static(Branch::descending);
  if (!up && !down)
    throw InputError("the rate gains of both branches are 1, expected a branch that needs a compensator");
  if (up && !down) return DrivenPath::ascending;
  if (down && !up) return DrivenPath::descending;
  if (disturbance.rate.ascending == disturbance.rate.descending) return DrivenPath::whole;
  throw InputError(
      "the two branches have different rate gains, expected a choice of branch (each needs its own filter)");
}

WaveformFit fit_waveform(const Disturbance& disturbance, const WaveformFitOptions& options) {
  if (options.order < 1 || options.order > 6)
    throw InputError(fmt::format("the order is {}, expected 1 to 6", options.order));
  const std::vector<Hertz> operating = checked_operating(disturbance, options.operating);
  using Branch = Disturbance::Branch;
  if ((options.path == DrivenPath::ascending && disturbance.is_static(Branch::ascending)) ||
      (options.path == DrivenPath::descending && disturbance.is_static(Branch::descending)) ||
      (disturbance.is_static(Branch::ascending) && disturbance.is_static(Branch::descending))) {
    throw InputError(
        "the rate gains of this path are 1 at every frequency, expected a branch that needs a compensator");
  }
  const Problem problem(disturbance, operating, options.path);
  const double lowest = operating.front().rad_s().value;
  const double highest = operating.back().rad_s().value;
  RootLimits limits;
  limits.low = {lowest / 100.0};
  limits.high = {highest * 1000.0};
  limits.least_damping = options.least_damping;
  const RadPerSecond reference{std::sqrt(lowest * highest)};
  const std::vector<double> even(operating.size(), 1.0 / static_cast<double>(operating.size()));

  WaveformFit out;
  SearchResult best;
  best.value = INFINITY;
  RootModel model;
  for (const bool real : options.real ? std::vector<bool>{true} : std::vector<bool>{true, false}) {
    StartBuilder::Settings settings;
    settings.low = {lowest / 2.0};
    settings.high = {highest * 20.0};
    settings.real = real;
    settings.random = options.starts;
    settings.seed = options.seed;
    settings.kept = 5;
    const auto improve = [&](const RootModel& shape, const VectorXd& start, int iterations) {
      const Misses misses = [&](const VectorXd& at, VectorXd& miss, MatrixXd* slope) {
        problem.misses(shape, even, at, miss, slope);
      };
      return search_least_squares(shape, misses, limits, start, iterations);
    };
    StartBuilder builder(
        settings, [&](const RootModel& shape, const VectorXd& start) { return improve(shape, start, 25); });
    const RootModel shape = StartBuilder::make_model(options.order, options.order, real, reference);
    for (const SearchResult& start : builder.build(options.order, options.order, reference)) {
      SearchResult result = options.worst ? problem.make_worst_smallest(shape, limits, start.theta, 150)
                                          : improve(shape, start.theta, 300);
      if (result.value < best.value) {
        best = result;
        model = shape;
      }
    }
    out.starts_tried += builder.tried();
  }

  const RootModel::Roots roots = model.roots(best.theta);
  out.sections = make_sections(roots.gain, roots.zeros, roots.poles);
  const auto through = [&](RadPerSecond w) { return out.sections.response(w); };
  const auto flat = [](RadPerSecond) { return Complex(1.0, 0.0); };
  const WaveformErrorOptions path{.path = options.path};
  out.error = waveform_error(through, disturbance, operating, path);
  out.none = waveform_error(flat, disturbance, operating, path);
  std::vector<Hertz> middle;
  for (size_t i = 0; i + 1 < operating.size(); ++i)
    middle.push_back({std::sqrt(operating[i].value * operating[i + 1].value)});
  if (!middle.empty()) {
    out.between = waveform_error(through, disturbance, middle, path);
    out.between_none = waveform_error(flat, disturbance, middle, path);
  }
  // The best fixed gain: a convex function of one number.
  double low = 0.0;
  double high = 3.0;
  const auto at_gain = [&](double gain) {
    const auto e = waveform_error([&](RadPerSecond) { return Complex(gain, 0.0); }, disturbance, operating,
                                  {.path = options.path, .harmonics = 16});
    return options.worst ? e.worst_percent : e.rms_percent;
  };
  while (high - low > 1e-6) {
    const double a = low + 0.382 * (high - low);
    const double b = low + 0.618 * (high - low);
    (at_gain(a) < at_gain(b) ? high : low) = at_gain(a) < at_gain(b) ? b : a;
  }
  out.constant_gain = 0.5 * (low + high);
  out.constant = waveform_error([&](RadPerSecond) { return Complex(out.constant_gain, 0.0); }, disturbance,
                                operating, path);
  BodePoints points;
  for (const Hertz f : operating) {
    const double gain = disturbance.rate_gain(
        options.path == DrivenPath::ascending ? Branch::ascending : Branch::descending, f);
    if (gain > 0.0) points.points.push_back({f, gain, std::nullopt, 1.0, 0});
  }
  if (points.points.size() >= 2) {
    const Cascade cascade = fit_cascade(points).cascade;
    out.magnitude_only =
        waveform_error([&](RadPerSecond w) { return cascade.response(w); }, disturbance, operating, path);
  }
  out.lower_bound_percent = waveform_lower_bound(disturbance, operating, options.path, options.worst);

  double magnitude = 0.0;
  double phase = 0.0;
  for (const Hertz f : operating) {
    const Complex g = out.sections.response(f.rad_s());
    const double wanted = disturbance.rate_gain(
        options.path == DrivenPath::ascending ? Branch::ascending : Branch::descending, f);
    magnitude = std::max(magnitude, std::abs(to_decibel(std::abs(g) / wanted)));
    phase = std::max(phase, std::abs(to_degrees(std::arg(g))));
  }
  out.sections.error = Sections::Error{{operating.front(), operating.back()}, magnitude, phase, magnitude};
  for (size_t i = 0; i < middle.size(); ++i) {
    if (out.between.points[i].rms_percent > out.between_none.points[i].rms_percent) {
      out.warnings.push_back(fmt::format(
          "between the operating frequencies, at {} Hz, the filter leaves {} % and no compensation {} %",
          rounded_text(middle[i].value, 3), rounded_text(out.between.points[i].rms_percent, 3),
          rounded_text(out.between_none.points[i].rms_percent, 3)));
    }
  }
  return out;
}

namespace {

Json error_json(const WaveformError& error) {
  Json points = Json::array();
  for (const WaveformErrorPoint& point : error.points) {
    points.push_back({{"frequency_hz", point.frequency.value},
                      {"rms_percent", point.rms_percent},
                      {"peak_percent", point.peak_percent}});
  }
  return {{"rms_percent", error.rms_percent}, {"worst_percent", error.worst_percent}, {"points", points}};
}

}  // namespace

Json WaveformFit::report_json() const {
  Json out;
  out["error"] = error_json(error);
  out["between"] = error_json(between);
  out["between_none"] = error_json(between_none);
  out["no_compensation"] = error_json(none);
  if (!magnitude_only.points.empty()) out["magnitude_only"] = error_json(magnitude_only);
  out["constant_gain"] = constant_gain;
  out["constant"] = error_json(constant);
  out["lower_bound_percent"] = lower_bound_percent;
  out["starts_tried"] = starts_tried;
  out["warnings"] = warnings;
  return out;
}

}  // namespace bodesmith
