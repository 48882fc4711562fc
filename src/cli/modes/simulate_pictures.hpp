#pragma once

#include <string>
#include <utility>
#include <vector>

#include "simulate/signal_study.hpp"
#include "simulate/sweep.hpp"

namespace bodesmith::cli {

/// One run of `simulate` as it is drawn. In a loop the input is the reference r and `drive` its u.
struct SimulatedRun {
  std::string title;
  std::string input = "u";
  std::vector<double> time_s;
  std::vector<double> in;
  std::vector<double> y;
  std::vector<double> drive;
  std::vector<double> measured;  ///< the record's own y; empty: none
  const simulate::SignalStudy* study = nullptr;
  std::vector<std::pair<std::string, std::string>> figures;  ///< value and meaning
};

/// A page (.html) or, for any other name, the drawings alone (SVG).
std::string picture_of(const SimulatedRun& run, const std::string& file);
/// The same for the table of a sweep.
std::string picture_of(const std::vector<simulate::SweepRow>& rows, const std::string& title,
                       const std::string& file);

}  // namespace bodesmith::cli
