// margins: of an open loop made of several things one after the other.
#include "functions.hpp"
#include "lti/loop_margins.hpp"
#include "lti/sections.hpp"
#include "responses.hpp"

namespace bodesmith::python {
namespace {

/// The product as sections where all factors are sections: only then the turns round -1 can be counted.
std::optional<Sections> product_of_sections(const std::vector<Node>& factors) {
  Sections out;
  for (const Node& factor : factors) {
    if (factor.at("schema").string() != "bodesmith.sections/1") return std::nullopt;
    const Sections one = Sections::from_node(factor);
    out.gain *= one.gain;
    out.delay_s += one.delay_s;
    out.sections.insert(out.sections.end(), one.sections.begin(), one.sections.end());
  }
  return out;
}

}  // namespace

Answer loop_margins_of(const Call& call) {
  const Node& o = call.options;
  o.allow_only({"loop", "band_hz", "count", "with_delays"});
  const std::vector<Node> factors = o.at("loop").items();
  if (factors.empty()) o.at("loop").fail("is empty, expected at least one response");
  std::vector<ResponseFunction> responses;
  for (const Node& factor : factors)
    responses.push_back(response_function(factor, o.boolean_or("with_delays", true)));
  const Loop loop = [&responses](Hertz f) {
    std::complex<double> product = 1.0;
    for (const ResponseFunction& response : responses) product *= response(f.rad_s());
    return product;
  };
  const std::optional<Band> band = maybe_band(o);
  if (!band) o.fail("has no band_hz");
  Answer out;
  out.result =
      to_json(bodesmith::loop_margins(loop, log_grid(*band, integer_or(o, "count", 4000, 2, 1'000'000))));
  out.result["closed_loop_stable"] = nullptr;
  if (const auto sections = product_of_sections(factors)) {
    if (const auto stable = closed_loop_is_stable(*sections)) out.result["closed_loop_stable"] = *stable;
  }
  return out;
}

}  // namespace bodesmith::python
