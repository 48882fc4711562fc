#include "tuning/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "numeric/optimisation/population_search.hpp"

namespace bodesmith::tuning {
namespace {

struct Worst {
  double phase_margin_deg = 180.0;
  double gain_margin_db = INFINITY;
  double distance = INFINITY;  ///< least |1 + L|
};

void cross(const Complex& a, const Complex& b, Worst& worst) {
  if ((std::norm(a) < 1.0) != (std::norm(b) < 1.0)) {
    const double before = std::log(std::norm(a));
    const double t = before / (before - std::log(std::norm(b)));
    const double phase = std::arg(-a) + t * std::arg(b / a);
    const double margin = std::abs(to_degrees(std::remainder(phase, 2.0 * std::numbers::pi)));
    worst.phase_margin_deg = std::min(worst.phase_margin_deg, margin);
  }
  if ((a.imag() < 0.0) != (b.imag() < 0.0)) {
    const double t = a.imag() / (a.imag() - b.imag());
    const double real = a.real() + t * (b.real() - a.real());
    if (real < 0.0) worst.gain_margin_db = std::min(worst.gain_margin_db, std::abs(to_decibel(-real)));
  }
}

/// Two crossings of the negative real axis between samples: L is nearest to it at the middle one of three, and the parabola through
/// their angles from it comes as near as a degree, which is what such a parabola may be off by.
void graze(const Complex& a, const Complex& b, const Complex& c, Worst& worst) {
  if (!(b.real() < 0.0) || std::abs(b.imag()) > 0.3 * -b.real()) return;
  const double sign = b.imag() < 0.0 ? 1.0 : -1.0;
  const double before = sign * std::arg(-a);
  const double here = sign * std::arg(-b);  // 0 … pi/2
  const double after = sign * std::arg(-c);
  if (!(before > here && after > here)) return;
  const double slope = 0.5 * (after - before);
  const double curvature = 0.5 * (before + after) - here;
  const double square = slope * slope - 4.0 * curvature * (here - to_radians(1.0));
  if (square < 0.0) return;
  for (const double side : {-1.0, 1.0}) {
    const double t = (-slope + side * std::sqrt(square)) / (2.0 * curvature);
    const double ratio = t < 0.0 ? std::abs(a / b) : std::abs(c / b);
    const double size = std::abs(b) * std::pow(ratio, std::abs(t));
    worst.gain_margin_db = std::min(worst.gain_margin_db, std::abs(to_decibel(size)));
  }
}

/// By how much arg(1 + L) grows from the first sample to the last: the ends' difference, and a turn for each time that the
/// straight line between two samples crosses the real axis below -1, downwards.
double turns_of(std::span<const Complex> loop) {
  int crossings = 0;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const Complex& a = loop[i - 1];
    const Complex& b = loop[i];
    if ((a.imag() < 0.0) == (b.imag() < 0.0)) continue;
    const double t = a.imag() / (a.imag() - b.imag());
    if (a.real() + t * (b.real() - a.real()) < -1.0) crossings += b.imag() < 0.0 ? 1 : -1;
  }
  return std::arg(1.0 + loop.back()) - std::arg(1.0 + loop.front()) + 2.0 * std::numbers::pi * crossings;
}

}  // namespace

bool turns_are_stable(std::span<const Complex> loop, int integrators) {
  if (!(std::abs(loop.back()) < 1.0)) return false;
  // It comes from -90 degrees an integrator, and ends near 0.
  return std::abs(turns_of(loop) - 0.5 * std::numbers::pi * integrators) < 0.5 * std::numbers::pi;
}

double shortfall(std::span<const Complex> loop, int integrators, const LoopLimits& limits) {
  Worst worst;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    worst.distance = std::min(worst.distance, std::abs(1.0 + loop[i]));
    if (i > 0) cross(loop[i - 1], loop[i], worst);
    if (i > 1) graze(loop[i - 2], loop[i - 1], loop[i], worst);
  }
  const auto missing = [](double wanted, double got) { return std::max(0.0, (wanted - got) / wanted); };
  double out = missing(limits.phase_margin_deg, worst.phase_margin_deg) +
               missing(limits.gain_margin_db, worst.gain_margin_db);
  if (limits.max_sensitivity) out += missing(1.0 / *limits.max_sensitivity, worst.distance);
  if (!turns_are_stable(loop, integrators)) out += 2.0;
  return out;
}

