#include "identify/stage_disturbance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::identify {
namespace {

using Branch = Disturbance::Branch;
using Cubic = std::array<double, 3>;

/// |K − 1| of a branch that counts as 1, in deviations: of ten gains that are 1, one exceeds it in one set of records out of
/// forty.
constexpr double kToldFromOne = 3.0;
/// A gain cannot be told from 1 within this, however clean the records: parts do not make the thousandth of it.
constexpr double kLeastDeviation = 1e-6;
/// Strokes that are one entry of the table.
constexpr double kOneStroke = 0.02;

/// Over [0, 1].
double inner(const Cubic& a, const Cubic& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out += a[i] * b[j] / static_cast<double>(i + j + 3);
  return out;
}

double area(const Cubic& a) {
  return a[0] / 2.0 + a[1] / 3.0 + a[2] / 4.0;
}

/// p and what stands at right angles to it among the cubics with zero ends: the first coefficient is then K itself, with
/// its deviation.
ShapePair along(const Cubic& p) {
  const double own = inner(p, p);
  Cubic best = kZeroEnds[0];
  double most = -1.0;
  for (const Cubic& candidate : kZeroEnds) {
    Cubic rest = candidate;
    const double share = own > 0.0 ? inner(candidate, p) / own : 0.0;
    for (std::size_t i = 0; i < 3; ++i) rest[i] -= share * p[i];
    if (inner(rest, rest) <= most) continue;
    most = inner(rest, rest);
    best = rest;
  }
  return {p, best};
}

Cubic times_gain(Cubic p, double gain) {
  for (double& value : p) value *= gain;
  return p;
}

/// The loop of one record with polynomials of its own.
struct OwnLoop {
  const TurnedRecord* record = nullptr;
  std::array<Cubic, 2> polynomial{};
  double stroke = 0.0;
  double own_rms = 0.0;
};

std::span<const Turn> judged(const TurnedRecord& record) {
  return record.held_out.empty() ? record.training : record.held_out;
}

OwnLoop own_loop(const TurnedRecord& record, const Scaling& input, const StageLag& lag) {
  const Eigen::MatrixXd columns = StageColumns{}.of(record, input, lag);
  const StageSolution solved = solve_stage(columns, *record.record, record.training);
  OwnLoop out{&record, {}, solved.c(1), 0.0};
  if (!(out.stroke != 0.0) || !solved.c.allFinite())
    throw InputError(record.record->file, 0, "the output does not follow the input, expected a stage's");
  for (const Eigen::Index b : {0, 1}) {
    const double a1 = solved.c(2 + 2 * b) / out.stroke;
    const double a2 = solved.c(3 + 2 * b) / out.stroke;
    out.polynomial[static_cast<std::size_t>(b)] = {a1, a2, -a1 - a2};
  }
  out.own_rms = StageSolution::rms(columns, solved.c, *record.record, judged(record));
  return out;
}

/// Descending above ascending: what a stage that dissipates has in its own sign.
double loop_height(const OwnLoop& loop) {
  return area(loop.polynomial[1]) - area(loop.polynomial[0]);
}

void require_one_sign(const std::vector<OwnLoop>& loops) {
  const OwnLoop& first = loops.front();
  for (const OwnLoop& one : loops) {
    const std::string& file = one.record->record->file;
    if (one.stroke * first.stroke < 0.0)
      throw InputError(
          file, 0,
          fmt::format("its output {} as the input rises, that of {} does not: expected records of one sign",
                      one.stroke < 0.0 ? "falls" : "rises", first.record->record->file));
    if (loop_height(one) * loop_height(first) < 0.0)
      throw InputError(
          file, 0,
          fmt::format("its loop runs {}, that of {} does not: expected loops of one sense",
                      loop_height(one) < 0.0 ? "clockwise" : "counterclockwise", first.record->record->file));
  }
}

/// The polynomials of all records at the lowest frequency, averaged.
std::array<Cubic, 2> base_polynomials(const std::vector<OwnLoop>& loops) {
  std::array<Cubic, 2> out{};
  double count = 0.0;
  for (const OwnLoop& one : loops) {
    if (one.record->frequency != loops.front().record->frequency) continue;
    count += 1.0;
    for (std::size_t b = 0; b < 2; ++b)
      for (std::size_t i = 0; i < 3; ++i) out[b][i] += (one.polynomial[b][i] - out[b][i]) / count;
  }
  for (std::size_t b = 0; b < 2; ++b)
    if (!(inner(out[b], out[b]) > kLeastDeviation * kLeastDeviation))  // rounding
      throw InputError(
          loops.front().record->record->file, 0,
          fmt::format("the {} branch is a straight line, expected a loop", to_string(kBranches[b])));
  return out;
}

LoopAtFrequency scaled_loop(const OwnLoop& own, const std::array<Cubic, 2>& base, const Scaling& input,
                            const StageLag& lag) {
  const TurnedRecord& record = *own.record;
  StageColumns shapes{.ascending = along(base[0]), .descending = along(base[1])};
  const Eigen::MatrixXd columns = shapes.of(record, input, lag);
  const StageSolution solved = solve_stage(columns, *record.record, record.training);
  LoopAtFrequency out;
  out.file = record.record->file;
  out.frequency = record.frequency;
  out.offset = solved.c(0);
  out.stroke = solved.c(1);
  out.stroke_deviation = solved.deviation(1);
  out.polynomial = own.polynomial;
  out.training_turns = record.training.size();
  out.held_out_turns = record.held_out.size();
  Eigen::VectorXd multiplied = solved.c;
  Eigen::VectorXd printed = solved.c;
  for (std::size_t b = 0; b < 2; ++b) {
    const Eigen::Index at = 2 + 2 * static_cast<Eigen::Index>(b);
    out.gain[b] = solved.c(at) / out.stroke;
    out.deviation[b] = solved.deviation(at) / std::abs(out.stroke);
    out.as_printed[b] = hysteresis::disturbance_gain(base[b], own.polynomial[b], GainReading::as_printed);
    printed(at) = out.as_printed[b] * out.stroke;
    multiplied(at + 1) = printed(at + 1) = 0.0;
  }
  const double percent = 100.0 / std::abs(out.stroke);
  const auto rms = [&](const Eigen::VectorXd& values) {
    return percent * StageSolution::rms(columns, values, *record.record, judged(record));
  };
  out.own_percent = percent * own.own_rms;
  out.gain_percent = rms(multiplied);
  out.as_printed_percent = rms(printed);
  return out;
}

/// Of gains that are relative to the base: its own deviation is in all of them, and the base's gain is 1.
void relate_to_base(std::vector<LoopAtFrequency>& loops) {
  const BranchPair base = loops.front().deviation;
  for (LoopAtFrequency& one : loops) {
    for (std::size_t b = 0; b < 2; ++b) {
      if (one.frequency == loops.front().frequency)
        one.deviation[b] = 0.0;
      else
        one.deviation[b] = std::hypot(one.deviation[b], one.gain[b] * base[b]);
    }
  }
}

GainReading better_reading(const std::vector<LoopAtFrequency>& loops) {
  double multiplied = 0.0, printed = 0.0;
  for (const LoopAtFrequency& one : loops) {
    if (one.frequency == loops.front().frequency) continue;
    multiplied += one.gain_percent * one.gain_percent;
    printed += one.as_printed_percent * one.as_printed_percent;
  }
  return printed < multiplied ? GainReading::as_printed : GainReading::basis_times_gain;
}

/// The rate table: records of one frequency averaged, gains of a branch that cannot be told from 1 as 1.
void make_rate_table(StageDisturbance& study) {
  for (std::size_t b = 0; b < 2; ++b) {
    for (const LoopAtFrequency& one : study.loops) {
      if (one.frequency == study.loops.front().frequency) continue;
      const double off = std::abs(study.gain(one)[b] - 1.0);
      study.static_sigma[b] =
          std::max(study.static_sigma[b], off / std::max(one.deviation[b], kLeastDeviation));
    }
  }
  Disturbance::RateGains table;
  for (std::size_t i = 0; i < study.loops.size();) {
    std::size_t end = i;
    BranchPair mean{};
    while (end < study.loops.size() && study.loops[end].frequency == study.loops[i].frequency) {
      for (std::size_t b = 0; b < 2; ++b) mean[b] += study.gain(study.loops[end])[b];
      ++end;
    }
    for (std::size_t b = 0; b < 2; ++b) {
      double gain = i == 0 ? 1.0 : mean[b] / static_cast<double>(end - i);
      if (!(gain > 0.0))
        throw InputError(
            study.loops[i].file, 0,
            fmt::format("its {} branch is {} times that of the lowest frequency, expected above 0: "
                        "another shape",
                        to_string(kBranches[b]), rounded_text(gain)));
      if (study.static_sigma[b] < kToldFromOne) gain = 1.0;
      table.of(kBranches[b]).push_back(gain);
    }
    table.frequency.push_back(study.loops[i].frequency);
    i = end;
  }
  if (table.frequency.size() < 2) {
    study.notes.push_back("records of one frequency: how the loop grows with it is not known");
    return;
  }
  study.disturbance.rate = std::move(table);
  for (std::size_t b = 0; b < 2; ++b)
    if (study.static_sigma[b] < kToldFromOne)
      study.notes.push_back(
          fmt::format("the {} branch's gains differ from 1 by up to {} deviations: taken as constant",
                      to_string(kBranches[b]), rounded_text(study.static_sigma[b], 2)));
}

/// The gains of one short turn.
LoopAtStroke short_loop(const TurnedRecord& record, const Turn& turn, const StageDisturbance& study) {
  const auto nearest =
      std::ranges::min_element(study.loops, [&](const LoopAtFrequency& a, const LoopAtFrequency& b) {
        const auto away = [&](Hertz f) { return std::abs(std::log(f.value / record.frequency.value)); };
        return away(a.frequency) < away(b.frequency);
      });
  StageColumns shapes;
  shapes.origin = study.input(turn.low);
  shapes.stroke = study.input(turn.high) - shapes.origin;
  const Disturbance& d = study.disturbance;
  shapes.ascending = along(times_gain(d.ascending, d.rate_gain(Branch::ascending, record.frequency)));
  shapes.descending = along(times_gain(d.descending, d.rate_gain(Branch::descending, record.frequency)));
  const Eigen::MatrixXd columns = shapes.of(record, study.input, study.lag);
  const StageSolution solved = solve_stage(columns, *record.record, {&turn, 1});
  LoopAtStroke out{
      .alpha = shapes.stroke, .slope = solved.c(1) / (shapes.stroke * nearest->stroke), .turns = 1};
  Eigen::VectorXd line = solved.c;
  line(0) = nearest->offset + shapes.origin * nearest->stroke;
  line(1) = shapes.stroke * nearest->stroke;
  out.line_percent =
      100.0 / std::abs(nearest->stroke) * StageSolution::rms(columns, line, *record.record, {&turn, 1});
  for (std::size_t b = 0; b < 2; ++b) {
    const Eigen::Index at = 2 + 2 * static_cast<Eigen::Index>(b);
    out.gain[b] = solved.c(at) / nearest->stroke;
    out.deviation[b] = solved.deviation(at) / std::abs(nearest->stroke);
  }
  return out;
}

void make_amplitude_table(const TurnedRecords& records, StageDisturbance& study) {
  std::vector<LoopAtStroke> all;
  bool elsewhere = false;
  for (const TurnedRecord& record : records.all) {
    for (const Turn& turn : record.partial) {
      if (study.input(turn.high) - study.input(turn.low) < kOneStroke) continue;
      elsewhere = elsewhere || std::abs(study.input(turn.low)) > kOneStroke;
      all.push_back(short_loop(record, turn, study));
    }
  }
  std::ranges::sort(all, [](const auto& a, const auto& b) { return a.alpha < b.alpha; });
  for (const LoopAtStroke& one : all) {
    if (study.strokes.empty() || one.alpha - study.strokes.back().alpha > kOneStroke) {
      study.strokes.push_back(one);
      continue;
    }
    LoopAtStroke& into = study.strokes.back();
    const auto n = static_cast<double>(into.turns);
    into.alpha = (n * into.alpha + one.alpha) / (n + 1.0);
    for (std::size_t b = 0; b < 2; ++b) {
      into.gain[b] = (n * into.gain[b] + one.gain[b]) / (n + 1.0);
      into.deviation[b] = std::hypot(n * into.deviation[b], one.deviation[b]) / (n + 1.0);
    }
    into.slope = (n * into.slope + one.slope) / (n + 1.0);
    into.line_percent = std::hypot(std::sqrt(n) * into.line_percent, one.line_percent) / std::sqrt(n + 1.0);
    ++into.turns;
  }
  if (study.strokes.empty()) return;
  for (const LoopAtStroke& one : study.strokes) {
    study.disturbance.amplitude.alpha.push_back(one.alpha);
    study.disturbance.amplitude.ascending.push_back(one.gain[0]);
    study.disturbance.amplitude.descending.push_back(one.gain[1]);
  }
  study.disturbance.amplitude.alpha.push_back(1.0);
  study.disturbance.amplitude.ascending.push_back(1.0);
  study.disturbance.amplitude.descending.push_back(1.0);
  if (elsewhere)
    study.notes.push_back(
        "some short strokes do not begin at the lower end: their gains are taken as those of strokes that do");
}

void say_signs(const std::vector<OwnLoop>& loops, StageDisturbance& study) {
  if (loops.front().stroke < 0.0)
    study.notes.push_back(
        "the output falls as the input rises: the stroke is negative, the polynomials are those of "
        "the output over its stroke");
  if (loop_height(loops.front()) < 0.0)
    study.notes.push_back(
        "the loop runs clockwise, its ascending branch above the descending one: no stage that "
        "dissipates does that; input and output may be exchanged, or the record be a compensator's");
}

/// One stroke for all frequencies, and ends on one line for all strokes, are what controllers take a stage for.
void say_what_one_line_leaves(StageDisturbance& study) {
  constexpr double kToldPercent = 0.5;
  const LoopAtFrequency& base = study.loops.front();
  const auto off = [&](const LoopAtFrequency& one) { return std::abs(one.stroke / base.stroke - 1.0); };
  const LoopAtFrequency& other = *std::ranges::max_element(study.loops, {}, off);
  if (off(other) >
      std::max(0.01 * kToldPercent, kToldFromOne * std::hypot(other.stroke_deviation, base.stroke_deviation) /
                                        std::abs(base.stroke)))
    study.notes.push_back(fmt::format(
        "the stroke at {} Hz is {} times that at {} Hz (creep, or a gain that falls): a disturbance has one stroke for all "
        "frequencies, and references are missed by what is between them",
        rounded_text(other.frequency.value), rounded_text(other.stroke / base.stroke, 4),
        rounded_text(base.frequency.value)));
  if (study.strokes.empty()) return;
  const LoopAtStroke& worst = *std::ranges::max_element(study.strokes, {}, &LoopAtStroke::line_percent);
  if (worst.line_percent > std::max(kToldPercent, 3.0 * base.own_percent))
    study.notes.push_back(fmt::format(
        "a stroke of {} goes {} times as far as its share of the full one: a disturbance has the ends of all strokes on one "
        "line, which leaves {} % of the full stroke rms there, in every controller of it; a model with memory "
        "(another type of identify, compensate) follows such ends",
        rounded_text(worst.alpha), rounded_text(worst.slope, 3), rounded_text(worst.line_percent, 3)));
}

}  // namespace

