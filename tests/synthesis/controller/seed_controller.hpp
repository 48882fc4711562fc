#pragma once

#include "synthesis/controller/library.hpp"

namespace bodesmith::generator {

using generator::BuiltGenerator;
using generator::make_controller;
using generator::Options;

/// The disturbance of examples/nanopositioner.
inline Disturbance seed_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  for (const double f : {1.0, 10.0, 20.0, 60.0, 100.0}) d.rate.frequency.push_back(Hertz{f});
  d.rate.ascending = {1.0, 1.0, 1.0, 1.0, 1.0};
  d.rate.descending = {1.0, 1.06, 1.1, 1.04, 1.17};
  return d;
}

inline std::vector<Hertz> seed_frequencies() {
  std::vector<Hertz> out;
  for (const double f : {1.0, 10.0, 20.0, 40.0, 60.0, 80.0, 100.0}) out.push_back(Hertz{f});
  return out;
}

inline const DisturbanceCircuit& seed_controller() {
  static const DisturbanceCircuit made = [] {
    Options options(Form::self_fed);
    options.tracked = seed_frequencies();
    return make_controller(seed_disturbance(), options);
  }();
  return made;
}

}  // namespace bodesmith::generator
