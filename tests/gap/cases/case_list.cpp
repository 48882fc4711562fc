#include "gap/cases/case_list.hpp"

#include <array>

#include "gap/cases/response_cases.hpp"
#include "gap/cases/spice_cases.hpp"
#include "gap/cases/time_cases.hpp"

namespace hidden {
namespace {

using Names = std::vector<std::string>;

/// What a world offers.
struct Offer {
  const Names& bases;
  const Names& (*effects)(const std::string& base);
  const Names& controls;
  const Names& outside;
  Names control_bases;
  Names outside_bases;
};

Offer offer_of(World world) {
  switch (world) {
    case World::formulas:
      return {time_bases(),
              time_effects,
              control_kinds(),
              outside_kinds(),
              {"gain", "resonator", "stage", "sections"},
              {"gain", "resonator"}};
    case World::responses:
      return {response_bases(),         response_effects, response_control_kinds(),
              response_outside_kinds(), response_bases(), {"gain", "resonator", "sections"}};
    case World::ngspice:
      break;
  }
  return {spice_bases(),         spice_effects, spice_control_kinds(),
          spice_outside_kinds(), spice_bases(), {"opamp_gain", "opamp_sections"}};
}

constexpr std::array<std::array<const char*, 3>, 12> kPairs = {
    {{"gain", "amplifier_pole", "cubic_nonlinearity"},
     {"gain", "saturation", "mains_hum"},
     {"resonator", "cubic_stiffness", "drag"},
     {"resonator", "cubic_stiffness", "offset"},
     {"resonator", "amplifier_pole", "saturation"},
     {"gain", "hysteresis", "time_delay"},
     {"resonator", "hysteresis", "mains_hum"},
     {"sections", "capacitor_mismatch", "saturation"},
     {"gain", "quadratic_nonlinearity", "drift"},
     {"resonator", "time_delay", "cubic_nonlinearity"},
     {"stage", "resonance", "mains_hum"},
     {"sections", "offset", "time_delay"}}};

}  // namespace

std::vector<Specification> list_cases(const CaseOptions& options) {
  std::vector<Specification> out;
  for (const World world : options.worlds) {
    const Offer offer = offer_of(world);
    std::uint64_t seed = options.seed * 1000003;
    std::size_t effects = 0;
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      for (const auto& base : offer.bases) {
        for (const auto& effect : offer.effects(base)) {
          ++seed;
          for (const double ratio : options.ratios) {
            out.push_back({world, Kind::effect, base, {effect}, ratio, seed});
            ++effects;
          }
        }
      }
    }
    const auto controls = static_cast<std::size_t>(options.controls * static_cast<double>(effects) + 0.5);
    for (std::size_t i = 0; i < controls; ++i) {
      const auto& bases = offer.control_bases;
      out.push_back({world,
                     Kind::control,
                     bases[i % bases.size()],
                     {offer.controls[(i / bases.size()) % offer.controls.size()]},
                     0.0,
                     ++seed});
    }
    if (world == World::formulas) {
      for (int i = 0; i < options.pairs; ++i) {
        const auto& p = kPairs[static_cast<std::size_t>(i) % kPairs.size()];
        const bool swap = (static_cast<std::size_t>(i) / kPairs.size()) % 2 == 1;
        out.push_back(
            {world, Kind::pair, p[0], {p[swap ? 2 : 1], p[swap ? 1 : 2]}, options.pair_ratio, ++seed});
      }
    }
    for (int i = 0; i < options.outside; ++i) {
      for (const auto& base : offer.outside_bases) {
        for (const auto& what : offer.outside)
          out.push_back({world, Kind::outside, base, {what}, 10.0, ++seed});
      }
    }
  }
  return out;
}

Case make_case(const Specification& s) {
  if (s.world == World::responses) return make_response_case(s);
  return s.world == World::ngspice ? make_spice_case(s) : make_time_case(s);
}

}  // namespace hidden
