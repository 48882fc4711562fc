#pragma once

#include <string>
#include <utility>
#include <vector>

#include "exchange/writer.hpp"

namespace bodesmith::exchange {

/// Times (from 0 on) and values of the signal asked for, and what is to be said of them. Points on the straight line
/// between their neighbours are left out: a source draws that line itself.
struct PwlPoints {
  std::vector<std::pair<double, double>> points;
  std::vector<std::string> said;
};
PwlPoints pwl_points(const Exportable& from, const Writer& writer, const ExportOptions& options);

}  // namespace bodesmith::exchange
