// sweep: a model under a periodic reference of every frequency and amplitude.
#include "simulate/sweep.hpp"

#include "base/progress.hpp"
#include "chain/model_file.hpp"
#include "functions.hpp"

namespace bodesmith::python {

Answer sweep_model(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"model", "kind", "offset", "periods", "samples_per_period", "controller", "feedforward"});
  const chain::Chain model = chain::model_from_node(o.at("model"));
  simulate::SweepOptions options;
  options.kind = o.string_or("kind", options.kind);
  for (const double f : call.array("frequency_hz")) options.frequencies.push_back(Hertz{f});
  options.amplitudes = call.copy("amplitude");
  options.offset = maybe_number(o, "offset");
  options.periods = integer_or(o, "periods", options.periods, 1, 100000);
  options.samples_per_period = integer_or(o, "samples_per_period", options.samples_per_period, 2, 10'000'000);
  if (o.has("controller")) {
    Provenance from;
    options.loop = simulate::controller_from_node(o.at("controller"), {}, from);
    if (o.has("feedforward")) options.loop->feedforward = chain::model_from_node(o.at("feedforward"));
  }
  const Stopwatch watch;
  const auto rows = simulate::run_sweep(model, options);
  stop_if_interrupted();
  Answer out;
  out.result["timing_s"] = {{"compute", watch.seconds()}};
  const auto column = [&](const char* name, auto value) {
    std::vector<double>& values = out.arrays[name];
    for (const simulate::SweepRow& row : rows) values.push_back(value(row));
  };
  using Row = simulate::SweepRow;
  column("frequency_hz", [](const Row& r) { return r.frequency.value; });
  column("amplitude", [](const Row& r) { return r.amplitude; });
  column("rms_percent", [](const Row& r) { return r.rms_percent; });
  column("max_percent", [](const Row& r) { return r.max_percent; });
  column("loop_height_percent", [](const Row& r) { return r.loop_height_percent; });
  column("gain_db", [](const Row& r) { return r.gain_db; });
  column("phase_deg", [](const Row& r) { return r.phase_deg; });
  column("distortion_percent", [](const Row& r) { return r.distortion_percent; });
  column("error_estimate", [](const Row& r) { return r.error_estimate; });
  return out;
}

}  // namespace bodesmith::python
