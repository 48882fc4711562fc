// fit: to points, to a measured response, to a disturbance's waveform.
#include "approximate/approximate.hpp"
#include "approximate/merge_sections.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/direct/direct_fit.hpp"
#include "fit/measured/measured_fit.hpp"
#include "fit/waveform/waveform_fit.hpp"
#include "functions.hpp"
#include "lti/section_making.hpp"
#include "records.hpp"

namespace bodesmith::python {

Answer fit_cascade(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"base_hz", "beta_max", "beta_positive", "fewest_bands_db", "surprise_db"});
  CascadeFitOptions options;
  if (const auto base = maybe_positive(o, "base_hz")) options.base = Hertz{*base};
  options.beta_max = maybe_positive(o, "beta_max");
  options.beta_positive = o.boolean_or("beta_positive", false);
  if (options.beta_positive && !options.beta_max) o.at("beta_positive").fail("needs beta_max");
  options.fewest_bands_db = maybe_positive(o, "fewest_bands_db");
  options.surprise_db = positive_or(o, "surprise_db", options.surprise_db);
  const Stopwatch watch;
  const CascadeFit fit = bodesmith::fit_cascade(points_of(call), options);
  Answer out;
  out.result = document("cascade", fit.to_json(), watch.seconds());
  out.warnings = fit.warnings;
  return out;
}

Answer fit_direct(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"order", "max_error_db", "real", "least_squares", "relative_degree", "use_phase",
                "max_corner_hz", "min_damping", "seed"});
  DirectFitOptions options;
  options.real = o.boolean_or("real", false);
  options.least_squares = o.boolean_or("least_squares", false);
  options.relative_degree = integer_or(o, "relative_degree", 0, 0, 12);
  options.use_phase = o.boolean_or("use_phase", false);
  options.min_damping = positive_or(o, "min_damping", options.min_damping);
  options.seed = seed_of(o);
  if (const auto corner = maybe_positive(o, "max_corner_hz")) options.max_corner = Hertz{*corner};
  if (call.has_array("gain_upper")) options.upper = points_of(call, "_upper");
  if (call.has_array("gain_lower")) options.lower = points_of(call, "_lower");
  const auto limit = maybe_positive(o, "max_error_db");
  if (!o.has("order") && !limit) throw InputError("neither order nor max_error_db is given");
  options.order = integer_or(o, "order", options.order, 1, 12);
  const BodePoints points = points_of(call);
  const Stopwatch watch;
  const DirectFit fit =
      o.has("order") ? fit_directly(points, options)
                     : fit_directly_within(points, options, *limit, std::max(1, options.relative_degree), 12);
  Json body = fit.sections.to_json();
  body["fit"] = fit.report_json();
  if (limit) body["fit"]["limit_met"] = fit.max_db <= *limit;
  Answer out;
  out.result = document("sections", body, watch.seconds());
  out.warnings = fit.warnings;
  return out;
}

Answer fit_measured(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"order", "max_order", "delay"});
  MeasuredFitOptions options;
  if (o.has("order")) options.order = integer_or(o, "order", 1, 1, 60);
  options.max_order = integer_or(o, "max_order", options.max_order, 1, 60);
  options.delay = o.boolean_or("delay", true);
  const FrequencyRecord record = response_of(call);
  const Stopwatch watch;
  const MeasuredFit fit = bodesmith::fit_measured(record, options);
  Json body = fit.sections.to_json();
  body["fit"] = fit.report_json();
  Answer out;
  out.result = document("sections", body, watch.seconds());
  out.warnings = fit.warnings;
  return out;
}

Answer fit_waveform(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"disturbance", "order", "norm", "branch", "operating_hz", "seed"});
  const Disturbance disturbance = Disturbance::from_node(o.at("disturbance"));
  WaveformFitOptions options;
  options.order = integer_or(o, "order", options.order, 1, 6);
  options.seed = seed_of(o);
  options.worst = o.has("norm") && o.at("norm").one_of({"rms", "worst"}) == "worst";
  options.path = o.has("branch")
                     ? choice(o, "branch", {DrivenPath::whole, DrivenPath::ascending, DrivenPath::descending})
                     : path_to_compensate(disturbance);
  if (o.has("operating_hz")) {
    for (const Node& f : o.at("operating_hz").items()) options.operating.push_back(Hertz{f.positive()});
  }
  const Stopwatch watch;
  const WaveformFit fit = bodesmith::fit_waveform(disturbance, options);
  Json report = {{"branch", to_string(options.path)}, {"norm", options.worst ? "worst" : "rms"}};
  report.update(fit.report_json());
  Json body = fit.sections.to_json();
  body["waveform_fit"] = report;
  Answer out;
  out.result = document("sections", body, watch.seconds());
  out.warnings = fit.warnings;
  return out;
}

Answer approximate(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"cascade", "method", "order", "max_error_db", "max_order", "over_band", "complex", "merge_db",
                "biquads", "arrange"});
  const Cascade cascade = Cascade::from_node(o.at("cascade"));
  ApproximationOptions options;
  options.method = o.string_or("method", options.method);
  (void)method_registry().get(options.method);
  if (o.has("order")) options.order = integer_or(o, "order", 4, 1, 40);
  options.max_error_db = maybe_positive(o, "max_error_db");
  if (options.order && options.max_error_db) o.at("order").fail("cannot be combined with max_error_db");
  options.max_order = integer_or(o, "max_order", options.max_order, 1, 40);
  options.over_band = o.boolean_or("over_band", false);
  options.real_roots = !o.boolean_or("complex", false);
  const Stopwatch watch;
  CascadeApproximation result = approximate_cascade(cascade, options);
  Json arrangement;
  std::optional<int> left_out;
  if (const auto limit = maybe_positive(o, "merge_db")) {
    const MergedSections merged = merge_sections(result.sections, cascade, *limit);
    result.sections = merged.sections;
    result.error = merged.error;
    left_out = merged.pairs_left_out;
  }
  if (o.boolean_or("biquads", false)) result.sections = as_biquads(result.sections);
  if (o.boolean_or("arrange", false)) {
    const OrderedSections ordered = order_sections(result.sections, result.error.band);
    result.sections = ordered.sections;
    arrangement = {{"span_before_db", ordered.span_before_db},
                   {"span_after_db", ordered.span_after_db},
                   {"exhaustive", ordered.exhaustive}};
  }
  Json body = result.sections.to_json();
  body["approximation"] = result.report_json();
  if (!arrangement.is_null()) body["arrangement"] = arrangement;
  if (left_out) body["pairs_left_out"] = *left_out;
  Answer out;
  out.result = document("sections", body, watch.seconds());
  if (!result.limit_met()) out.warnings.push_back("the limit of max_error_db is not met");
  return out;
}

}  // namespace bodesmith::python
