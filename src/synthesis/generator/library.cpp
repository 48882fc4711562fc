#include "synthesis/generator/library.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/version.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::multiplier_layout {
namespace {

std::string codes_of(const Layout& layout) {
  std::vector<std::string> out;
  for (int select = 0; select < (1 << layout.select_lines()); ++select) {
    for (const bool rising : {true, false}) {
      const int b = layout.branch_at(select, rising);
      if (b >= 0)
        out.push_back(fmt::format("{}{}: {}", select, rising ? " up" : " down",
                                  layout.branches[static_cast<size_t>(b)].name));
    }
  }
  return join(out, ", ");
}

std::vector<std::string> notes_of(const Layout& layout, bool amplitude) {
  std::vector<std::string> out = {fmt::format(
      "x: 1 V is full stroke; branch above 0.5 V: {}; out: 1 V is d = 1. {}", layout.branches[0].name,
      amplitude ? "With the amplitude gains." : "Without the gain tables.")};
  if (layout.select_lines() > 0) out.push_back("select lines, binary, select1 lowest; " + codes_of(layout));
  if (amplitude) {
    out.push_back(
        "amplitude: the stroke alpha, 1 V is full stroke; x is the reference divided by alpha, 0 to 1 V.");
    out.push_back("This file stands alone: it is not to be included beside disturbance.sub.");
  }
  out.push_back("slope_detector x branch: makes the branch signal from the slope of x.");
  out.push_back("No analysis and no control section: for ngspice, LTspice and Xyce alike.");
  return out;
}

}  // namespace

std::string disturbance_pins(const Layout& layout, bool amplitude) {
  std::string out = "x branch";
  for (int line = 1; line <= layout.select_lines(); ++line) out += fmt::format(" select{}", line);
  return out + (amplitude ? " amplitude out" : " out");
}

std::string disturbance_library(const Layout& layout, const std::string& title,
                                const DisturbanceLibrary& options) {
  schematic::SpiceLibrary out;
  out.title = title;
  out.written_by = std::string("bodesmith ") + kVersion;
  out.top = options.amplitude ? "disturbance_amplitude" : "disturbance";
  out.notes = notes_of(layout, options.amplitude);
  schematic::Subcircuit top;
  top.name = out.top;
  const std::string pins = disturbance_pins(layout, options.amplitude);
  for (const std::string_view pin : split(pins, ' ')) top.pins.emplace_back(pin);
  top.netlist = layout.generator(options.amplitude);
  schematic::Deviations off = schematic::Deviations::none(top.netlist);
  if (options.errors)
    off.multiplier.assign(top.netlist.multipliers.size(), options.errors->multiplier_at_limit());
  out.subcircuits.push_back(std::move(top));
  if (layout.switched())
    out.subcircuits.push_back(
        {"slope_detector",
         {"x", "branch"},
         {"slope detector: differentiator with a logarithmic limit, comparator with hysteresis, 0 V or 1 V out"},
         layout.detector_netlist()});
  return schematic::spice_text(out, {.off = options.errors ? &off : nullptr});
}

}  // namespace bodesmith::multiplier_layout
