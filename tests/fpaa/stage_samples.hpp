#pragma once

#include <string>
#include <vector>

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

/// A stage with small capacitors: its response settles within a few periods.
struct StageSample {
  std::string title;
  PlacedCam cam;
  /// Of each input: whole periods by which the switches show a held input late, beyond z.
  std::vector<double> late_periods;
};

/// Every CAM and option that says its switches (cam_test.cpp: none is missing).
inline std::vector<StageSample> stage_samples() {
  std::vector<StageSample> out;
  const auto add = [&](const char* cam, const char* option, std::vector<Capacitor> capacitors,
                       std::vector<double> late = {0.0}, int phase = 1, CamValues realised = {}) {
    StageSample s;
    s.title = std::string(cam) + " " + option + (phase == 2 ? ", phase 2" : "");
    s.cam.name = "Stage1";
    s.cam.cam = cam_registry().find(cam);
    s.cam.option = option;
    s.cam.clock_a = {100e3};
    s.cam.capacitors = std::move(capacitors);
    s.cam.phase = phase;
    s.cam.realised = std::move(realised);
    s.late_periods = std::move(late);
    s.cam.z.numerators.resize(s.late_periods.size());
    s.cam.find_z();
    out.push_back(std::move(s));
  };
  add("FilterBilinear", "Low Pass", {{"Cin", 9}, {"Cint", 25}, {"Cout", 10}});
  add("FilterBilinear", "High Pass", {{"Cb", 20}, {"Cc", 9}, {"Cd", 17}});
  add("FilterBilinear", "Pole and Zero", {{"Ca", 12}, {"Cb", 30}, {"Cc", 10}, {"Cd", 20}});
  add("GainInv", "", {{"Cin", 30}, {"Cout", 12}});
  add("SumInv", "2 inputs", {{"Cin1", 7}, {"aCin1", 20}, {"Cin2", 11}, {"Cout", 10}, {"aCout", 30}},
      {0.0, 0.0});
  add("SumInv", "3 inputs",
      {{"Cin1", 7}, {"aCin1", 7}, {"Cin2", 12}, {"aCin2", 5}, {"Cin3", 9}, {"Cout", 11}, {"aCout", 16}},
      {0.0, 0.0, 0.0});
  add("SumFilter", "", {{"C1", 5}, {"C2", 9}, {"Cint", 22}, {"Cout", 8}}, {0.0, 0.0});
  for (const int phase : {1, 2}) {
    // In phase 2 the inputs of the same period are there already; in phase 1 a delayed one is a period old.
    const double late = phase == 1 ? 1.0 : 0.0;
    add("SumDiff", "2 inputs", {{"Cin1", 15}, {"Cin2", 8}, {"Cout", 10}}, {0.0, late}, phase,
        {{"gain_1", -1.5}, {"gain_2", 0.8}});
    add("GainHalf", "Inverting", {{"Cin", 15}, {"Cout", 10}}, {0.0}, phase);
    add("GainHalf", "Non-inverting", {{"Cin", 15}, {"Cout", 10}}, {late}, phase);
    add("GainHold", "Inverting", {{"Cin", 15}, {"Cout", 10}}, {phase == 1 ? 0.0 : 1.0}, phase);
    // In phase 2 its output moves while it holds: its file says by how much.
    if (phase == 1) add("GainHold", "Non-inverting", {{"Cin", 15}, {"Cout", 10}}, {1.0}, phase);
    add("Hold", "", {}, {1.0}, phase);
  }
  add("Integrator", "Inverting", {{"Cin", 7}, {"Cint", 30}});
  add("Integrator", "Non-inverting", {{"Cin", 7}, {"Cint", 30}});
  const CamValues low{{"form", std::string("low Q")}};
  const CamValues high{{"form", std::string("high Q")}};
  const auto biquad = [&](const char* option, const char* input, int units, bool high_q) {
    add("FilterBiquad", option,
        {{input, units}, {"C2", 40}, {"C3", 45}, {"C4", high_q ? 180 : 70}, {"CA", 300}, {"CB", 120}}, {0.0},
        1, high_q ? high : low);
  };
  for (const bool high_q : {false, true}) {
    biquad("Low Pass", "C1", 30, high_q);
    biquad("Band Pass", "Cp", 50, high_q);
    biquad("High Pass", "Cpp", 80, high_q);
  }
  for (const char* option : {"Low Q", "Low Q, C1 non-inverting", "High Q", "High Q, C1 non-inverting"}) {
    add("BiquadStage", option,
        {{"C1", 25}, {"Cp", 12}, {"Cpp", 9}, {"C2", 40}, {"C3", 45}, {"C4", 150}, {"CA", 200}, {"CB", 120}});
  }
  return out;
}

}  // namespace bodesmith::fpaa
