#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "gap/evidence/noise_floor.hpp"
#include "gap/report/files.hpp"
#include "gap/report/words.hpp"
#include "measured/measured.hpp"
#include "measured/suspects.hpp"
#include "project/run.hpp"
#include "signal/csv.hpp"
#include "signal/period.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::measured {
namespace {
namespace fs = std::filesystem;

using chain::Block;
using chain::Chain;

/// A name that is less likely than its contrary accuses nothing. What may be outside the catalogue is here for the most part tolerances.
constexpr double kAccused = 0.5;
/// Times the noise, rms over a record of some hundred samples: odds beyond any doubt.
constexpr double kTells = 1.0;
/// A free parameter has moved when the record is worse by this without it.
constexpr double kMoved = 1.1;

/// The last whole period of a record, or all of it.
struct Period {
  std::size_t from = 0;
  std::size_t samples = 0;
  std::optional<Hertz> frequency;

  explicit Period(const TimeRecord& record) : samples(record.size()) {
    const std::size_t period = find_period(record.u);
    if (period == 0) return;
    frequency = Hertz{1.0 / (record.step_s * static_cast<double>(period))};
    samples = period;
    from = record.size() - period;
  }
  std::vector<double> of(const std::vector<double>& all) const {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(from);
    return {begin, begin + static_cast<std::ptrdiff_t>(samples)};
  }
};

/// Something that stands in a run's folder and may have been measured.
struct Prediction {
  std::string of;
  Chain chain;
  std::vector<double> y;
  ErrorFigures gap;
};

/// Rate gains are those of the record's own frequency.
void set_operating(Chain& chain, std::optional<Hertz> frequency) {
  for (Block& block : chain.blocks) {
    if (frequency && block.has("operating_hz")) block.set("operating_hz", frequency->value);
  }
}

std::vector<double> output(const Chain& chain, const TimeRecord& record) {
  simulate::Options options;
  options.estimate_error = false;
  return simulate::simulate(chain, record, options).y;
}

/// Of a record that another prediction would fit in another unit, far better than the nearest one does as it stands.
void require_its_unit(const std::vector<Prediction>& all, const Prediction& nearest,
                      const TimeRecord& record) {
  constexpr double kNoFault = 5.0, kBetter = 0.2;
  for (const Prediction& one : all) {
    double product = 0.0, square = 0.0;
    for (std::size_t i = 0; i < one.y.size(); ++i) {
      product += one.y[i] * record.y[i];
      square += one.y[i] * one.y[i];
    }
    const double times = square > 0.0 ? product / square : 1.0;
    if (std::abs(times) < kNoFault && std::abs(times) > 1.0 / kNoFault) continue;
    std::vector<double> scaled = one.y;
    for (double& y : scaled) y *= times;
    if (error_figures(scaled, record.y).rms_percent > kBetter * nearest.gap.rms_percent) continue;
    throw InputError(
        record.file, 0,
        fmt::format(
            "its y is {} times what {} would give: expected metres of a stage, full strokes of a controller",
            rounded_text(times, 3), one.of));
  }
}

/// Controller and stage, the controller alone, the stage alone: whichever predicts the record best.
Prediction nearest_prediction(const fs::path& folder, const TimeRecord& record, const Period& period,
                              Provenance& from) {
  std::vector<Prediction> all;
  if (fs::exists(folder / "model.toml")) {
    all.push_back({"the controller and the stage", chain::read_model(folder / "model.toml", from), {}, {}});
    Chain controller;
    controller.blocks = {all.back().chain.blocks.front()};
    all.push_back({"the controller", std::move(controller), {}, {}});
  }
  if (fs::exists(folder / "stage.toml"))
    all.push_back({"the stage", chain::read_model(folder / "stage.toml", from), {}, {}});
  if (all.empty())
    throw InputError(record.file, 0,
                     "is a time record, expected a frequency response: " + folder.string() +
                         " has a circuit, and neither a controller nor a stage");
  for (Prediction& one : all) {
    set_operating(one.chain, period.frequency);
    one.y = output(one.chain, record);
    one.gap = error_figures(one.y, record.y);
  }
  const Prediction& out = *std::min_element(
      all.begin(), all.end(),
      [](const Prediction& a, const Prediction& b) { return a.gap.rms_percent < b.gap.rms_percent; });
  require_its_unit(all, out, record);
  return out;
}

/// rms, 0 where the record does not say.
double noise_of(const gap::Diagnosis& d) {
  return d.floor.source == gap::NoiseFloor::Source::unknown ? 0.0 : d.floor.rms;
}

/// Where what is left besides the one part that is accused is other parts' tolerances: that part by as much as it is off in addition to
/// theirs.
bool the_rest_is_tolerances(gap::Diagnosis& d, const TimeRecord& record, double noise_rms) {
  const auto step = std::find_if(d.steps.begin(), d.steps.end(),
                                 [](const gap::DiagnosedStep& s) { return s.effect == "part_value"; });
  gap::Model& model = d.search.final;
  const auto more = good_parts_explain(model.chain(), record, noise_rms,
                                       step == d.steps.end() ? std::string() : step->part);
  if (!more || step == d.steps.end()) return more.has_value();
  const auto k = static_cast<std::size_t>(step - d.steps.begin());
  std::vector<double> values;
  for (const gap::Unknown& unknown : model.unknowns()) values.push_back(unknown.value);
  values[model.first_unknown_of(k)] += more->further;
  model.set_values(values);
  for (double* value :
       {&step->parameters.front().value, &step->parameters.front().low, &step->parameters.front().high})
    *value += more->further;
  return true;
}

/// A stage's curves: polynomials that are no circuit's.
bool has_curves_of_a_stage(const Block& block) {
  return !block.parts && !block.polynomials().empty();
}

/// With the stage's curves to be found anew.
Chain with_free_curves(Chain chain) {
  for (Block& block : chain.blocks) {
    if (!has_curves_of_a_stage(block)) continue;
    for (const chain::PolynomialList& list : block.polynomials()) block.free(list.key);
  }
  return chain;
}

/// What was found, and the model that it was found from.
struct Found {
  Chain base;
  gap::Diagnosis diagnosis;
};

/// Names are looked for as long as good parts and noise do not explain the rest, one first: one thing is wrong with what was
/// built far more often than two. 0: nothing is. A stage is what its records were some time ago: before two things are wrong, or
/// a multiplier where it has none, its curves are others.
Found diagnosed(const Chain& built, const TimeRecord& record, const gap::Study& study,
                const gap::SearchOptions& options) {
  Found out{built, {}};
  const auto explains = [&](const Chain& base, int terms) {
    gap::SearchOptions asked = options;
    asked.max_terms = terms;
    gap::Diagnosis d = gap::diagnose(base, study, asked);
    const double noise = noise_of(d);
    const bool nothing =
        noise > 0.0 && terms == 0 && good_parts_do_as_much(built, d.search.final.chain(), record, noise);
    const bool all = nothing || (noise > 0.0 && the_rest_is_tolerances(d, record, noise));
    if (all) {
      d.verdict = nothing ? gap::Verdict::nothing_missing : gap::Verdict::explained;
      d.advice.clear();
    }
    out = {base, std::move(d)};
    return all;
  };
  const auto of_the_stage = [&] {
    const auto& steps = out.diagnosis.steps;
    return std::any_of(built.blocks.begin(), built.blocks.end(), [&](const Block& block) {
      return has_curves_of_a_stage(block) && std::any_of(steps.begin(), steps.end(), [&](const auto& step) {
               return step.effect == "multiplier_error" && step.part == block.part;
             });
    });
  };
  if (explains(built, 0) || (explains(built, 1) && !of_the_stage())) return out;
  const auto left = [&] {
    return error_figures(output(out.diagnosis.search.final.chain(), record), record.y).rms;
  };
  const double by_one_name = left();
  Chain base = built;
  if (std::any_of(built.blocks.begin(), built.blocks.end(), has_curves_of_a_stage)) {
    if (explains(with_free_curves(built), 0)) return out;
    // With more to find: where the curves leave less than any name does, alongside them.
    if (left() < by_one_name) base = out.base;
  }
  explains(base, options.max_terms);
  return out;
}

/// By how much a stage's curves went from those before, at most, in percent of a full stroke: "3.1 % (ascending)".
std::string moved_curves(const Block& before, const Block& now) {
  std::vector<std::string> out;
  for (const chain::PolynomialList& list : before.polynomials()) {
    const std::vector<double> a = before.list(list.key), b = now.list(list.key);
    double most = 0.0;
    for (int k = 0; k <= 100; ++k) {
      double power = list.first == 0 ? 0.01 * k : 1.0, difference = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i, power *= 0.01 * k) difference += (b[i] - a[i]) * power;
      most = std::max(most, 100.0 * std::abs(difference));
    }
    out.push_back(fmt::format("{} % of a full stroke ({})", rounded_text(most, 2), list.key));
  }
  return join(out, ", ");
}

