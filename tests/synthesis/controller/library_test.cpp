#include <gtest/gtest.h>

#include "base/error.hpp"
#include "schematic/writers/spice_library.hpp"
#include "synthesis/controller/seed_controller.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/generator/files.hpp"
#include "synthesis/realise.hpp"
#include "synthesis/seed_sections.hpp"

namespace bodesmith::generator {
namespace {

void expect_same_bytes(const std::string& text) {
  const schematic::SpiceLibrary library = schematic::read_spice(text, "printed.sub");
  EXPECT_EQ(schematic::spice_text(library), text);
}

Disturbance of_amplitudes() {
  Disturbance out;
  out.ascending = {0.3546, -0.6433, 0.2887};
  out.descending = {-0.2398, 0.0838, 0.156};
  out.amplitude.alpha = {0.1, 0.3, 0.6, 1.0};
  out.amplitude.ascending = {0.1, 0.4, 0.65, 1.0};
  out.amplitude.descending = {0.15, 0.25, 0.7, 1.0};
  return out;
}

TEST(SpiceRoundTrip, Compensator) {
  synthesis::RealiseOptions options;
  expect_same_bytes(schematic::spice_text(
      synthesis::compensator_library(synthesis::realise(seed_sections(), options).circuit, "seed")));
  options.opamp = schematic::OpAmpModel::ideal();
  expect_same_bytes(schematic::spice_text(
      synthesis::compensator_library(synthesis::realise(seed_sections(), options).circuit, "seed")));
}

TEST(SpiceRoundTrip, Disturbance) {
  const generator::DisturbanceCircuit layout = generator::make_layout(of_amplitudes());
  expect_same_bytes(generator::disturbance_library(*layout.of_full_strokes, "two branches"));
  expect_same_bytes(generator::disturbance_library(layout, "amplitudes"));
  std::vector<generator::Polynomial> branches;
  for (int b = 1; b <= 5; ++b) branches.push_back({"b", {0.05 * b, -0.1, 0.02 * b}, {}});
  expect_same_bytes(generator::disturbance_library(generator::make_layout(generator::Input{branches, {}}),
                                                   "five branches"));
}

TEST(SpiceRoundTrip, Controller) {
  Disturbance rates = of_amplitudes();
  rates.amplitude = {};
  rates.rate.frequency = {Hertz{1}, Hertz{10}, Hertz{100}};
  rates.rate.ascending = {1, 1, 1};
  rates.rate.descending = {1, 1.1, 1.17};
  const DisturbanceCircuit controller = make_controller(rates);
  const std::string whole = controller_library(controller, "whole");
  expect_same_bytes(whole);
  EXPECT_NE(whole.find(controller.opamp.name), std::string::npos);
  EXPECT_EQ(whole.find("* Voltage noise"), std::string::npos);  // a run over time would carry it along
  EXPECT_NE(opamp_subcircuit(controller.opamp).find("* Voltage noise"), std::string::npos);
  LibraryOptions open;
  open.open = true;
  expect_same_bytes(controller_library(controller, "open", open));
}

TEST(SpiceRoundTrip, WhatItDoesNotWriteIsRefused) {
  const std::string text = generator::disturbance_library(generator::make_layout(of_amplitudes()), "t");
  const std::size_t end = text.find("\n.ends");
  EXPECT_THROW(schematic::read_spice(text.substr(0, end) + "\nL1 a b 1m" + text.substr(end), "f.sub"),
               InputError);
  EXPECT_THROW(schematic::read_spice(text.substr(0, end), "f.sub"), InputError);
}

}  // namespace
}  // namespace bodesmith::generator
