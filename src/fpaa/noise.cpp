#include "fpaa/noise.hpp"

namespace bodesmith::fpaa {
namespace {

double units(const PlacedCam& cam, const char* name) {
  for (const Capacitor& c : cam.capacitors) {
    if (c.name == name) return c.units;
  }
  return 0.0;
}

}  // namespace

std::vector<NoiseCharge> noise_charges(const PlacedCam& cam) {
  const auto c = [&](const char* name) { return units(cam, name); };
  if (cam.cam == "GainInv") return {{c("Cin") + c("Cout"), {{1.0}, {c("Cout")}}}};
  if (cam.cam == "FilterBilinear") {
    // Ca, Cc (or Cin, Cout) are switched; Cb, Cd (Cint) are not.
    const double switched = c("Ca") + c("Cc") + c("Cin") + c("Cout");
    return {{switched, {{1.0}, cam.z.denominator}}};
  }
  if (cam.cam == "FilterBiquad") {
    const bool high_q = cam.realised.contains("form") && cam.realised["form"] == "high Q";
    const double first = c("C1") + c("C2");
    const double second = c("C3") + (high_q ? 0.0 : c("C4") + c("Cp"));
    return {{first, {{0.0, c("C3")}, cam.z.denominator}}, {second, {{c("CA"), -c("CA")}, cam.z.denominator}}};
  }
  return {};
}

}  // namespace bodesmith::fpaa
