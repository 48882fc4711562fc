#include <algorithm>

#include "yield/yield.hpp"

namespace bodesmith::yield {

std::vector<Purchase> tolerances_to_buy(const Design& design, const Options& options, double limit_db) {
  Options trial = options;
  trial.samples = 4096;
  trial.checkpoint.clear();
  trial.progress = nullptr;
  std::vector<Purchase> out;
  const Team alone;
  for (const double resistor : {5.0, 1.0, 0.5, 0.1}) {
    for (const double capacitor : {10.0, 5.0, 2.0, 1.0, 0.5}) {
      trial.spread.resistor_percent = resistor;
      trial.spread.capacitor_percent = capacitor;
      const Result result = run_monte_carlo(design, trial, alone);
      Purchase one{resistor, capacitor, result.worst_db.quantile(0.95), false};
      one.meets = one.worst_db_95 <= limit_db;
      out.push_back(one);
    }
  }
  // Wide tolerances are cheap, capacitors more expensive than resistors at the same figure.
  const auto price = [](const Purchase& p) { return 1.0 / p.resistor_percent + 4.0 / p.capacitor_percent; };
  std::stable_sort(out.begin(), out.end(), [&](const Purchase& a, const Purchase& b) {
    if (a.meets != b.meets) return a.meets;
    return a.meets ? price(a) < price(b) : a.worst_db_95 < b.worst_db_95;
  });
  return out;
}

}  // namespace bodesmith::yield