/// What became of the base model's free parameters that the record cannot do without.
void add_moved(const gap::Model& found, const Chain& base, const TimeRecord& record, double noise_rms,
               Measured& out, double& corner_hz) {
  const double left = error_figures(output(found.chain(), record), record.y).rms;
  for (std::size_t at = 0; at < found.size(); ++at) {
    if (!found.is_base(at)) continue;
    const Block& before = base.blocks[static_cast<std::size_t>(found.base_number(at) - 1)];
    if (has_curves_of_a_stage(before)) {
      if (std::any_of(before.parameters().begin(), before.parameters().end(),
                      [](const chain::Parameter& p) { return p.free; })) {
        out.found.push_back(fmt::format("{}: its curves are others than the project's, by up to {}",
                                        before.part, moved_curves(before, found.at(at))));
        if (std::any_of(base.blocks.begin(), base.blocks.end(),
                        [](const Block& b) { return b.parts != nullptr; }))
          out.advice +=
              "A generator that is as much off does the same: a record of the drive, or of the stage alone, tells them apart. ";
      }
      continue;
    }
    for (std::size_t k = 0; k < before.parameters().size(); ++k) {
      const chain::Parameter& p = before.parameters()[k];
      if (!p.free) continue;
      gap::Model back = found;
      back.block(found.id_at(at)).parameters()[k].value = p.value;
      if (error_figures(output(back.chain(), record), record.y).rms < kMoved * left) continue;
      const double now = found.at(at).parameters()[k].value;
      std::string words =
          fmt::format("{}: {} is {} instead of {}", before.part, gap::parameter_words(p.name()),
                      gap::parameter_text(p.name(), now), gap::parameter_text(p.name(), p.value));
      // Between samples a pole is a lag, and any other of the stage's poles is one too.
      if (const double lag_s = (1.0 / now - 1.0 / p.value) / (2.0 * std::numbers::pi);
          p.unit() == "Hz" && std::abs(lag_s) < record.step_s)
        words += fmt::format(", or another of the stage's poles: {} {} of lag",
                             engineering_text(std::abs(lag_s), "s", 3), lag_s > 0.0 ? "more" : "less");
      // Beside a name that was found a free corner takes up what that name leaves: there parts need only explain.
      const bool alone = found.size() == base.blocks.size();
      if (noise_rms > 0.0 &&
          good_parts_do_as_much(back.chain(), alone ? found.chain() : back.chain(), record, noise_rms)) {
        out.advice += "Perhaps " + words + ": parts within their tolerances do as much. ";
        continue;
      }
      out.found.push_back(words);
      if (before.part == "amplifier") corner_hz = now;
    }
  }
}

