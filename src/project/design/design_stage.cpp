#include "project/design/design_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/hertz_values.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {

using report::Series;

std::string stages_csv(const std::vector<DesignStage>& stages, const std::vector<Hertz>& grid) {
  CsvWriter csv;
  csv.add(column::frequency_hz, hertz_values(grid));
  for (const DesignStage& stage : stages) {
    std::vector<double> db;
    std::vector<double> degrees;
    for (const Hertz f : grid) {
      const Complex h = stage.response(f.rad_s());
      db.push_back(to_decibel(std::abs(h)));
      degrees.push_back(to_degrees(std::arg(h)));
    }
    std::string name = stage.name;
    for (char& c : name) {
      if (c == ' ' || c == '-') c = '_';
    }
    csv.add(fmt::format("{}_{}", name, column::magnitude_db), db);
    csv.add(fmt::format("{}_{}", name, column::phase_deg), degrees);
  }
  return csv.text();
}

report::BodePlot stages_bode(const std::vector<DesignStage>& stages, const std::vector<Hertz>& grid,
                             const BodePoints* points) {
  report::BodePlot out;
  int number = 0;
  for (const DesignStage& stage : stages) {
    Series magnitude{
        stage.name, {}, {}, number % 2 == 0 ? Series::Style::line : Series::Style::dashed, number};
    ++number;
    for (const Hertz f : grid) magnitude.x.push_back(f.value);
    Series phase = magnitude;
    double last = 0.0;
    for (const Hertz f : grid) {
      const Complex h = stage.response(f.rad_s());
      magnitude.y.push_back(to_decibel(std::abs(h)));
      double angle = to_degrees(std::arg(h));
      angle += 360.0 * std::round((last - angle) / 360.0);
      last = angle;
      phase.y.push_back(angle);
    }
    out.magnitude.series.push_back(std::move(magnitude));
    out.phase.series.push_back(std::move(phase));
  }
  if (points == nullptr) return out;
  Series marks{"target", {}, {}, Series::Style::marks, 7};
  for (const BodePoint& point : points->points) {
    marks.x.push_back(point.frequency.value);
    marks.y.push_back(to_decibel(point.gain));
  }
  out.magnitude.series.push_back(std::move(marks));
  return out;
}

report::Plot difference_plot(const report::Plot& magnitude, const std::string& title, const Band& band,
                             const std::function<double(Hertz)>& reference_db, const std::string& left_out) {
  report::Plot out;
  out.title = title;
  out.x = magnitude.x;
  out.y = {"dB"};
  out.height = 240;
  double largest = 1e-4;
  for (const Series& curve : magnitude.series) {
    if (curve.name == left_out) continue;
    Series series = curve;
    for (std::size_t i = 0; i < series.y.size(); ++i) {
      series.y[i] -= reference_db(Hertz{series.x[i]});
      if (series.x[i] >= band.from.value && series.x[i] <= band.to.value)
        largest = std::max(largest, std::abs(series.y[i]));
    }
    out.series.push_back(std::move(series));
  }
  // What happens beyond the band must not flatten what happens in it.
  out.y.fixed = true;
  out.y.from = -1.15 * largest;
  out.y.to = 1.15 * largest;
  return out;
}

}  // namespace bodesmith::project
