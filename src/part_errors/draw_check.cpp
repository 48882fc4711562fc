#include "part_errors/draw_check.hpp"

#include <cmath>

#include "controller/as_built.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::part_errors {

std::vector<DrawCheck> check_draws(const controller::AnalogController& controller,
                                   const tracking::Stage& stage, const StudyOptions& options, int count) {
  const Bench bench(controller, stage, options);
  const std::vector<Cause> causes = causes_of(controller, options.errors);
  std::vector<DrawCheck> out(static_cast<std::size_t>(count));
  parallel_for(out.size(), thread_count(options.threads), [&](std::size_t i) {
    DrawCheck& one = out[i];
    const std::size_t f = i % bench.frequencies();
    one.draw = i;
    one.frequency = options.frequencies[f];
    const Copy copy = copy_of(controller, causes, draw_values(causes, options.seed, i));
    const Board board(bench.wiring(), copy);
    controller::AnalogController built = controller;
    for (schematic::OpAmpModel* type : {&built.opamp, &built.fast_opamp}) {
      type->gain_bandwidth.value *= 1.0 + copy.speed;
      type->slew_v_per_s *= 1.0 + copy.speed;
    }
    controller::NgspiceRun run = controller::NgspiceRun::of_many();
    run.off = &copy.off;
    run.samples = options.samples;
    const controller::SteadyState settled =
        controller::run_in_ngspice(built, options.reference, one.frequency, run);
    one.percent = bench.error_percent(board, f);
    const std::vector<double> y = stage.response(settled.v, settled.step_s, one.frequency);
    one.ngspice_percent =
        tracking::tracking_error(y, bench.input(f).r, settled.period_s()).rms_percent_without_lag;
    const std::vector<double> v = board.drive(bench.input(f));
    double sum = 0.0;
    for (std::size_t k = 0; k < v.size(); ++k) sum += (v[k] - settled.v[k]) * (v[k] - settled.v[k]);
    one.drive_rms_percent = 100.0 * std::sqrt(sum / static_cast<double>(v.size()));
  });
  return out;
}

}  // namespace bodesmith::part_errors