/// "after block 7" is "after block 7, stroke_m".
std::string with_names_of_blocks(std::string words, const Chain& base) {
  constexpr std::string_view kBlock = "block ";
  const std::size_t at = words.find(kBlock);
  if (at == std::string::npos) return words;
  const std::size_t digits = at + kBlock.size(), end = words.find_first_not_of("0123456789", digits);
  const auto number = static_cast<std::size_t>(std::stoul(words.substr(digits)));
  return words.insert(end, ", " + base.blocks.at(number - 1).part);
}

/// What each step of the diagnosis accuses; a part within its tolerance is not wrong. Returns the part that is, if one is.
std::string add_steps(const gap::Diagnosis& d, const Chain& base, const TimeRecord& record,
                      const Period& period, Measured& out, OutputSet& files) {
  std::string exchange;
  for (const gap::DiagnosedStep& step : d.steps) {
    const std::string sure = fmt::format(" (probability {})", rounded_text(step.among_names, 2));
    if (step.among_names < kAccused) {
      out.advice += "Perhaps " + with_names_of_blocks(gap::step_in_words(step), base) + sure + ". ";
      continue;
    }
    if (step.effect != "part_value") {
      out.found.push_back(with_names_of_blocks(gap::step_in_words(step), base) + sure);
      continue;
    }
    const std::vector<Suspect> suspects =
        suspects_of(d.search.final.chain(), base, step.part, step.parameters.front().value, record);
    if (std::any_of(suspects.begin(), suspects.end(),
                    [](const Suspect& s) { return s.within_tolerance(); })) {
      out.advice += suspects.front().words() + ": parts of their tolerances do as much. ";
      continue;
    }
    exchange = step.part;
    out.found.push_back(suspects.front().words() + (suspects.size() == 1 ? sure : ""));
    if (suspects.size() == 1) continue;
    std::vector<std::string> others;
    for (const Suspect& one : suspects) out.tied.push_back(one.part);
    for (std::size_t i = 1; i < suspects.size() && i <= 4; ++i) others.push_back(suspects[i].words());
    out.found.back() += "; or " + join(others, "; or ") +
                        (suspects.size() > 5 ? fmt::format("; or one of {} more", suspects.size() - 5) : "");
    const auto other =
        period.frequency ? separating_record(base, suspects, record, period.frequency->value) : std::nullopt;
    if (!other || noise_of(d) <= 0.0 || !(other->rms > kTells * noise_of(d))) {
      out.advice +=
          "No record of this shape tells those apart: an ohmmeter does, and a record of the stage alone. ";
      continue;
    }
    out.advice += fmt::format(
        "A record of the same shape at {} Hz tells those parts apart (measured/experiment_of_parts.csv): any two differ by {} times "
        "the noise there. ",
        rounded_text(other->frequency_hz, 4), rounded_text(other->rms / noise_of(d), 2));
    CsvWriter drive;
    std::vector<double> time;
    for (std::size_t i = 0; i < record.size(); ++i)
      time.push_back(record.time_s(i) * period.frequency->value / other->frequency_hz);
    drive.add("time_s", time);
    drive.add("u", record.u);
    files.add("experiment_of_parts.csv", drive.text());
  }
  return exchange;
}

