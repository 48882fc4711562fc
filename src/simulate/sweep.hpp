#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chain/chain.hpp"
#include "simulate/controller_file.hpp"
#include "simulate/references.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// A chain (or a loop round it) under a periodic reference of every frequency and amplitude.
struct SweepOptions {
  std::string kind = "triangle";  ///< triangle, sine or stair
  std::vector<Hertz> frequencies;
  std::vector<double> amplitudes;
  std::optional<double> offset;   ///< none: the amplitude, so that the reference starts at 0
  int periods = 3;                ///< the last one is measured, those before it settle
  int samples_per_period = 1000;  ///< a multiple of 2
  int threads = 0;                ///< 0: one a core
  std::optional<LoopSetup> loop;  ///< the chain inside a loop; u of the rows is then its reference
  bool keep_periods = false;      ///< rows also carry the signals of their last period
  Options simulation;
};

/// Figures of the last period.
struct SweepRow {
  Hertz frequency;
  double amplitude = 0.0;
  double rms_percent = 0.0;  ///< y against u, percent of the range of y (eq. 8)
  double max_percent = 0.0;
  double loop_height_percent = 0.0;  ///< hysteresis height, percent of the range of y
  double gain_db = 0.0;              ///< fundamental of y over that of u
  double phase_deg = 0.0;
  double distortion_percent = 0.0;  ///< power of harmonics 2 to 20 of y over its fundamental
  double error_estimate = 0.0;      ///< of the simulation, units of y
  std::vector<double> u;            ///< the last period, when kept
  std::vector<double> y;
};

/// One row a pair, frequencies outermost. Pairs that `known` already has are taken from there. Stopped by
/// Ctrl-C it returns the rows that are ready (fewer than all). Rows do not depend on the number of threads.
std::vector<SweepRow> run_sweep(const chain::Chain& chain, const SweepOptions& options,
                                const std::vector<SweepRow>& known = {});

/// CSV with a comment that names what it belongs to (`key`, a hash of the model and of the settings).
std::string sweep_csv(const std::vector<SweepRow>& rows, const std::string& key);
/// The hysteresis loops of every run, one below the other, and the harmonics of u and y likewise. They need
/// rows that kept their signals.
std::string sweep_loops_csv(const std::vector<SweepRow>& rows);
std::string sweep_spectra_csv(const std::vector<SweepRow>& rows);
/// Rows of such a file; none when it does not exist or belongs to something else.
std::vector<SweepRow> read_sweep_csv(const std::filesystem::path& path, const std::string& key);
/// What rows depend on besides frequency and amplitude; `files_sha256` stands for the model (and controller).
std::string sweep_key(const std::string& files_sha256, const SweepOptions& options);

}  // namespace bodesmith::simulate