namespace {

/// Local maxima of |P| above `from`, highest first.
std::vector<Hertz> peaks_of(const std::vector<Hertz>& grid, const std::vector<Complex>& plant, Hertz from) {
  std::vector<std::pair<double, Hertz>> found;
  for (std::size_t i = 1; i + 1 < grid.size(); ++i) {
    const double size = std::abs(plant[i]);
    if (grid[i] > from && size > std::abs(plant[i - 1]) && size >= std::abs(plant[i + 1]))
      found.emplace_back(-size, grid[i]);
  }
  std::ranges::sort(found);
  std::vector<Hertz> out;
  for (const auto& [size, f] : found) out.push_back(f);
  return out;
}

/// A log grid, finer where a plant turns quickly from one frequency to the next: what a light resonance does.
std::vector<Hertz> dense_where_it_turns(const PlantFamily& plants, Band band, int count) {
  std::vector<Hertz> grid = log_grid(band, count);
  // A crossing is looked for on the chord between two samples. A resonance's circle bulges beyond it by turn²/8 of its
  // radius: 0.5 %, which is 0.04 dB.
  constexpr double kMostTurn = 0.2;
  constexpr std::size_t kMost = 6000;
  for (int round = 0; round < 12 && grid.size() < kMost; ++round) {
    std::vector<Hertz> next{grid.front()};
    for (std::size_t i = 1; i < grid.size(); ++i) {
      double turn = 0.0;
      for (const PlantMember& member : plants.members) {
        const Complex ratio = member.response(grid[i].rad_s()) / member.response(grid[i - 1].rad_s());
        turn = std::max({turn, std::abs(std::arg(ratio)), std::abs(std::log(std::abs(ratio)))});
      }
      if (turn > kMostTurn && std::log(grid[i].value / grid[i - 1].value) > 1e-5)
        next.push_back(Hertz{std::sqrt(grid[i - 1].value * grid[i].value)});
      next.push_back(grid[i]);
    }
    if (next.size() == grid.size()) break;
    grid = std::move(next);
  }
  return grid;
}

/// Poles at 0 and the sign of a plant, from its slope and phase at the lowest frequency: what it does towards rest.
struct AtRest {
  int integrators = 0;
  double sign = 1.0;
};
AtRest at_rest(const Response& plant, Hertz lowest) {
  const RadPerSecond w = lowest.rad_s();
  const Complex here = plant(w);
  const double slope = std::log(std::abs(plant(RadPerSecond{1.2 * w.value}) / here)) / std::log(1.2);
  AtRest out;
  out.integrators = std::max(0, nearest_whole<int>(-slope));
  const double phase = std::arg(here) + 0.5 * std::numbers::pi * out.integrators;
  out.sign = std::cos(phase) >= 0.0 ? 1.0 : -1.0;
  return out;
}

/// Loops at one crossover, the plants sampled once.
class Problem {
 public:
  Problem(const PlantFamily& plants, const ControllerKind& kind, const TuneOptions& options, Hertz crossover)
      : kind_(kind), limits_(options.limits), seed_(options.seed) {
    // Crossings between samples are found to some tenths; sections leave some .1 dB of a form that they stand for.
    limits_.phase_margin_deg += 1.0;
    limits_.gain_margin_db += 0.15;
    if (!kind.made_exactly()) gains_ = {0.98, 1.02};
    // Two decades below the crossover a loop that integrates is far from -1, thirty times above it has rolled off.
    constexpr double kBelow = 200.0;
    constexpr double kAbove = 50.0;
    constexpr int kPoints = 160;
    Band band{Hertz{crossover.value / kBelow}, Hertz{kAbove * crossover.value}};
    if (plants.band) band.to = std::max(band.to, Hertz{3.0 * plants.band->to.value});
    grid_ = dense_where_it_turns(plants, band, kPoints);
    for (const PlantMember& member : plants.members) {
      samples_.emplace_back();
      for (const Hertz f : grid_) samples_.back().push_back(member.response(f.rad_s()));
    }
    rest_ = at_rest(plants.nominal().response, grid_.front());
    at_crossover_ = plants.nominal().response(crossover.rad_s());
    setting_.crossover = crossover;
    setting_.derivative_corner = options.derivative_corner.value_or(Hertz{10.0 * crossover.value});
    setting_.highest = grid_.back();
    setting_.resonances = peaks_of(grid_, samples_.front(), Hertz{0.8 * crossover.value});
  }

