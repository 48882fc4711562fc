#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "gap/diagnosis.hpp"

namespace bodesmith::gap {
namespace {

/// The experiments that would tell a step's tied effects apart.
std::string experiments_for(const DiagnosedStep& step) {
  std::string text =
      fmt::format("These records cannot tell {} from {}; what would: {}", step.effect,
                  join(step.tied_with, ", "), effect_registry().get(step.effect).facts().experiment);
  for (const auto& tied : step.tied_with) {
    const std::string other(effect_registry().get(tied).facts().experiment);
    if (text.find(other) == std::string::npos) text += "; " + other;
  }
  return text + ".";
}

double log_odds_against(const Ranked& r, const Diagnosis& d) {
  return d.search.log_evidence - r.log_evidence;
}

/// The refused effect that would take most, where nothing but its evidence speaks against it, and that by less than a name that ties: under a gap as slow as what
/// the effect does, one record alone cannot tell it from chance.
const Ranked* likeliest_refused(const Diagnosis& d) {
  for (const Ranked& r : d.search.refused) {
    if (r.outcome != CandidateOutcome::not_judged || !(log_odds_against(r, d) < -std::log(kTied))) continue;
    if (r.holdout_rms < d.final.holdout_rms) return &r;
  }
  return nullptr;
}

std::string as_likeliest(const Ranked& r, const Diagnosis& d) {
  return fmt::format(
      "likeliest, at odds of {:.2g} to 1 against: {} ({}), which would leave {:.4g} rms of {:.4g} and {:.4g} of {:.4g} held out; "
      "a longer record or another one could make it sure",
      std::exp(std::max(0.0, log_odds_against(r, d))), r.effect->told(), r.placed, r.train_rms,
      d.final.train_rms, r.holdout_rms, d.final.holdout_rms);
}

std::string what_remains(const Diagnosis& d) {
  const Ranked* likeliest = likeliest_refused(d);
  std::string text = fmt::format("Something{} is missing that no effect of the catalogue explains{}",
                                 d.steps.empty() ? "" : " else", likeliest != nullptr ? " for sure" : "");
  if (!d.remaining_where.empty()) text += "; look at " + to_text(d.remaining_where.front());
  if (likeliest != nullptr) text += "; " + as_likeliest(*likeliest, d);
  return text + ".";
}

}  // namespace

std::string advice_for(const Diagnosis& d, const Study& study) {
  std::vector<std::string> advice;
  for (const auto& step : d.steps) {
    if (!step.tied_with.empty()) advice.push_back(experiments_for(step));
  }
  if (d.search.initial.free_count() == 0) {
    advice.emplace_back(
        "Nothing is free to refit in the model: a value of it that is off shows as an effect (free in model.toml names "
        "those that may be).");
  }
  if (d.start) advice.push_back(to_text(*d.start));
  if (d.amplitude) advice.push_back(to_text(*d.amplitude));
  if (d.verdict == Verdict::unexplained || d.verdict == Verdict::partly_explained) {
    advice.push_back(what_remains(d));
  } else if (const Ranked* likeliest = likeliest_refused(d);
             d.verdict != Verdict::interrupted && likeliest != nullptr) {
    advice.push_back(fmt::format("Nothing{} is surely missing; {}.", d.steps.empty() ? "" : " else",
                                 as_likeliest(*likeliest, d)));
  }
  for (const auto& offset : d.constant_offsets) advice.push_back(to_text(offset));
  if (d.floor.source == NoiseFloor::Source::unknown && !study.frequency_responses()) {
    advice.emplace_back(
        "The noise floor is unknown: record at least two periods of a repeating input to know it.");
  }
  if (study.split()) {
    advice.emplace_back(
        "Nothing was held out, so a part of the same records was: a record with another excitation would "
        "prove more.");
  }
  if (!d.search.not_tried.empty()) {
    advice.push_back("The time was over before these were tried: " + join(d.search.not_tried, ", ") + ".");
  } else if (d.search.late) {
    advice.emplace_back("The time was over before the search had ended: this is the best so far.");
  }
  if (d.search.stopped)
    advice.emplace_back("The search was stopped before its end: this is the best so far.");
  if (d.next_experiment) {
    advice.push_back(fmt::format(
        "experiment.csv holds the drive that would tell {} apart ({}; difference to expect: {:.1f} times what is left).",
        join(d.next_experiment->rivals, " and "), d.next_experiment->shape,
        d.next_experiment->difference_over_noise));
  }
  if (d.holdout_disagrees) {
    advice.emplace_back(
        d.steps.empty()
            ? "The held-out records disagree: something acts in them that the training records do not show; train on one of them, too."
        : std::isfinite(d.final.holdout_rms)
            ? "The held-out records disagree: what was found on the training records serves them badly."
            : "The held-out records disagree: on them the extended model's output grows without bound.");
  }
  for (const auto& note : d.search.notes) advice.push_back(note + ".");
  return join(advice, " ");
}

}  // namespace bodesmith::gap
