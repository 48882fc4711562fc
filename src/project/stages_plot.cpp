#include "project/stages_plot.hpp"

#include <algorithm>
#include <cmath>

#include "report/bode.hpp"

namespace bodesmith::project {
namespace {

using report::Series;

Series target_marks(const Project& project) {
  Series series{"target", {}, {}, Series::Style::marks, 7};
  for (const BodePoint& point : project.target.points.points) {
    series.x.push_back(point.frequency.value);
    series.y.push_back(to_decibel(point.gain));
  }
  return series;
}

struct StageCurves {
  Series magnitude;
  Series phase;  ///< unwrapped
};

StageCurves stage_curves(const DesignStage& stage, const std::vector<Hertz>& grid, int number) {
  StageCurves out;
  out.magnitude = {stage.name, {}, {}, number % 2 == 0 ? Series::Style::line : Series::Style::dashed, number};
  for (const Hertz f : grid) out.magnitude.x.push_back(f.value);
  out.phase = out.magnitude;
  double last = 0.0;
  for (const Hertz f : grid) {
    const std::complex<double> h = stage.response(f.rad_s());
    out.magnitude.y.push_back(to_decibel(std::abs(h)));
    double angle = to_degrees(std::arg(h));
    angle += 360.0 * std::round((last - angle) / 360.0);
    last = angle;
    out.phase.y.push_back(angle);
  }
  return out;
}

struct PlotRange {
  double low = 0.0;
  double high = 0.0;
};

/// Smallest and largest of `values`, not narrower than `start`.
PlotRange range_of(const std::vector<double>& values, PlotRange start) {
  for (const double y : values) {
    start.low = std::min(start.low, y);
    start.high = std::max(start.high, y);
  }
  return start;
}

void fix_axis(report::Axis& axis, double from, double to) {
  axis.fixed = true;
  axis.from = from;
  axis.to = to;
}

}  // namespace

namespace {

/// What every stage has that the first one has not: curves that lie on each other are told apart here.
report::Plot error_beneath(const report::Plot& magnitude, const Band& band) {
  report::Plot out;
  const Series& first = magnitude.series.front();
  out.title = "Difference from the " + first.name;
  out.x = magnitude.x;
  out.y = {"dB"};
  out.height = 240;
  double largest = 1e-4;
  for (const Series& stage : magnitude.series) {
    if (&stage == &first || stage.style == Series::Style::marks) continue;
    Series series = stage;
    for (std::size_t i = 0; i < series.y.size(); ++i) {
      series.y[i] -= first.y[i];
      if (series.x[i] >= band.from.value && series.x[i] <= band.to.value)
        largest = std::max(largest, std::abs(series.y[i]));
    }
    out.series.push_back(std::move(series));
  }
  fix_axis(out.y, -1.15 * largest, 1.15 * largest);
  return out;
}

}  // namespace

std::vector<Hertz> stages_grid(const Band& band) {
  return log_grid({Hertz{band.from.value / 10.0}, Hertz{band.to.value * 10.0}}, 241);
}

std::vector<report::Plot> stages_plots(const Project& project, const Design& design, const Budget& budget) {
  const std::vector<Hertz> grid = stages_grid(budget.band);
  report::BodePlot plot;
  int number = 0;
  for (const DesignStage& stage : design_stages(design)) {
    StageCurves curves = stage_curves(stage, grid, number++);
    plot.magnitude.series.push_back(std::move(curves.magnitude));
    plot.phase.series.push_back(std::move(curves.phase));
  }
  plot.magnitude.series.push_back(target_marks(project));
  // What lies far outside (the notches of a sampled chain) must not flatten the curves that matter.
  const PlotRange db = range_of(plot.magnitude.series.front().y, {0.0, 0.0});
  const double margin = 0.25 * std::max(0.5, db.high - db.low);
  fix_axis(plot.magnitude.y, db.low - margin, db.high + margin);
  const PlotRange degrees = range_of(plot.phase.series.front().y, {-5.0, 5.0});
  fix_axis(plot.phase.y, 2.0 * degrees.low, 1.5 * degrees.high);
  return {plot.magnitude, plot.phase, error_beneath(plot.magnitude, budget.band)};
}

}  // namespace bodesmith::project