  const ShapeSetting& setting() const { return setting_; }
  const std::vector<Hertz>& grid() const { return grid_; }
  int integrators() const { return rest_.integrators + 1; }

  Eigen::VectorXd best() const { return search(-std::numeric_limits<double>::infinity()).x; }
  /// Whether any controller of the kind keeps the limits; a search that ends with the first.
  bool can_be_kept() const { return search(kMissed).cost < kMissed; }

  /// Scaled so that the nominal loop has a gain of 1 at the crossover.
  SeriesController made(const Eigen::VectorXd& x) const {
    SeriesController out = kind_.make(x, setting_);
    const Complex s(0.0, setting_.crossover.rad_s().value);
    const double gain = rest_.sign / std::abs(out.response(s) * at_crossover_);
    out.pid.proportional *= gain;
    out.pid.integral_per_s *= gain;
    out.pid.derivative_s *= gain;
    return out;
  }

 private:
  static constexpr double kMissed = 1e3;

  DifferentialEvolutionResult search(double enough) const {
    const ControllerKind::Bounds bounds = kind_.bounds(setting_);
    DifferentialEvolutionOptions options;
    const auto numbers = static_cast<int>(bounds.lower.size());
    options.population = std::max(20, 8 * numbers);
    options.generations = 50 + 12 * numbers;
    options.spread = 1e-5;
    options.seed = seed_;
    options.enough = std::nextafter(enough, -INFINITY);
    return differential_evolution([this](const Eigen::VectorXd& x) { return cost(x); }, bounds.lower,
                                  bounds.upper, options);
  }

  /// How far |L| is from falling through 1 once, at the crossover: to .95 within a tenth of its frequency and staying below,
  /// and above 1/.95 until a tenth before. In nepers; 0 when it does.
  double wrong_side_of_crossover(const std::vector<Complex>& loop) const {
    constexpr double kPast = 0.95;
    double above = 0.0;
    double below = INFINITY;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (grid_[i].value > 1.1 * setting_.crossover.value) above = std::max(above, std::norm(loop[i]));
      if (1.1 * grid_[i].value < setting_.crossover.value) below = std::min(below, std::norm(loop[i]));
    }
    return std::max(0.0, 0.5 * std::log(above) - std::log(kPast)) +
           std::max(0.0, -std::log(kPast) - 0.5 * std::log(below));
  }

  /// Shortfalls first, then the gain at a hundredth of the crossover that is not had.
  double cost(const Eigen::VectorXd& x) const {
    const SeriesController made = kind_.made_exactly() ? kind_.make(x, setting_) : SeriesController{};
    const double w = setting_.crossover.rad_s().value;
    const auto c = [&](double at) { return kind_.response(made, x, setting_, Complex(0.0, at)); };
    const Complex centre = c(w);
    const double gain = rest_.sign / std::abs(centre * at_crossover_);
    std::vector<Complex> controller;
    controller.reserve(grid_.size());
    for (const Hertz f : grid_) controller.push_back(gain * c(f.rad_s().value));
    std::vector<Complex> loop(grid_.size());
    double worst = 0.0;
    for (const std::vector<Complex>& plant : samples_) {
      for (const double factor : gains_) {
        for (std::size_t i = 0; i < loop.size(); ++i) loop[i] = factor * controller[i] * plant[i];
        worst = std::max(worst, shortfall(loop, integrators(), limits_));
      }
      // A bandwidth is where the loop's gain falls to 1, once.
      if (&plant == &samples_.front()) worst += wrong_side_of_crossover(loop);
      // The nominal plant first: as long as it is not served, the others say little more.
      constexpr double kNominalMissed = 10.0;
      if (&plant == &samples_.front() && worst > 0.0) return kMissed * (1.0 + kNominalMissed + worst);
    }
    if (worst > 0.0) return kMissed * (1.0 + worst);
    return -std::log(std::abs(c(0.01 * w) / centre));
  }

  const ControllerKind& kind_;
  LoopLimits limits_;
  std::vector<double> gains_{1.0};  ///< by which the loop is judged
  std::uint64_t seed_;
  ShapeSetting setting_;
  std::vector<Hertz> grid_;
  std::vector<std::vector<Complex>> samples_;  ///< a plant each
  AtRest rest_;
  Complex at_crossover_;
};

