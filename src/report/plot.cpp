#include "report/plot.hpp"

namespace bodesmith::report {

BodePlot::BodePlot() {
  magnitude.title = "Magnitude";
  magnitude.x = {"frequency, Hz", true};
  magnitude.y = {"dB"};
  phase.title = "Phase";
  phase.x = magnitude.x;
  phase.y = {"degrees"};
}

}  // namespace bodesmith::report