/// Error of following u in percent of the full stroke over the last period, its best delay removed; at each instant too.
double tracking_percent(const std::vector<double>& y, const TimeRecord& record, const Period& period,
                        std::vector<double>* error) {
  const std::vector<double> r = period.of(record.u);
  const std::vector<double> got = period.of(y);
  for (std::size_t i = 0; error != nullptr && i < r.size(); ++i) error->push_back(100.0 * (got[i] - r[i]));
  return 100.0 * tracking::best_lag(got, r, record.step_s * static_cast<double>(r.size())).rms;
}

/// Displacements per full stroke; from a drive by way of the stage.
std::vector<double> in_strokes(const std::vector<double>& y, const Prediction& what, const fs::path& folder,
                               const TimeRecord& record, const Period& period) {
  Provenance aside;
  Chain stage = chain::read_model(folder / "stage.toml", aside);
  std::vector<double> out = y;
  if (what.of == "the controller") {
    set_operating(stage, period.frequency);
    TimeRecord drive = record;
    drive.u = y;
    out = output(stage, drive);
  }
  const double stroke = stage.blocks.back().get("gain");
  for (double& value : out) value /= stroke;
  return out;
}

/// The same project with the stage's amplifier as it was found.
project::ProjectSource changed(const project::ProjectSource& source, double corner_hz) {
  project::ProjectSource out = source;
  const Node value = parse_toml(fmt::format("value = {}", number_text(corner_hz)), source.file.string());
  out.document = out.document.with("plant.amplifier_corner_hz", value.at("value"));
  return out;
}