/// The highest bandwidth at which the limits are kept: a scan downwards in octaves, then halving.
std::optional<Hertz> highest_bandwidth(const PlantFamily& plants, const ControllerKind& kind,
                                       const TuneOptions& options, Band band) {
  const auto possible = [&](double hz) {
    const Problem problem(plants, kind, options, Hertz{hz});
    return problem.can_be_kept();
  };
  const double step = 2.0;
  double high = band.to.value;
  double low = high;
  while (low >= band.from.value && !possible(low)) {
    high = low;
    low /= step;
  }
  if (low < band.from.value) return std::nullopt;
  constexpr int kHalvings = 5;  // to 2 %
  for (int i = 0; i < kHalvings && high > low; ++i) {
    const double middle = std::sqrt(low * high);
    (possible(middle) ? low : high) = middle;
  }
  return Hertz{low};
}

std::vector<MemberMargins> all_margins(const PlantFamily& plants, const SeriesController& controller,
                                       const Problem& problem) {
  std::vector<MemberMargins> out;
  for (const PlantMember& member : plants.members) {
    const Loop loop = [&](Hertz f) {
      return controller.response(Complex(0.0, f.rad_s().value)) * member.response(f.rad_s());
    };
    std::vector<Complex> samples;
    for (const Hertz f : problem.grid()) samples.push_back(loop(f));
    out.push_back(
        {member.name, loop_margins(loop, problem.grid()), turns_are_stable(samples, problem.integrators())});
  }
  return out;
}

/// A limit over all plants: how many miss it, and by which it is missed most.
struct Missed {
  int count = 0;
  double worst = INFINITY;  ///< what was had, in parts of what was asked
  std::string text;

  void see(double had, const std::string& value, const std::string& plant) {
    // A hundredth is rounding: the search works between samples.
    if (had >= 0.99) return;
    ++count;
    if (had >= worst) return;
    worst = had;
    text = fmt::format("{} (plant: {})", value, plant);
  }
};

/// One line a limit. The margins of a loop that is not stable are none.
std::vector<std::string> missed_of(const std::vector<MemberMargins>& members, const LoopLimits& limits) {
  Missed stable;
  Missed phases;
  Missed gains;
  Missed sensitivity;
  for (const MemberMargins& member : members) {
    if (!member.stable) {
      stable.see(0.0, "unstable", member.plant);
      continue;
    }
    if (const auto* phase = member.margins.least_phase_margin())
      phases.see(std::abs(phase->phase_margin_deg) / limits.phase_margin_deg,
                 rounded_text(phase->phase_margin_deg, 3), member.plant);
    if (const auto* gain = member.margins.least_gain_margin())
      gains.see(std::abs(gain->gain_margin_db) / limits.gain_margin_db, rounded_text(gain->gain_margin_db, 3),
                member.plant);
    if (limits.max_sensitivity)
      sensitivity.see(*limits.max_sensitivity / member.margins.max_sensitivity,
                      rounded_text(member.margins.max_sensitivity, 3), member.plant);
  }
  std::vector<std::string> out;
  const auto add = [&](const Missed& missed, const std::string& asked) {
    if (missed.count == 0) return;
    out.push_back(fmt::format("{}: {}", asked, missed.text) +
                  (members.size() > 1 ? fmt::format(", {} of {} plants", missed.count, members.size()) : ""));
  };
  add(stable, "stability");
  add(phases, fmt::format("a phase margin of {} deg", limits.phase_margin_deg));
  add(gains, fmt::format("a gain margin of {} dB", limits.gain_margin_db));
  add(sensitivity, fmt::format("a sensitivity of at most {}", limits.max_sensitivity.value_or(0.0)));
  return out;
}

Band searched(const PlantFamily& plants) {
  if (!plants.band)
    throw DesignError("the plant states no band (it has no corners), expected a bandwidth in Hz");
  // An integral alone keeps any margin far enough below the corners.
  return Band{Hertz{plants.band->from.value / 100.0}, plants.band->to};
}

