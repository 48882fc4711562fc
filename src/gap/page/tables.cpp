#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "gap/page/figures.hpp"

namespace bodesmith::gap {
namespace {

/// Significances above this are all alike to a reader.
constexpr double kMaxShown = 9999.0;

std::string percent_text(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

std::vector<std::string> size_row(std::string model, const GapSize& size, std::string runner_up) {
  return {std::move(model), figure_text(size.train_rms), figure_text(size.holdout_rms),
          fmt::format("{:.3f}", size.holdout_percent_of_range), std::move(runner_up)};
}

}  // namespace

std::string figure_text(double value) {
  return rounded_text(value, 4);
}

report::Table steps_table(const Diagnosis& d) {
  report::Table t;
  t.head = {"model", "training rms", "held-out rms", "held-out, % of range", "runner-up (held-out rms)"};
  t.rows.push_back(size_row("as given", d.initial, ""));
  t.rows.push_back(size_row("free parameters refitted", d.refitted, ""));
  for (const auto& s : d.steps) {
    const std::string ties = s.tied_with.empty() ? "" : " (or " + join(s.tied_with, ", ") + ")";
    const std::string rival = s.runner_up.effect.empty() ? ""
                                                         : fmt::format("{} ({})", s.runner_up.effect,
                                                                       figure_text(s.runner_up.holdout_rms));
    t.rows.push_back(size_row("+ " + s.effect + ties, s.after, rival));
  }
  return t;
}

report::Table cells_table(const std::vector<Cell>& cells) {
  report::Table t;
  t.head = {"axis", "from", "to", "share of the gap", "share of the record"};
  for (const auto& c : cells) {
    t.rows.push_back({to_string(c.axis), figure_text(c.from), figure_text(c.to), percent_text(c.share),
                      percent_text(c.extent)});
  }
  return t;
}

report::Table ranking_table(const std::vector<Ranked>& ranking) {
  report::Table t;
  t.head = {"effect",       "placed",       "unknowns",     "predicted",
            "training rms", "held-out rms", "significance", "outcome"};
  for (const auto& r : ranking) {
    if (r.outcome == CandidateOutcome::named) t.marked.push_back(t.rows.size());
    t.rows.push_back({std::string(r.effect->name()), r.placed, std::to_string(r.unknowns),
                      percent_text(r.score), figure_text(r.train_rms), figure_text(r.holdout_rms),
                      fmt::format("{:.1f}", std::min(r.z, kMaxShown)), to_string(r.outcome)});
  }
  return t;
}

}  // namespace bodesmith::gap
