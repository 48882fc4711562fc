#include "faults/json.hpp"

#include "base/json.hpp"

namespace bodesmith::faults {
namespace {

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

}  // namespace

Json to_json(const Diagnosis& d, const Board& board, const Spread& spread, const Priors& priors) {
  Json out;
  out["verdict"] = to_string(d.verdict);
  out["sentence"] = verdict_sentence(d);
  out["named"] = named_json(d);
  out["tied"] = tied_json(d);
  out["nothing_wrong_probability"] = d.good_probability;
  out["spread_wider_than_stated_probability"] = d.wider_probability;
  out["suspects"] = suspects_json(d);
  out["parts"] = Json::array();
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
  out["tolerances"] = {{"resistor_percent", spread.resistor_percent},
                       {"capacitor_percent", spread.capacitor_percent},
                       {"opamp_percent", spread.opamp_percent},
                       {"stray_f", spread.stray_f},
                       {"unit_capacitor_percent", spread.unit_capacitor_percent}};
  out["priors"] = priors_json(priors);
  return out;
}

}  // namespace bodesmith::faults