Branch StageDisturbance::varying() const {
  return static_sigma[0] > static_sigma[1] ? Branch::ascending : Branch::descending;
}

StageDisturbance identify_disturbance(std::span<const TimeRecord> records,
                                      std::optional<GainReading> reading) {
  for (const TimeRecord& record : records) record.require_measured_sizes();
  const TurnedRecords turned = cut_into_turns(records);
  StageDisturbance out;
  out.input = turned.input;
  out.lag = find_lag(turned);
  std::vector<OwnLoop> own;
  for (const TurnedRecord& record : turned.all)
    if (!record.training.empty()) own.push_back(own_loop(record, turned.input, out.lag));
  std::ranges::stable_sort(
      own, [](const OwnLoop& a, const OwnLoop& b) { return a.record->frequency < b.record->frequency; });
  require_one_sign(own);
  say_signs(own, out);
  const std::array<Cubic, 2> base = base_polynomials(own);
  out.disturbance.ascending = base[0];
  out.disturbance.descending = base[1];
  for (const OwnLoop& one : own) out.loops.push_back(scaled_loop(one, base, turned.input, out.lag));
  relate_to_base(out.loops);
  out.reading = reading.value_or(better_reading(out.loops));
  make_rate_table(out);
  make_amplitude_table(turned, out);
  say_what_one_line_leaves(out);
  if (std::ranges::any_of(out.loops, [](const auto& one) { return one.held_out_turns == 0; }))
    out.notes.push_back(
        "records of one turn hold nothing out: their errors are those of the turn that was fitted");
  return out;
}

}  // namespace bodesmith::identify
