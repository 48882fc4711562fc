#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "lti/frequency_grid.hpp"
#include "schematic/ngspice/ngspice_process.hpp"
#include "schematic/ngspice/plain_netlist.hpp"

namespace bodesmith::ngspice {

/// V(out)/V(in) of a two-pin subcircuit (`in out`, ground 0) of a library file, small-signal, at every
/// frequency of the grid. `subcircuit` empty: "compensator" when there is one, otherwise the last with two
/// pins.
std::vector<Complex> run_ac_of_sub(const std::filesystem::path& library, const std::vector<Hertz>& grid,
                                   const std::string& subcircuit = {});
/// The same for a library that is not on disk yet. `name` is used in messages.
std::vector<Complex> run_ac_of_text(const std::string& library, const std::string& name,
                                    const std::vector<Hertz>& grid, const std::string& subcircuit = {});

/// The response of a user's own deck (first line a title, one source with an AC value) at `node`, relative to
/// that source: its analyses, outputs and .control section are left out, its .include and .lib files are
/// found next to it. `node` empty: "out" when there is one, otherwise the first v(…) of its .print, .plot,
/// .save or .probe lines. Throws InputError with file and line.
std::vector<Complex> run_ac_of_deck(const std::filesystem::path& deck, const std::vector<Hertz>& grid,
                                    const std::string& node = {});

/// V(node) of a deck without analysis and `.end` whose sources have their AC values: small-signal, about its
/// operating point. `what` leads error messages.
std::vector<Complex> run_ac_of_circuit(const std::string& deck, const std::string& node,
                                       const std::vector<Hertz>& grid, const std::string& what);

/// A d.c. sweep: values of the source and the wanted node voltages.
struct DcSweep {
  std::vector<double> source_v;
  std::vector<std::vector<double>> v;  ///< one a node
};
/// Runs a deck without analysis and `.end` through `dc source from to step`.
DcSweep run_dc(const std::string& deck, const std::string& source, double from, double to, double step,
               const std::vector<std::string>& nodes, const std::string& what);

/// Columns of a transient run: time and the wanted node voltages.
struct Transient {
  std::vector<double> time_s;
  std::vector<std::vector<double>> v;  ///< one a node
  /// Straight between ngspice's own instants. `place` (1 to begin with) moves on with t; an earlier t begins again.
  double at(std::size_t node, double t, std::size_t& place) const;
};
/// Runs a deck without analysis and `.end` through `.tran step stop 0 step`, and reads back the nodes'
/// voltages.
Transient run_transient(const std::string& deck, const std::vector<std::string>& nodes, double step_s,
                        double stop_s, const std::string& what);

/// Output noise of a library's `compensator`, V/sqrt(Hz) at the frequencies that ngspice chose.
struct NoiseSpectrum {
  std::vector<Hertz> grid;
  std::vector<double> v_per_rthz;
};
NoiseSpectrum run_noise_of_text(const std::string& library, Band band, int per_decade,
                                const std::string& what);

}  // namespace bodesmith::ngspice
