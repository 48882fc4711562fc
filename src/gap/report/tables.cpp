#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "gap/report/figures.hpp"
#include "gap/report/words.hpp"

namespace bodesmith::gap {
namespace {

std::string percent_text(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

std::vector<std::string> size_row(const Diagnosis& d, std::string model, const GapSize& size,
                                  std::string runner_up) {
  std::vector<std::string> row = {std::move(model), rms_text(d, size.train_rms),
                                  rms_text(d, size.holdout_rms)};
  // Of a response the rms itself is in percent.
  if (!d.relative) row.push_back(fmt::format("{:.3f}", size.holdout_percent_of_range));
  row.push_back(std::move(runner_up));
  return row;
}

}  // namespace

std::string figure_text(double value) {
  return rounded_text(value, 4);
}

report::Table steps_table(const Diagnosis& d) {
  report::Table t;
  t.head = {"model", "training rms", "held-out rms"};
  if (!d.relative) t.head.emplace_back("held-out, % of range");
  t.head.emplace_back("runner-up (held-out rms)");
  t.rows.push_back(size_row(d, "as given", d.initial, ""));
  t.rows.push_back(size_row(d, "free parameters refitted", d.refitted, ""));
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    const auto& s = d.steps[k];
    const std::string ties = s.tied_with.empty() ? "" : " (or " + join(s.tied_with, ", ") + ")";
    const Ranked* r = runner_up_of(d.search.steps[k]);
    const std::string rival =
        r == nullptr ? "" : fmt::format("{} ({})", r->effect->told(), rms_text(d, r->holdout_rms));
    t.rows.push_back(size_row(d, "+ " + s.effect + ties, s.after, rival));
  }
  return t;
}

report::Table cells_table(const std::vector<Cell>& cells) {
  report::Table t;
  t.head = {"axis", "from", "to", "share of the gap", "share of the record"};
  for (const auto& c : cells) {
    t.rows.push_back({words_of(c.axis).heading, figure_text(c.from), figure_text(c.to), percent_text(c.share),
                      percent_text(c.extent)});
  }
  return t;
}

report::Table parameters_table(const Diagnosis& d) {
  report::Table t;
  t.head = {"effect", "placed", "parameter", "value", "from", "to"};
  for (const auto& s : d.steps) {
    for (const auto& p : s.parameters) {
      t.rows.push_back({s.effect, s.placed, parameter_words(p.name), parameter_text(p.name, p.value),
                        parameter_text(p.name, p.low), parameter_text(p.name, p.high)});
    }
  }
  return t;
}

report::Table ranking_table(const std::vector<Ranked>& ranking, bool relative) {
  const auto rms = [relative](double value) { return relative ? percent_text(value) : figure_text(value); };
  report::Table t;
  t.head = {"effect",       "placed",       "unknowns",     "predicted",
            "training rms", "held-out rms", "log evidence", "outcome"};
  for (const auto& r : ranking) {
    if (r.outcome == CandidateOutcome::named) t.marked.push_back(t.rows.size());
    t.rows.push_back({std::string(r.effect->told()), r.placed,
                      std::to_string(r.model.terms().back().unknowns.size()), percent_text(r.score),
                      rms(r.train_rms), rms(r.holdout_rms),
                      std::isfinite(r.log_evidence) ? fmt::format("{:.1f}", r.log_evidence) : "far behind",
                      to_string(r.outcome)});
  }
  return t;
}

}  // namespace bodesmith::gap
