// controller: the whole analog controller of a disturbance as one circuit.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "functions.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/opamp_library.hpp"
#include "synthesis/controller/files.hpp"
#include "synthesis/controller/loop.hpp"
#include "synthesis/controller/study.hpp"
#include "synthesis/generator/circuit.hpp"
#include "tolerance/controller/report.hpp"

namespace bodesmith::python {
namespace {

generator::Options controller_options(const Node& o) {
  generator::Options out(generator::Form::self_fed);
  if (o.has("form")) out.form = generator::form_named(o.at("form").string());
  for (const Node& f : o.at("track_hz").items()) out.tracked.push_back(Hertz{f.positive()});
  out.rates = !o.boolean_or("constant", false);
  out.full_stroke = o.boolean_or("full_stroke", false);
  out.rate_tolerance_percent = positive_or(o, "rate_tolerance_percent", out.rate_tolerance_percent);
  out.averaging_s = maybe_positive(o, "averaging_s").value_or(0.0);
  out.resistors = synthesis::Series::named(o.string_or("series", "E96"));
  if (out.resistors.is_exact()) out.capacitors = synthesis::Series::named("exact");
  const schematic::OpAmpLibrary types = schematic::OpAmpLibrary::built_in();
  if (o.has("opamp")) out.opamp = types.named(o.at("opamp").string());
  if (o.has("fast_opamp")) out.fast_opamp = types.named(o.at("fast_opamp").string());
  out.multiplier.scale_v = positive_or(o, "multiplier_scale_v", out.multiplier.scale_v);
  out.lowest = Hertz{positive_or(o, "lowest_hz", out.lowest.value)};
  return out;
}

}  // namespace

Answer analog_controller(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"disturbance", "form", "track_hz", "waveform", "amplitude", "constant", "full_stroke",
                "rate_tolerance_percent", "averaging_s", "series", "opamp", "fast_opamp",
                "multiplier_scale_v", "lowest_hz", "allow_unstable", "check"});
  using Shape = tracking::Reference::Shape;
  const bool checked = o.boolean_or("check", false);
  if (checked && !ngspice::is_available())
    throw InputError("check needs ngspice, which is not installed (Debian: apt-get install ngspice)");
  const Disturbance disturbance = Disturbance::from_node(o.at("disturbance"));
  const generator::Options options = controller_options(o);
  const tracking::Reference reference(
      choice(o, "waveform", {Shape::triangle, Shape::sine, Shape::two_tone, Shape::decaying_triangle}),
      positive_or(o, "amplitude", 1.0));
  const Stopwatch watch;
  const generator::DisturbanceCircuit built = generator::make_controller(disturbance, options);
  const auto cases = checked ? generator::measure_as_built(built, built.tracked, reference)
                             : generator::predict_as_built(built, reference);
  Json body = generator::controller_json(built);
  body["reference"] = {{"waveform", std::string(to_string(reference.shape()))},
                       {"amplitude", reference.alpha()}};
  body[checked ? "as_built" : "predicted"] = generator::to_json(cases);
  const double seconds = watch.seconds();
  const auto loop = checked ? generator::checked_loop_stability(built) : generator::loop_stability(built);
  generator::require_stable(loop, o.boolean_or("allow_unstable", false));
  if (!loop.at.empty()) body["stability"] = generator::to_json(loop);
  Answer out;
  out.result = document("analog_controller", body, seconds);
  out.warnings = built.warnings;
  if (const std::string warning = generator::loop_warning(loop); !warning.empty())
    out.warnings.push_back(warning);
  OutputSet files;
  generator::add_controller_files(built, "controller", body, files, "");
  for (const auto& path : files.paths()) {
    if (path != "controller.json") out.files[path.string()] = *files.content(path);
  }
  return out;
}

}  // namespace bodesmith::python
