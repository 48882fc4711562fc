// approximate_fractional: a transfer function of fractional powers to sections.
#include "base/progress.hpp"
#include "functions.hpp"
#include "project/design/fractional_fit.hpp"

namespace bodesmith::python {

Answer approximate_fractional(const Call& call) {
  const Node& o = call.options;
  o.allow_only(
      {"transfer", "band_hz", "order", "max_error_db", "max_order", "real", "keep_integrator", "seed"});
  const FractionalTransfer transfer = FractionalTransfer::from_node(o.at("transfer"));
  project::FractionalFitOptions options;
  const std::optional<Band> band = maybe_band(o);
  if (!band) o.fail("has no band_hz, the band it is approximated over");
  options.band = *band;
  if (o.has("order")) options.order = integer_or(o, "order", 4, 1, 12);
  options.max_error_db = maybe_positive(o, "max_error_db");
  options.max_order = integer_or(o, "max_order", options.max_order, 1, 12);
  options.direct.real = o.boolean_or("real", false);
  options.keep_integrator = o.boolean_or("keep_integrator", false);
  options.direct.seed = seed_of(o);
  const Stopwatch watch;
  const project::FractionalFit made = project::fit_fractional(transfer, "the transfer function", options);
  Json body = made.fit.sections.to_json();
  body["approximation"] = made.report_json();
  Answer out;
  out.result = document("sections", body, watch.seconds());
  out.warnings = made.fit.warnings;
  if (!made.within(options.max_error_db)) out.warnings.push_back("the limit of max_error_db is not met");
  return out;
}

}  // namespace bodesmith::python
