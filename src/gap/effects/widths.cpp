#include <vector>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A block of one width, in parts of a signal's `extent`: up to `most`, from `starts` on.
auto of_width(const char* block, double (Signal::*extent)() const, double most, std::vector<double> starts) {
  return [=](const Scene& scene, std::vector<Proposal>& out) {
    for (std::size_t at : scene.static_places()) {
      const double whole = (scene.boundary[at].*extent)();
      Starts widths;
      for (const double part : starts) widths.push_back({part * whole});
      out.push_back(insert_block(scene, at, chain::make_block(block),
                                 {logarithmic_unknown("width", 1e-5 * whole, most * whole)}, widths));
    }
  };
}

}  // namespace

BODESMITH_EFFECT(dead_zone, .what = "no response near zero",
                 .experiment = "a small drive around zero: a dead zone passes nothing",
                 .propose = of_width("dead_zone", &Signal::size, 2.0, {0.01, 0.06, 0.25}))

BODESMITH_EFFECT(
    backlash, .what = "play of constant width",
    .experiment = "loops of two amplitudes at two frequencies: play has one width at all of them",
    .propose = of_width("backlash", &Signal::span, 1.0, {0.005, 0.03, 0.12}))

}  // namespace bodesmith::gap
