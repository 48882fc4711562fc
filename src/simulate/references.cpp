#include "simulate/references.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.hpp"
#include "base/text.hpp"
#include "numeric/random.hpp"

namespace bodesmith::simulate {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Part of the period at sample i. Counted in samples where a period is a whole number of them, so that every
/// period has the same values; else snapped to its corners where only rounding keeps it off.
double phase_of(std::size_t i, const ReferenceSpec& s) {
  const double period = 1.0 / (s.frequency.value * s.step_s);
  const double whole = std::round(period);
  if (whole < 1e15 && std::abs(period - whole) < 1e-9 * whole) {
    const auto samples = static_cast<std::size_t>(whole);
    return static_cast<double>(i % samples) / static_cast<double>(samples);
  }
  const double turns = s.step_s * static_cast<double>(i) * s.frequency.value;
  double part = turns - std::floor(turns);
  for (const double corner : {0.0, 0.5, 1.0}) {
    if (std::abs(part - corner) < 1e-12 * std::max(1.0, turns)) part = corner;
  }
  return part == 1.0 ? 0.0 : part;
}

/// 0 up to 1 and down again.
double triangle(double part) {
  return part < 0.5 ? 2.0 * part : 2.0 - 2.0 * part;
}

void fill_triangle(const ReferenceSpec& s, TimeRecord& r) {
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    r.u[i] = s.offset + s.amplitude * (2.0 * triangle(phase_of(i, s)) - 1.0);
  }
}

void fill_sine(const ReferenceSpec& s, TimeRecord& r) {
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    r.u[i] = s.offset - s.amplitude * std::cos(kTurn * phase_of(i, s));
  }
}

void fill_stair(const ReferenceSpec& s, TimeRecord& r) {
  if (s.steps < 1 || s.steps > 1000000) throw InputError("a stair needs between 1 and 1000000 steps");
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    const double level = std::floor(triangle(phase_of(i, s)) * s.steps * (1.0 + 1e-12)) / s.steps;
    r.u[i] = s.offset + s.amplitude * (2.0 * std::min(level, 1.0) - 1.0);
  }
}

void fill_multisine(const ReferenceSpec& s, TimeRecord& r) {
  if (!(s.last >= s.frequency)) throw InputError("a multisine's highest line is below its lowest");
  std::mt19937_64 random(s.seed);
  std::vector<std::pair<double, double>> lines;
  for (int k = 1; k * s.frequency.value <= s.last.value * (1.0 + 1e-12); k += 2) {
    lines.emplace_back(k * s.frequency.value, kTurn * unit_interval(random()));
    if (lines.size() > 20000) throw InputError("a multisine of more than 20000 lines, expected fewer");
  }
  double peak = 0.0;
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    double sum = 0.0;
    for (const auto& [f, phase] : lines) sum += std::cos(kTurn * f * r.time_s(i) + phase);
    r.u[i] = sum;
    peak = std::max(peak, std::abs(sum));
  }
  for (double& u : r.u) u = s.offset + s.amplitude * (peak > 0.0 ? u / peak : 0.0);
}

void fill_chirp(const ReferenceSpec& s, TimeRecord& r) {
  const double ratio = std::log(s.last.value / s.frequency.value);
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    const double t = r.time_s(i);
    const double turns = std::abs(ratio) < 1e-12 ? s.frequency.value * t
                                                 : s.frequency.value * s.duration_s / ratio *
                                                       std::expm1(ratio * t / s.duration_s);
    r.u[i] = s.offset - s.amplitude * std::cos(kTurn * turns);
  }
}

void fill_complex(const ReferenceSpec&, TimeRecord& r) {
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    const double t = r.time_s(i);
    r.u[i] = 0.415 +
             0.23 * (std::sin(kTurn * t) + 0.3 * std::sin(0.5 * kTurn * t) + 0.5 * std::sin(0.1 * kTurn * t));
  }
}

struct Kind {
  ReferenceKind about;
  void (*fill)(const ReferenceSpec&, TimeRecord&);
  /// Its own frequency; all up to the last one; those of fill_complex, whatever is asked.
  enum class Shows { own, up_to_last, fixed } shows = Shows::own;
  bool repeats = true;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {{"triangle", "straight lines up and down"}, fill_triangle},
      {{"sine", "one frequency"}, fill_sine},
      {{"stair", "equal levels up and down"}, fill_stair},
      {{"multisine", "odd lines with random phases"}, fill_multisine, Kind::Shows::up_to_last},
      {{"chirp", "one frequency after the other"}, fill_chirp, Kind::Shows::up_to_last, false},
      {{"complex", "three sines"}, fill_complex, Kind::Shows::fixed}};
  return all;
}

const Kind& kind_named(const std::string& name) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds()) {
    if (kind.about.name == reference_kind(name)) return kind;
    names.push_back(kind.about.name);
  }
  throw InputError(fmt::format("the reference '{}' is not known{}, expected one of {}", name,
                               did_you_mean(name, names), join(names, ", ")));
}

}  // namespace

std::string reference_kind(const std::string& name) {
  return name == "steps" ? "stair" : name;
}

const std::vector<ReferenceKind>& reference_kinds() {
  static const std::vector<ReferenceKind> names = [] {
    std::vector<ReferenceKind> out;
    for (const Kind& kind : kinds()) out.push_back(kind.about);
    return out;
  }();
  return names;
}

TimeRecord make_reference(const ReferenceSpec& spec) {
  if (!(spec.step_s > 0.0) || !(spec.duration_s > 0.0))
    throw InputError("a reference needs a step and a duration above 0 s");
  if (!(spec.frequency.value > 0.0) || !(spec.last.value > 0.0))
    throw InputError("a reference needs frequencies above 0 Hz");
  const double count = std::round(spec.duration_s / spec.step_s);
  if (!(count >= 1.0) || count > 5e7) {
    throw InputError(fmt::format("a reference of {} s in steps of {} s, expected 2 to 50 million samples",
                                 rounded_text(spec.duration_s), rounded_text(spec.step_s)));
  }
  const Kind& kind = kind_named(spec.kind);
  double highest = kind.shows == Kind::Shows::fixed ? 0.0 : spec.frequency.value;
  if (kind.shows == Kind::Shows::up_to_last) highest = std::max(highest, spec.last.value);
  if (highest * spec.step_s > 0.5) {
    throw InputError(fmt::format("a step of {} s cannot show {} Hz, expected at most {} s",
                                 rounded_text(spec.step_s), rounded_text(highest),
                                 rounded_text(0.5 / highest)));
  }
  TimeRecord record;
  record.step_s = spec.step_s;
  record.u.resize(static_cast<std::size_t>(count) + 1);
  kind.fill(spec, record);
  return record;
}

bool can_be_swept(const std::string& kind) {
  return std::ranges::any_of(
      kinds(), [&](const Kind& k) { return k.about.name == kind && k.shows == Kind::Shows::own; });
}

std::optional<Hertz> fundamental_of(const ReferenceSpec& spec) {
  const Kind& kind = kind_named(spec.kind);
  if (kind.shows == Kind::Shows::fixed) return Hertz{0.1};
  return kind.repeats ? std::optional(spec.frequency) : std::nullopt;
}

}  // namespace bodesmith::simulate