/// The best controller with that bandwidth, and what it misses.
TunedLoop tuned_at(Hertz crossover, const PlantFamily& plants, const ControllerKind& kind,
                   const TuneOptions& options) {
  const Problem problem(plants, kind, options, crossover);
  TunedLoop out;
  out.bandwidth = crossover;
  out.controller = problem.made(problem.best());
  out.members = all_margins(plants, out.controller, problem);
  out.missed = missed_of(out.members, options.limits);
  std::vector<std::string> too;
  for (const LoopMargins::GainCrossing& crossing : out.members.front().margins.gain_crossings) {
    if (std::abs(std::log(crossing.frequency.value / crossover.value)) > std::log(1.1))
      too.push_back(engineering_text(crossing.frequency.value, "Hz", 3));
  }
  if (!too.empty())
    out.missed.push_back(
        fmt::format("a gain of 1 at the bandwidth alone: it is 1 at {}, too", join(too, ", ")));
  return out;
}

Json margins_json(const LeastMargins& margins) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  return {{"phase_margin_deg", number(margins.phase_margin_deg)},
          {"gain_margin_db", number(margins.gain_margin_db)},
          {"max_sensitivity", margins.max_sensitivity}};
}

}  // namespace

LeastMargins least_margins(const std::vector<MemberMargins>& members) {
  LeastMargins out;
  for (const MemberMargins& member : members) {
    if (const auto* phase = member.margins.least_phase_margin();
        phase != nullptr &&
        (!out.phase_margin_deg || std::abs(phase->phase_margin_deg) < std::abs(*out.phase_margin_deg)))
      out.phase_margin_deg = phase->phase_margin_deg;
    if (const auto* gain = member.margins.least_gain_margin();
        gain != nullptr &&
        (!out.gain_margin_db || std::abs(gain->gain_margin_db) < std::abs(*out.gain_margin_db)))
      out.gain_margin_db = gain->gain_margin_db;
    out.max_sensitivity = std::max(out.max_sensitivity, member.margins.max_sensitivity);
  }
  return out;
}

bool TunedLoop::stable() const {
  return std::ranges::all_of(members, [](const MemberMargins& m) { return m.stable; });
}

Json TunedLoop::report_json(const TuneOptions& options) const {
  Json out = {{"bandwidth_hz", bandwidth.value},
              {"asked",
               {{"phase_margin_deg", options.limits.phase_margin_deg},
                {"gain_margin_db", options.limits.gain_margin_db}}},
              {"nominal", margins_json(least_margins({members.front()}))},
              {"worst", margins_json(least_margins(members))},
              {"plants", Json::array()},
              {"missed", missed}};
  if (options.limits.max_sensitivity) out["asked"]["max_sensitivity"] = *options.limits.max_sensitivity;
  if (options.bandwidth) out["asked"]["bandwidth_hz"] = options.bandwidth->value;
  if (reachable_bandwidth) out["reachable_bandwidth_hz"] = reachable_bandwidth->value;
  for (const MemberMargins& member : members) {
    Json one = {{"plant", member.plant}, {"stable", member.stable}};
    one.update(margins_json(least_margins({member})));
    out["plants"].push_back(one);
  }
  return out;
}

TunedLoop tune(const PlantFamily& plants, const ControllerKind& kind, const TuneOptions& options) {
  std::optional<Hertz> crossover = options.bandwidth;
  if (!crossover) {
    crossover = highest_bandwidth(plants, kind, options, searched(plants));
    if (!crossover)
      throw DesignError(
          fmt::format("no {} keeps these margins with a bandwidth within {} to {}, expected "
                      "smaller margins or a bandwidth below",
                      kind.name(), engineering_text(searched(plants).from.value, "Hz"),
                      engineering_text(searched(plants).to.value, "Hz")));
  }
  TunedLoop out = tuned_at(*crossover, plants, kind, options);
  // Sections stand for a form within some tenths of a dB: the form's highest bandwidth may be out of their reach.
  constexpr double kLower = 0.9;
  constexpr int kTries = 8;  // to .43 of it
  for (int i = 0; i < kTries && !out.met() && !options.bandwidth && !kind.made_exactly(); ++i) {
    out = tuned_at(Hertz{kLower * out.bandwidth.value}, plants, kind, options);
  }
  if (!out.met() && options.bandwidth) {
    const Band below{Hertz{crossover->value / 100.0}, Hertz{crossover->value / std::cbrt(2.0)}};
    out.reachable_bandwidth = highest_bandwidth(plants, kind, options, below);
  }
  return out;
}

}  // namespace bodesmith::tuning
