#include "faults/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "numeric/index.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::faults {
namespace {

using report::Series;

Json finding_json(const Finding& finding) {
  Json out = Json::array();
  for (std::size_t i = 0; i < finding.faults.size(); ++i) {
    const Fault& fault = *finding.faults[i];
    Json one = {
        {"fault", fault.kind->name()}, {"parts", fault.parts}, {"words", fault.words(finding.sizes[i])}};
    if (const FaultSize size = fault.size(finding.sizes[i]); !size.key.empty()) one[size.key] = size.value;
    out.push_back(std::move(one));
  }
  return out;
}

Json suspects_json(const Diagnosis& d) {
  Json out = Json::array();
  for (const Suspect& s : d.suspects) {
    if (out.size() >= 20 || (out.size() >= d.tied && s.probability < 1e-6)) break;
    out.push_back({{"site", s.site},
                   {"probability", s.probability},
                   {"faults", finding_json(s.best)},
                   {"left_max_complex_percent", s.worst_error_percent}});
  }
  return out;
}

Json named_json(const Diagnosis& d) {
  Json out = Json::array();
  if (d.verdict != Verdict::one_fault && d.verdict != Verdict::two_faults) return out;
  for (const Fault* fault : d.suspects[0].best.faults) {
    for (const std::string& part : fault->parts) out.push_back(part);
  }
  return out;
}

Json tied_json(const Diagnosis& d) {
  Json out = Json::array();
  for (std::size_t i = 0; d.verdict == Verdict::tie && i < d.tied; ++i) out.push_back(d.suspects[i].site);
  return out;
}

Json priors_json(const Priors& priors) {
  Json kinds = Json::object();
  for (const FaultKind* kind : fault_kind_registry().all()) kinds[std::string(kind->name())] = kind->prior();
  return {{"good", priors.good},
          {"one_fault", priors.one_fault},
          {"two_faults", priors.two_faults},
          {"kinds", kinds}};
}

std::string percent_text(double probability) {
  if (probability > 0.999) return "over 99.9 %";
  if (probability < 0.001) return "under 0.1 %";
  return rounded_text(100.0 * probability, 3) + " %";
}

std::string words_of(const Finding& finding) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < finding.faults.size(); ++i)
    out.push_back(finding.faults[i]->words(finding.sizes[i]));
  return join(out, ", and ");
}

/// A response (from point `first` on) as two curves.
void add_response(report::BodePlot& plot, const std::string& name, const Channel& channel,
                  const Eigen::VectorXcd& response, std::size_t first, Series::Style style) {
  Series magnitude{name, hertz_values(channel.grid), {}, style};
  Series phase{name, hertz_values(channel.grid), {}, style};
  for (std::size_t i = 0; i < channel.grid.size(); ++i) {
    const Complex h = response(eigen_index(first + i));
    magnitude.y.push_back(to_decibel(std::max(std::abs(h), 1e-9)));
    phase.y.push_back(to_degrees(std::arg(h)));
  }
  plot.magnitude.series.push_back(std::move(magnitude));
  plot.phase.series.push_back(std::move(phase));
}

