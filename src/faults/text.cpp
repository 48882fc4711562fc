#include <fmt/format.h>

#include "base/text.hpp"
#include "faults/json.hpp"

namespace bodesmith::faults {
namespace {

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

}  // namespace

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

}  // namespace bodesmith::faults
