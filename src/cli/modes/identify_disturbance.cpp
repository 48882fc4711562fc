#include <fmt/format.h>

#include <string>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "identify/stage_disturbance.hpp"

namespace bodesmith::cli {
namespace {

using identify::GainReading;
using identify::LoopAtFrequency;
using identify::StageDisturbance;

std::string polynomial_line(const char* name, const std::array<double, 3>& a) {
  return fmt::format("  {:<11} {} x {:+.4g} x^2 {:+.4g} x^3\n", name, rounded_text(a[0]), a[1], a[2]);
}

std::string disturbance_summary(const StageDisturbance& study) {
  const LoopAtFrequency& base = study.loops.front();
  std::string text = fmt::format("y = {} + {} (x + d(x)), x from 0 to 1 as the input goes from {} to {}\n",
                                 rounded_text(base.offset), rounded_text(base.stroke),
                                 rounded_text(-study.input.offset / study.input.gain),
                                 rounded_text((1.0 - study.input.offset) / study.input.gain));
  text += polynomial_line("ascending", study.disturbance.ascending);
  text += polynomial_line("descending", study.disturbance.descending);
  text += study.lag.kind == identify::StageLag::Kind::none
              ? "lag: none that the records show\n"
              : fmt::format("lag: {} of {} +- {} s\n", to_string(study.lag.kind),
                            rounded_text(study.lag.seconds), rounded_text(study.lag.deviation_s, 2));
  text += fmt::format("gains by {}; errors over held-out turns, rms in % of the stroke\n",
                      study.reading == GainReading::as_printed ? "eq. 13 as printed"
                                                               : "p_i = K p_1 (eq. 13 the other way round)");
  text += fmt::format("{:>10} {:>20} {:>20} {:>9} {:>10} {:>7} {:>5}\n", "Hz", "ascending", "descending",
                      "own poly.", "base x K", "printed", "turns");
  for (const LoopAtFrequency& one : study.loops) {
    const auto gain = [&](std::size_t b) {
      return fmt::format("{:.4f} +- {:.2g}", study.gain(one)[b], one.deviation[b]);
    };
    text +=
        fmt::format("{:>10} {:>20} {:>20} {:>9} {:>10} {:>7} {:>3}+{}\n", rounded_text(one.frequency.value),
                    gain(0), gain(1), rounded_text(one.own_percent, 3), rounded_text(one.gain_percent, 3),
                    rounded_text(one.as_printed_percent, 3), one.training_turns, one.held_out_turns);
  }
  for (const identify::LoopAtStroke& one : study.strokes)
    text += fmt::format(
        "  stroke {}: alpha_1 {:.4f} +- {:.2g}, alpha_2 {:.4f} +- {:.2g}; on one line with the full one: {} %\n",
        rounded_text(one.alpha), one.gain[0], one.deviation[0], one.gain[1], one.deviation[1],
        rounded_text(one.line_percent, 3));
  return text;
}

std::optional<GainReading> reading_wanted(const CommandLine& line) {
  const std::string word = line.get<std::string>("gain-reading");
  if (word == "best") return std::nullopt;
  if (word == "basis-times-gain") return GainReading::basis_times_gain;
  if (word == "as-printed") return GainReading::as_printed;
  line.fail(fmt::format("--gain-reading is '{}', expected best, basis-times-gain or as-printed", word));
}

}  // namespace

void add_disturbance_options(CommandLine& line) {
  line.group("A stage's disturbance, from full strokes at several frequencies (instead of --model)");
  line.option<std::string>("disturbance",
                           "file for polynomials and gains, which layout, controller, fit and run take");
  line.option<std::string>("gains", "file for frequency_hz,gain of the branch that varies");
  line.option<std::string>("gain-reading", "eq. 13: best (on held-out turns), basis-times-gain or as-printed",
                           "best");
  line.words("gain-reading", {"best", "basis-times-gain", "as-printed"});
}

int identify_disturbance_mode(const CommandLine& line) {
  for (const char* option : {"model", "holdout", "output"})
    if (line.has(option))
      line.fail(
          fmt::format("--{} does not go with --disturbance, which holds out every second turn", option));
  const std::optional<GainReading> reading = reading_wanted(line);
  const auto limit = line.maybe_positive("max-error-percent");
  Provenance from = line.new_provenance();
  std::vector<TimeRecord> records;
  for (const std::string& file : line.files()) records.push_back(TimeRecord::read_csv(file, from, true));
  const Stopwatch watch;
  const StageDisturbance study = identify::identify_disturbance(records, reading);
  const double seconds = watch.seconds();

  OutputSet files;
  Json document = timed_document("disturbance", from, study.to_json(), seconds);
  files.add(line.get<std::string>("disturbance"), to_text(document));
  if (line.has("gains")) {
    if (study.disturbance.rate.frequency.empty())
      line.fail("--gains needs records of two frequencies at least");
    files.add(line.get<std::string>("gains"), study.gains_csv());
  }
  line.refuse_unread();  // there is no -o before which it is asked
  files.commit();
  for (const std::string& one : study.notes) note(one);

  Json json = timed_document("disturbance_identification", from, study.to_json(), seconds);
  bool met = true;
  std::string text = disturbance_summary(study);
  if (limit) {
    for (const LoopAtFrequency& one : study.loops)
      met = met &&
            (study.reading == GainReading::as_printed ? one.as_printed_percent : one.gain_percent) <= *limit;
    json["limit_met"] = met;
    if (!met) text += limit_not_met(*limit, "%");
  }
  return print_summary(line, text, json, met);
}

}  // namespace bodesmith::cli
