#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "base/text.hpp"
#include "faults/json.hpp"
#include "numeric/index.hpp"
#include "report/bode.hpp"
#include "report/page.hpp"

namespace bodesmith::faults {
namespace {

using report::Series;

std::vector<double> frequencies(const Channel& channel) {
  std::vector<double> out;
  for (const Hertz f : channel.grid) out.push_back(f.value);
  return out;
}

/// A response (from point `first` on) as two curves.
void add_response(report::BodePlot& plot, const std::string& name, const Channel& channel,
                  const Eigen::VectorXcd& response, std::size_t first, Series::Style style) {
  Series magnitude{name, frequencies(channel), {}, style};
  Series phase{name, frequencies(channel), {}, style};
  for (std::size_t i = 0; i < channel.grid.size(); ++i) {
    const std::complex<double> h = response(eigen_index(first + i));
    magnitude.y.push_back(to_decibel(std::max(std::abs(h), 1e-9)));
    phase.y.push_back(to_degrees(std::arg(h)));
  }
  plot.magnitude.series.push_back(std::move(magnitude));
  plot.phase.series.push_back(std::move(phase));
}

void add_measured(report::BodePlot& plot, const Channel& channel) {
  Series magnitude{"measured", frequencies(channel), {}, Series::Style::marks};
  Series phase = magnitude;
  for (const double g : channel.log_gain) magnitude.y.push_back(g * kDecibelPerNeper);
  for (const double p : channel.phase_rad)
    phase.y.push_back(to_degrees(std::remainder(p, 2.0 * std::numbers::pi)));
  plot.magnitude.series.push_back(std::move(magnitude));
  if (!phase.y.empty()) plot.phase.series.push_back(std::move(phase));
}

void add_figures(report::Page& page, const Diagnosis& d, const Board& board) {
  page.chapter("Measured and explained");
  const Eigen::VectorXcd good = board.response({});
  std::size_t first = 0;
  for (const Channel& channel : board.measured().channels) {
    report::BodePlot plot;
    plot.magnitude.title = channel.node == "out" ? "output" : "node " + channel.node;
    add_measured(plot, channel);
    add_response(plot, "as designed", channel, good, first, Series::Style::dashed);
    if (d.verdict != Verdict::nothing_wrong && !d.suspects.empty())
      add_response(plot, d.suspects[0].site, channel, board.response(d.suspects[0].best.effect()), first,
                   Series::Style::line);
    page.plots(plot.plots(), fmt::format("{} of {} points of {}.", channel.grid.size(),
                                         channel.measured_points, channel.file));
    first += channel.grid.size();
  }
}

void add_suspects(report::Page& page, const Diagnosis& d) {
  page.chapter("Suspects");
  report::Table table;
  table.head = {"suspect", "probability", "what it would be", "left of the difference, %"};
  for (const Suspect& s : d.suspects) {
    if (table.rows.size() >= 12 || (table.rows.size() >= d.tied && s.probability < 1e-5)) break;
    std::vector<std::string> words;
    for (std::size_t i = 0; i < s.best.faults.size(); ++i)
      words.push_back(s.best.faults[i]->words(s.best.sizes[i]));
    if (table.rows.size() < d.tied && d.verdict != Verdict::nothing_wrong)
      table.marked.push_back(table.rows.size());
    table.rows.push_back({s.site, rounded_text(s.probability, 3), join(words, ", and "),
                          rounded_text(s.worst_error_percent, 3)});
  }
  page.table(
      table,
      "Probabilities from the measurement and the stated ones below; what is left is the worst complex "
      "difference of the measurement, every other part at its nominal value.");
}

void add_priors(report::Page& page) {
  page.chapter("What was believed beforehand");
  report::Table table;
  table.head = {"kind of fault", "what it is", "share of faulty boards"};
  for (const FaultKind* kind : fault_kind_registry().all())
    table.rows.push_back(
        {std::string(kind->name()), std::string(kind->what()), rounded_text(kind->prior(), 3)});
  page.table(
      table,
      "Shares are normalised over the kinds a board can have, and each kind's is divided evenly among the "
      "places it can be at. One board in two is taken to be good, one in seventeen to have two faults.");
}

}  // namespace

std::string report_page(const Diagnosis& d, const Board& board, const std::string& name) {
  report::Page page("Which part of the board is wrong", name);
  page.chapter("Verdict");
  std::string verdict = to_string(d.verdict);
  std::replace(verdict.begin(), verdict.end(), '_', ' ');
  page.paragraph(verdict_sentence(d) + ".");
  page.key_figures(
      {{verdict, "verdict"},
       {rounded_text(d.good_probability, 2), "probability that nothing is wrong"},
       {rounded_text(d.noise.gain * kDecibelPerNeper, 2) + " dB", "noise of the measured magnitude"},
       {rounded_text(d.misfit, 3), "misfit per value: 1 is noise alone"}});
  for (const std::string& step : next_steps(d)) page.warning(step);
  add_figures(page, d, board);
  if (!d.suspects.empty()) add_suspects(page, d);
  add_priors(page);
  return page.html();
}

}  // namespace bodesmith::faults
