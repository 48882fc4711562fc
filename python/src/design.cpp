// design: standard filters and equalisers.
#include "filters/design.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"
#include "filters/equalisers.hpp"
#include "functions.hpp"

namespace bodesmith::python {
namespace {

using filters::Kind;

/// One frequency or two, as the kind has them.
Band edges_of(const Node& options, std::string_view key, bool band) {
  if (band) {
    if (!options.has(key)) options.fail(std::string("has no ") + std::string(key));
    return *maybe_band(options, key);
  }
  const Hertz at{options.at(key).positive()};
  return {at, at};
}

struct Designed {
  Sections sections;
  Json about;
};

Designed standard_filter(const Node& o, Kind kind) {
  const filters::Family& family = filters::family_registry().get(o.string_or("family", "butterworth"));
  const bool band = kind == Kind::bandpass || kind == Kind::bandstop;
  const double ripple_db = positive_or(o, "ripple_db", 0.5);
  const double stop_db = positive_or(o, "stop_db", 60.0);
  if (o.has("pass_hz") || o.has("stop_hz")) {
    for (const char* other : {"order", "corner_hz"}) {
      if (o.has(other)) o.at(other).fail("cannot be combined with a mask (pass_hz, stop_hz)");
    }
    filters::Mask mask;
    mask.kind = kind;
    mask.ripple_db = ripple_db;
    mask.stop_db = stop_db;
    mask.pass = edges_of(o, "pass_hz", band);
    mask.stop = edges_of(o, "stop_hz", band);
    const filters::MaskedDesign made = least_order(family, mask);
    return {place(made.prototype, made.placing),
            {{"family", family.name()},
             {"kind", to_string(kind)},
             {"order", made.order},
             {"pass_edge_db", made.ripple_db},
             {"stop_edge_db", made.stop_db}}};
  }
  if (!o.has("order")) throw InputError("neither order nor a mask (pass_hz, stop_hz) is given");
  const filters::PrototypeTask task{integer_or(o, "order", 4, 1, 1000), ripple_db, stop_db};
  return {place(make_prototype(family, task), {kind, edges_of(o, "corner_hz", band)}),
          {{"family", family.name()}, {"kind", to_string(kind)}, {"order", task.order}}};
}

Designed equaliser(const Node& o, const std::string& kind) {
  if (kind == "delay") {
    const double delay_s = o.at("delay_s").positive();
    const int order = integer_or(o, "order", 2, 1, 1000);
    return {filters::delay_allpass(delay_s, order), {{"kind", kind}, {"order", order}, {"delay_s", delay_s}}};
  }
  const Hertz corner{o.at("corner_hz").positive()};
  const double gain_db = o.at("gain_db").number();
  const Json about = {{"kind", kind}, {"corner_hz", corner.value}, {"gain_db", gain_db}};
  if (kind == "low-shelf") return {filters::low_shelf(corner, gain_db), about};
  if (kind == "high-shelf") return {filters::high_shelf(corner, gain_db), about};
  return {filters::peaking(corner, gain_db, positive_or(o, "q", 1.0)), about};
}

}  // namespace

Answer design(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"kind", "family", "order", "corner_hz", "ripple_db", "stop_db", "pass_hz", "stop_hz",
                "gain_db", "q", "delay_s"});
  const std::string word = o.at("kind").one_of(
      {"lowpass", "highpass", "bandpass", "bandstop", "peaking", "low-shelf", "high-shelf", "delay"});
  const Stopwatch watch;
  std::optional<Designed> made;
  for (const Kind kind : {Kind::lowpass, Kind::highpass, Kind::bandpass, Kind::bandstop}) {
    if (word == to_string(kind)) made = standard_filter(o, kind);
  }
  if (!made) made = equaliser(o, word);
  Json body = made->sections.to_json();
  body["design"] = made->about;
  Answer out;
  out.result = document("sections", body, watch.seconds());
  return out;
}

}  // namespace bodesmith::python
