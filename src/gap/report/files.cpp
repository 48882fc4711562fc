#include "gap/report/files.hpp"

#include <cmath>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"

namespace bodesmith::gap {

chain::Chain found_model(const Diagnosis& diagnosis, const chain::Chain& base) {
  chain::Chain out = diagnosis.search.final.chain();
  out.trained = base.trained;
  if (!out.trained || diagnosis.relative) return out;
  chain::Trained& trained = *out.trained;
  if (trained.training_rms > 0.0)
    trained.training_percent *= diagnosis.final.train_rms / trained.training_rms;
  trained.training_rms = diagnosis.final.train_rms;
  if (!std::isfinite(diagnosis.final.holdout_rms)) {
    trained.holdout_rms.reset();
    trained.holdout_percent.reset();
    return out;
  }
  trained.holdout_rms = diagnosis.final.holdout_rms;
  trained.holdout_percent = diagnosis.final.holdout_percent_of_range;
  return out;
}

Json add_diagnosis_files(const Diagnosis& diagnosis, const Study& study, const chain::Chain& base,
                         const Provenance& from, OutputSet& files) {
  Json json = json_header("diagnosis", from);
  json.update(to_json(diagnosis));
  json["timing_s"] = {{"compute", diagnosis.compute_s}};
  files.add("diagnosis.json", bodesmith::to_text(json));
  std::vector<std::string> found;
  for (const auto& s : diagnosis.steps) found.push_back(s.effect + " " + s.placed);
  files.add("model.toml",
            chain::model_text(found_model(diagnosis, base),
                              "The base model, refitted, with what diagnose found: " +
                                  (found.empty() ? std::string("nothing") : join(found, ", ")) + "."));
  files.add("base_refitted.toml", chain::model_text(diagnosis.search.base.chain(),
                                                    "The base model with its free parameters refitted."));
  files.add("report.html", report_page(diagnosis, study));
  if (diagnosis.next_experiment) files.add("experiment.csv", to_csv(*diagnosis.next_experiment));
  return json;
}

}  // namespace bodesmith::gap
