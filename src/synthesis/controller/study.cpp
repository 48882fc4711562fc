#include "synthesis/controller/study.hpp"

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::generator {
namespace {

/// Over the time between the instants, which lie close where v moves fast.
double rms_in_time_percent(const std::vector<double>& t, const std::vector<double>& a,
                           const std::vector<double>& b, double range) {
  double sum = 0.0, total = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double before = a[i - 1] - b[i - 1], now = a[i] - b[i], dt = t[i] - t[i - 1];
    sum += dt * (before * before + before * now + now * now) / 3.0;
    total += dt;
  }
  return total > 0.0 ? 100.0 * std::sqrt(sum / total) / range : 0.0;
}

}  // namespace

BothEngines run_in_both(const DisturbanceCircuit& controller, const tracking::Reference& reference,
                        Hertz operating, const NgspiceRun& options) {
  SteadyState ngspice = run_in_ngspice(controller, reference, operating, options);
  SteadyState cvode = run_in_cvode(controller, reference, operating, ngspice.v.size(), ngspice.own_s);
  const double difference = rms_in_time_percent(ngspice.own_s, ngspice.own_v, cvode.own_v, reference.alpha());
  return {std::move(ngspice), std::move(cvode), difference};
}

std::vector<AsBuilt> measure_as_built(const DisturbanceCircuit& controller,
                                      const std::vector<Hertz>& frequencies,
                                      const tracking::Reference& reference) {
  std::vector<AsBuilt> out;
  for (const Hertz f : frequencies) {
    const BothEngines both = run_in_both(controller, reference, f, {});
    const SteadyState& run = both.ngspice;
    AsBuilt one;
    one.frequency = f;
    one.error = stage_error(controller, run);
    SteadyState plain = run;
    plain.v = run.r;
    one.without = stage_error(controller, plain);
    one.cvode_difference_percent = both.difference_percent;
    one.start_up_percent = 100.0 * error_figures(run.first_v, run.v).rms / reference.alpha();
    one.wall_s = run.wall_s;
    out.push_back(one);
  }
  return out;
}

std::vector<AsBuilt> predict_as_built(const DisturbanceCircuit& controller,
                                      const tracking::Reference& reference) {
  std::vector<AsBuilt> out(controller.tracked.size());
  parallel_for(out.size(), thread_count(0), [&](std::size_t i) {
    SteadyState run = run_in_cvode(controller, reference, controller.tracked[i],
                                   NgspiceRun().samples * reference.periods());
    out[i].frequency = controller.tracked[i];
    out[i].error = stage_error(controller, run);
    run.v = run.r;
    out[i].without = stage_error(controller, run);
  });
  return out;
}

double worst_percent(const std::vector<AsBuilt>& cases) {
  double out = 0.0;
  for (const AsBuilt& one : cases) out = std::max(out, one.error.rms_percent_without_lag);
  return out;
}

Json to_json(const std::vector<AsBuilt>& cases) {
  Json out = Json::array();
  for (const AsBuilt& one : cases) {
    out.push_back({{"frequency_hz", one.frequency.value},
                   {"rms_percent", one.error.rms_percent},
                   {"rms_percent_without_lag", one.error.rms_percent_without_lag},
                   {"max_percent", one.error.max_percent},
                   {"lag_s", one.error.lag_s},
                   {"none_rms_percent", one.without.rms_percent},
                   {"cvode_difference_percent", one.cvode_difference_percent},
                   {"start_up_percent", one.start_up_percent},
                   {"ngspice_s", one.wall_s}});
  }
  return out;
}

}  // namespace bodesmith::generator
