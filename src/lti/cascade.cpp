#include "lti/cascade.hpp"

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"

namespace bodesmith {
namespace {

/// JSON has no infinity: what a cascade file says for it.
constexpr double kInfiniteInJson = 1e300;

}  // namespace

double FractionalLeadLag::log_magnitude(RadPerSecond w) const {
  // (1 + a^2) / (1 + b^2) = 1 + (a^2 - b^2)/(1 + b^2), a = lw, b = xlw: exact near w = 0, where both tend
  // to 1. With a < b the reciprocal is taken, so that the argument of log1p is never close to -1.
  const double a = lambda_s * w.value;
  const double b = x * a;
  if (a > 1e150 || b > 1e150) return -beta * std::log(x);
  return a >= b ? 0.5 * beta * std::log1p((a - b) * (a + b) / (1.0 + b * b))
                : -0.5 * beta * std::log1p((b - a) * (b + a) / (1.0 + a * a));
}

double FractionalLeadLag::phase_rad(RadPerSecond w) const {
  const double a = lambda_s * w.value;
  const double b = x * a;
  if (a > 1e150 || b > 1e150) return 0.0;
  // atan a - atan b in one arctangent: no cancellation.
  return beta * std::atan2(a - b, 1.0 + a * b);
}

Complex FractionalLeadLag::response(RadPerSecond w) const {
  return std::polar(std::exp(log_magnitude(w)), phase_rad(w));
}

Complex Cascade::response(RadPerSecond w) const {
  double log_magnitude = 0.0;
  double phase = 0.0;
  for (const FractionalLeadLag& term : terms) {
    log_magnitude += term.log_magnitude(w);
    phase += term.phase_rad(w);
  }
  return gain * std::polar(std::exp(log_magnitude), phase);
}

double Cascade::magnitude_db(RadPerSecond w) const {
  double log_magnitude = 0.0;
  for (const FractionalLeadLag& term : terms) log_magnitude += term.log_magnitude(w);
  return to_decibel(gain) + kDecibelPerNeper * log_magnitude;
}

Band Cascade::corner_band() const {
  double low = INFINITY;
  double high = 0.0;
  for (const FractionalLeadLag& term : terms) {
    low = std::min(low, term.low_corner().hz().value);
    high = std::max(high, term.high_corner().hz().value);
  }
  if (fit) {
    for (const FitPoint& point : fit->points) {
      low = std::min(low, point.frequency.value);
      high = std::max(high, point.frequency.value);
    }
  }
  return {Hertz{low}, Hertz{high}};
}

Cascade Cascade::from_node(const Node& node) {
  node.expect_schema("cascade");
  Cascade out;
  out.gain = node.number_or("gain", 1.0);
  if (out.gain == 0.0) node.at("gain").fail("is 0, expected a gain other than 0");
  for (const Node& item : node.at("terms").items()) {
    FractionalLeadLag term{.lambda_s = item.at("lambda_s").positive(), .x = item.at("x").positive()};
    if (term.x == 1.0) item.at("x").fail("is 1, expected corners that differ (x above or below 1)");
    term.beta = item.at("beta").number();
    out.terms.push_back(term);
  }
  if (node.has("fit")) {
    const Node fit = node.at("fit");
    FitSummary summary;
    for (const Node& item : fit.at("points").items()) {
      summary.points.push_back({Hertz{item.at("frequency_hz").positive()}, item.at("wanted_db").number(),
                                item.at("got_db").number()});
    }
    summary.rms_db = fit.number_or("rms_db", 0.0);
    summary.max_db = fit.number_or("max_db", 0.0);
    summary.condition_number = fit.number_or("condition_number", 0.0);
    out.fit = summary;
  }
  return out;
}

Cascade Cascade::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

Json Cascade::to_json() const {
  Json out = {{"gain", gain}, {"terms", Json::array()}};
  for (const FractionalLeadLag& term : terms) {
    out["terms"].push_back({{"lambda_s", term.lambda_s}, {"x", term.x}, {"beta", term.beta}});
  }
  if (fit) {
    Json points = Json::array();
    for (const FitPoint& point : fit->points) {
      points.push_back({{"frequency_hz", point.frequency.value},
                        {"wanted_db", point.wanted_db},
                        {"got_db", point.got_db}});
    }
    out["fit"] = {{"points", points},
                  {"rms_db", fit->rms_db},
                  {"max_db", fit->max_db},
                  {"condition_number", std::min(fit->condition_number, kInfiniteInJson)}};
  }
  return out;
}

}  // namespace bodesmith
