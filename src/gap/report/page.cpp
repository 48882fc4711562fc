#include "gap/report/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "gap/report/figures.hpp"
#include "gap/report/words.hpp"

namespace bodesmith::gap {
namespace {

std::string sentence(Verdict verdict) {
  constexpr std::array kSentences = {
      "What was missing has been found: nothing but noise seems to be left.",
      "Part of what was missing has been found, and more is left that the catalogue does not explain.",
      "Nothing is missing that these records can show: what the model leaves is noise.",
      "Something is missing, and no effect of the catalogue explains it. No name is given rather than a wrong one.",
      "The search was stopped before its end: this is what it had found, and no judgement."};
  return kSentences.at(static_cast<std::size_t>(verdict));
}

/// "partly explained".
std::string in_words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string subtitle(const Diagnosis& d) {
  std::vector<std::string> named;
  for (const auto& s : d.steps) named.push_back(s.effect);
  return named.empty() ? in_words(to_string(d.verdict))
                       : in_words(to_string(d.verdict)) + ": " + join(named, ", ");
}

void add_verdict(report::Page& page, const Diagnosis& d) {
  page.chapter("Verdict");
  page.paragraph(sentence(d.verdict));
  const double closed =
      d.refitted.holdout_rms > 0.0 ? 100.0 * (1.0 - d.final.holdout_rms / d.refitted.holdout_rms) : 0.0;
  const bool floor_known = d.floor.source != NoiseFloor::Source::unknown;
  page.key_figures(
      {{in_words(to_string(d.verdict)), "verdict"},
       {rms_text(d, d.refitted.holdout_rms), "held-out rms, base model refitted"},
       {rms_text(d, d.final.holdout_rms), "held-out rms, extended model"},
       {std::isfinite(closed) ? fmt::format("{:.1f} %", closed) : "none", "of the held-out rms removed"},
       {floor_known ? rms_text(d, d.floor.rms) : "unknown",
        floor_known ? "noise floor (" + in_words(to_string(d.floor.source)) + ")" : "noise floor"}});
  for (const auto& s : d.steps) page.paragraph(step_in_words(s));
  page.paragraph(rms_unit_sentence(d));
  if (!d.advice.empty()) page.warning(d.advice);
}

void add_steps(report::Page& page, const Diagnosis& d) {
  page.chapter("The gap, step by step");
  page.table(steps_table(d), "Each figure is what `bodesmith simulate` finds with the model of that row.");
  if (d.steps.empty()) return;
  add_ladder_figure(page, d);
  page.table(parameters_table(d),
             "What was found, each value with twice its standard deviation to both sides.");
}

void add_where(report::Page& page, const Diagnosis& d) {
  page.chapter("Where the gap lies");
  page.table(cells_table(d.where), "The model as given: where the gap is densest on each axis.");
  page.table(cells_table(d.remaining_where), "The extended model: where what remains is densest.");
  if (d.floor.source != NoiseFloor::Source::periods) return;
  page.paragraph(fmt::format(
      "From {} periods: noise {} rms; what repeats of the final residual is {} in odd and {} in even harmonics.",
      d.floor.periods, figure_text(d.floor.rms), figure_text(d.floor.odd_rms),
      figure_text(d.floor.even_rms)));
}

void add_candidates(report::Page& page, const Diagnosis& d) {
  const SearchResult& search = d.search;
  page.chapter("The candidates");
  for (std::size_t k = 0; k < search.steps.size(); ++k) {
    const Step& step = search.steps[k];
    page.table(ranking_table(step.ranking, d.relative),
               fmt::format("{}: what it was chosen from, alongside the others.", step.effect->told()));
  }
  if (!search.refused.empty())
    page.table(ranking_table(search.refused, d.relative), "Last round: none was worth its name.");
  for (const auto& s : search.structure) {
    page.paragraph(
        fmt::format("Sign of more: {} ({:.1f} times what chance reaches).", to_string(s.kind), s.strength));
  }
}

}  // namespace

std::string report_page(const Diagnosis& d, const Study& study) {
  report::Page page("What the model is missing", subtitle(d));
  add_verdict(page, d);
  add_steps(page, d);
  add_where(page, d);
  page.chapter("Before and after");
  for (const auto& experiment : study.holdout())
    std::visit([&](const auto& e) { add_record_figures(page, d, e); }, experiment);
  add_candidates(page, d);
  page.chapter("The extended model");
  page.listing(chain::model_text(d.search.final.chain()));
  return page.html();
}

}  // namespace bodesmith::gap