std::vector<double> percent_of(const std::vector<double>& a, const std::vector<double>& b, double range) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = 100.0 * (a[i] - b[i]) / range;
  return out;
}

}  // namespace

Measured measured_record(const project::ProjectSource& source, const fs::path& data, const fs::path& folder,
                         const gap::SearchOptions& options, OutputSet& measured, OutputSet& next) {
  Measured out;
  const TimeRecord record = TimeRecord::read_csv(data, out.from, true);
  record.require_measured_sizes();
  const Period period(record);
  const Prediction built = nearest_prediction(folder, record, period, out.from);
  out.of = built.of;
  const double range = built.gap.range;
  out.gap_percent = built.gap.rms_percent;
  const auto study = gap::Study::of(std::vector<TimeRecord>{record}, {}, built.chain);
  const auto [base, found] = diagnosed(built.chain, record, study, options);
  const double noise = noise_of(found);
  out.noise_percent = 100.0 * noise / range;
  out.verdict = gap::to_string(found.verdict);
  double corner_hz = 0.0;
  std::string exchange;
  if (!found.advice.empty()) out.advice = found.advice + " ";
  if (found.verdict != gap::Verdict::nothing_missing) {
    exchange = add_steps(found, base, record, period, out, measured);
    add_moved(found.search.final, base, record, noise, out, corner_hz);
  } else if (noise > 0.0 && out.gap_percent > kMoved * out.noise_percent) {
    out.advice += "Parts within their tolerances make as much of a difference. ";
  }
  out.advice = std::string(trim(out.advice));
  const Chain as_built = gap::found_model(found, base);
  const std::vector<double> y = output(as_built, record);
  out.left_percent = error_figures(y, record.y).rms_percent;

  CsvWriter table;
  const std::vector<double> time = record.times_s();
  table.add("time_s", time);
  table.add("u", record.u);
  table.add("measured", record.y);
  table.add("predicted", built.y);
  table.add("with_what_was_found", y);
  measured.add("comparison.csv", table.text());
  gap::add_diagnosis_files(found, study, base, out.from, measured);
  if (!out.wrong()) return out;

  GapPicture picture{"time, s",
                     false,
                     period.of(time),
                     period.of(percent_of(record.y, built.y, range)),
                     period.of(percent_of(record.y, y, range)),
                     {},
                     {},
                     "Error of tracking, % of the full stroke"};
  fs::path designed = folder;
  if (corner_hz > 0.0) {
    designed = folder / "next";
    project::run_project(changed(source, corner_hz), designed);
    out.next.push_back(fmt::format("designed again with plant.amplifier_corner_hz = {}: next/controller",
                                   rounded_text(corner_hz, 4)));
  }
  if (!exchange.empty())
    out.next.push_back(out.tied.empty()
                           ? "exchange " + exchange
                           : "exchange, or identify anew, whichever it is of " + join(out.tied, ", "));
  const std::size_t mended = (corner_hz > 0.0 ? 1U : 0U) + (exchange.empty() ? 0U : 1U);
  if (out.found.size() > mended) {
    out.next.emplace_back("what no exchange mends is to be identified from new records and designed again");
  } else if (built.of != "the stage") {
    Prediction again = built;
    Provenance aside;
    again.chain = chain::read_model(designed / "model.toml", aside);
    if (built.of == "the controller")
      again.chain.blocks.erase(again.chain.blocks.begin() + 1, again.chain.blocks.end());
    set_operating(again.chain, period.frequency);
    out.next_name = "tracking_percent";
    out.before_percent = tracking_percent(in_strokes(record.y, built, folder, record, period), record, period,
                                          &picture.before);
    out.after_percent =
        tracking_percent(in_strokes(output(again.chain, record), built, designed, record, period), record,
                         period, &picture.after);
    out.next.push_back(fmt::format("tracking {} -> {} % rms predicted (delay removed)",
                                   rounded_text(out.before_percent, 3), rounded_text(out.after_percent, 3)));
  }
  next.add("as_built.toml", chain::model_text(as_built, "what was built, as " + data.string() + " shows it"));
  next.add("gap.svg", picture.svg());
  return out;
}

}  // namespace bodesmith::measured
