#include "tolerance/json.hpp"

#include <algorithm>
#include <cmath>

#include "base/json.hpp"

namespace bodesmith::yield {
namespace {

/// The share of samples within the limits, with Wilson's interval of 95 %.
Json within_json(const Result& result, const Options& options) {
  const double n = static_cast<double>(result.samples), share = static_cast<double>(result.within) / n;
  const double z = 1.959963984540054, zz = z * z / n;
  const double middle = (share + 0.5 * zz) / (1.0 + zz);
  const double half = z * std::sqrt(share * (1.0 - share) / n + 0.25 * zz / n) / (1.0 + zz);
  Json out = {{"within", result.within},
              {"percent", 100.0 * share},
              {"percent_low", 100.0 * std::max(0.0, middle - half)},
              {"percent_high", 100.0 * std::min(1.0, middle + half)}};
  if (options.limit_db) out["limit_db"] = *options.limit_db;
  if (options.limit_deg) out["limit_deg"] = *options.limit_deg;
  return out;
}

/// Columns over frequency.
Json table_json(const std::vector<Histogram>& all) {
  static const std::pair<const char*, double> kQuantiles[] = {
      {"p0_135", 0.00135}, {"p2_5", 0.025}, {"p50", 0.5}, {"p97_5", 0.975}, {"p99_865", 0.99865}};
  Json columns = Json::object();
  columns["min"] = Json::array();
  for (const auto& [key, p] : kQuantiles) columns[key] = Json::array();
  columns["max"] = Json::array();
  for (const Histogram& h : all) {
    columns["min"].push_back(h.min);
    for (const auto& [key, p] : kQuantiles) columns[key].push_back(h.quantile(p));
    columns["max"].push_back(h.max);
  }
  return columns;
}

}  // namespace

Json to_json(const Result& result, const Options& options) {
  Json out = {{"name", result.name},
              {"samples", result.samples},
              {"worst_db", Json::object()},
              {"worst_deg", Json::object()},
              {"worst_percent", Json::object()}};
  for (const auto& [key, p] : {std::pair{"p50", 0.5}, {"p90", 0.9}, {"p95", 0.95}, {"p99", 0.99}}) {
    out["worst_db"][key] = result.worst_db.quantile(p);
    out["worst_deg"][key] = result.worst_deg.quantile(p);
    out["worst_percent"][key] = result.worst_percent.quantile(p);
  }
  out["worst_db"]["max"] = result.worst_db.max;
  out["worst_deg"]["max"] = result.worst_deg.max;
  out["worst_percent"]["max"] = result.worst_percent.max;
  out["worst_case_db"] = result.worst_case_db;
  if (options.limit_db || options.limit_deg) out["yield"] = within_json(result, options);
  Json frequencies = Json::array();
  for (const Hertz f : result.grid) frequencies.push_back(f.value);
  out["frequency_hz"] = frequencies;
  out["magnitude_db"] = table_json(result.magnitude_db);
  out["phase_deg"] = table_json(result.phase_deg);
  out["ranking"] = Json::array();
  for (const PartRank& rank : result.ranking) {
    out["ranking"].push_back({{"part", rank.part},
                              {"share", rank.share},
                              {"worst_db", rank.worst_db},
                              {"worst_hz", rank.worst_hz.value},
                              {"db_per_percent", rank.db_per_percent}});
  }
  return out;
}

Json to_json(const std::vector<Purchase>& purchases) {
  Json out = Json::array();
  for (const Purchase& one : purchases) {
    out.push_back({{"resistor_percent", one.resistor_percent},
                   {"capacitor_percent", one.capacitor_percent},
                   {"worst_db_p95", one.worst_db_95},
                   {"meets", one.meets}});
  }
  return out;
}

}  // namespace bodesmith::yield