void add_measured(report::BodePlot& plot, const Channel& channel) {
  Series magnitude{"measured", hertz_values(channel.grid), {}, Series::Style::marks};
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
    if (table.rows.size() < d.tied && d.verdict != Verdict::nothing_wrong)
      table.marked.push_back(table.rows.size());
    table.rows.push_back(
        {s.site, rounded_text(s.probability, 3), words_of(s.best), rounded_text(s.worst_error_percent, 3)});
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

Json to_json(const Diagnosis& d, const Board& board, const Spread& spread, const Priors& priors) {
  Json out = {{"verdict", to_string(d.verdict)},
              {"sentence", verdict_sentence(d)},
              {"named", named_json(d)},
              {"tied", tied_json(d)},
              {"nothing_wrong_probability", d.good_probability},
              {"spread_wider_than_stated_probability", d.wider_probability},
              {"suspects", suspects_json(d)},
              {"parts", Json::array()}};
  for (const auto& [part, probability] : d.parts) {
    if (probability >= 1e-6) out["parts"].push_back({{"part", part}, {"probability", probability}});
  }
  if (d.probe)
    out["probe"] = {{"node", d.probe->node},
                    {"frequency_hz", d.probe->at.value},
                    {"difference_db", d.probe->db},
                    {"difference_deg", d.probe->deg},
                    {"difference_over_tolerance", d.probe->factor},
                    {"tells_apart", d.probe->tells_apart}};
  out["rework"] = Json::array();
  for (const Rework& one : d.rework) out["rework"].push_back({{"text", one.text}, {"parts", one.parts}});
  out["hidden"] = d.hidden;
  out["next"] = next_steps(d);
  out["noise"] = {{"magnitude_db", d.noise.gain * kDecibelPerNeper},
                  {"phase_deg", to_degrees(d.noise.phase)}};
  out["misfit_per_value"] = d.misfit;
  out["faults_tried"] = d.tried;
  out["measured"] = Json::array();
  for (const Channel& channel : board.measured().channels)
    out["measured"].push_back({{"file", channel.file},
                               {"node", channel.node},
                               {"points", channel.measured_points},
                               {"points_used", channel.grid.size()},
                               {"phase", !channel.phase_rad.empty()}});
  out["tolerances"] = synthesis::to_json(spread);
  out["tolerances"].update(spread.mismatch.to_json());
  out["tolerances"].update({{"opamp_percent", spread.opamp_percent}, {"stray_f", spread.stray_f}});
  out["priors"] = priors_json(priors);
  return out;
}

std::string verdict_sentence(const Diagnosis& d) {
  switch (d.verdict) {
    case Verdict::nothing_wrong:
      if (d.wider_probability > 0.5 * d.good_probability && d.wider_probability > 0.5)
        return "no single part is wrong, but the parts are spread wider than their stated tolerance";
      return "nothing wrong beyond tolerance";
    case Verdict::uncertain:
      return fmt::format("perhaps something is wrong, too little to accuse a part: likeliest {} ({})",
                         d.suspects[0].site, percent_text(d.suspects[0].probability));
    case Verdict::one_fault:
    case Verdict::two_faults:
      return words_of(d.suspects[0].best);
    case Verdict::tie: {
      std::vector<std::string> sites;
      for (std::size_t i = 0; i < d.tied; ++i) sites.push_back(d.suspects[i].site);
      return fmt::format("something is wrong, and this measurement cannot say which: {}",
                         join(sites, ", or "));
    }
    case Verdict::unexplained:
      break;
  }
  return "something is wrong that no fault of the catalogue explains, alone or in pairs: no part is named";
}

std::vector<std::string> next_steps(const Diagnosis& d) {
  std::vector<std::string> out;
  if (d.probe) {
    std::string what =
        fmt::format("probe node {} next: at {} the predictions differ by {} dB and {} deg there",
                    d.probe->node, engineering_text(d.probe->at.value, "Hz"), rounded_text(d.probe->db, 3),
                    rounded_text(d.probe->deg, 3));
    if (d.tied > 2) what += fmt::format(" (tells {})", join(d.probe->tells_apart, ", "));
    out.push_back(what + "; then give its response as well");
  } else if (d.verdict == Verdict::tie) {
    out.push_back("no node of the board tells them apart: lift one end of each and measure the part itself");
  }
  if (d.verdict == Verdict::uncertain)
    out.push_back("measure again with less noise, with phase, or over a wider band");
  for (const Rework& one : d.rework) out.push_back("rework: " + one.text);
  if (!d.hidden.empty())
    out.push_back(
        fmt::format("wrong values of {} would not show as long as this is so: measure again after the rework",
                    join(d.hidden, ", ")));
  if (d.verdict == Verdict::unexplained)
    out.push_back(
        "check that the board, its file and the measurement belong together (input, output, calibration)");
  return out;
}

std::string summary_text(const Diagnosis& d) {
  std::string out = verdict_sentence(d) + "\n";
  if (d.verdict == Verdict::nothing_wrong) {
    out += fmt::format("  probability that a part is wrong: {}\n", percent_text(1.0 - d.good_probability));
  } else {
    out += fmt::format("  probability that nothing is wrong: {}\n", percent_text(d.good_probability));
    if (d.verdict == Verdict::unexplained) out += "  nearest, and not enough:\n";
    for (std::size_t i = 0; i < std::min<std::size_t>(d.suspects.size(), std::max<std::size_t>(d.tied, 3));
         ++i) {
      const Suspect& s = d.suspects[i];
      if (i >= d.tied && s.probability < 1e-3) break;
      out += fmt::format("  {}: {}\n", percent_text(s.probability), words_of(s.best));
    }
  }
  for (const std::string& step : next_steps(d)) out += "  " + step + "\n";
  return out;
}

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
