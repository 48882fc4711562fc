#include "gap/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "gap/evidence/names.hpp"
#include "gap/runner.hpp"
#include "gap/search/beam.hpp"
#include "gap/search/record_starts.hpp"
#include "gap/search/remaining.hpp"
#include "gap/search/stretches.hpp"

namespace bodesmith::gap {
namespace {

/// The base model with its own freedom used: what its free parameters can explain is not missing. As given when it cannot be run.
Model refit_base(const SearchSetting& setting, const SearchRecords& records, const Model& given) {
  auto fitted = fit_in_turn(setting, records, given);
  return fitted.usable() ? std::move(fitted.model) : given;
}

/// The names one after the other, each with what it was chosen from.
std::vector<Step> steps_of(const SearchSetting& setting, Beam& beam) {
  Model model = beam.best.model;
  std::vector<Step> steps(model.terms().size());
  for (std::size_t k = steps.size(); k-- > 0;) {
    Step& step = steps[k];
    step.effect = model.terms()[k].effect;
    step.placed = model.terms()[k].placed;
    step.after = model;
    step.ranking = std::move(beam.best.rivals[k].ranking);
    step.log_evidence_without = beam.best.rivals[k].log_evidence_without;
    judge_ranking(step);
    model.remove(k);
    if (k > 0 && !setting.options.stopped())
      model = fit_in_turn(setting, beam.records, std::move(model)).model;
  }
  return steps;
}

}  // namespace

SearchResult search(const chain::Chain& base, const Experiments& train, const SearchOptions& given) {
  SearchOptions options = given;
  SearchResult result;
  result.initial = Model(base);
  result.initial.set_signal_size(largest_range(train));
  SearchSetting setting{options};
  Beam beam;
  SearchRecords& records = beam.records;
  records = make_records(train, result.initial);
  Model model = refit_base(setting, records, result.initial);
  // A second time, as values far off may still be on their way.
  if (leave_out_wrong_starts(records, model))
    model = fit_in_turn(setting, records, refit_base(setting, records, result.initial)).model;
  records.stretches = stretches_of(records.train, model);
  result.base = model;
  setting.first_gap = rms_of(model, records.train);
  beam.best.model = std::move(model);
  search_sets(setting, beam);
  result.stopped = options.stopped();
  result.late = options.is_late();
  result.steps = steps_of(setting, beam);
  result.refused = std::move(beam.refused);
  result.not_tried = std::move(beam.not_tried);
  result.floor = floor_under(beam.best.model, records);
  result.holds = holds_of(records.train);
  result.train_rms = beam.best.train_rms;
  result.log_evidence = beam.best.log_evidence;
  if (!result.stopped) result.structure = signs_left(beam.best.model, records);
  result.final = std::move(beam.best.model);
  result.notes = std::move(beam.best.notes);
  if (beam.smooth_input)
    result.notes.emplace_back(
        "The input goes in a curve between the samples, where a model takes it as straight: the first resonator of "
        "model.toml, at 0.55 of the sampling rate, stands for that and is no effect");
  options.report(1.0);
  return result;
}

}  // namespace bodesmith::gap
