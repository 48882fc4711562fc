#include "yield/yield.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <thread>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/progress.hpp"
#include "base/provenance.hpp"
#include "base/text.hpp"
#include "yield/counts.hpp"
#include "yield/kernel.hpp"
#include "yield/sensitivity.hpp"

namespace bodesmith::yield {

std::string_view to_string(Spread::Kind kind) {
  switch (kind) {
    case Spread::Kind::uniform:
      return "uniform";
    case Spread::Kind::gaussian:
      return "gaussian";
    case Spread::Kind::corners:
      return "corners";
  }
  return "";
}

namespace {

constexpr std::uint64_t kChunk = 1024;        // samples a thread takes at a time
constexpr std::uint64_t kRound = 128 * 1024;  // samples between two looks at the clock and the checkpoint
constexpr double kFar = 400.0;                // dB: a null of the response
constexpr std::string_view kMagic = "bodesmith yield checkpoint 1\n";

void check(const Design& design, const Options& options) {
  if (options.samples == 0) throw InputError("yield of 0 samples was asked for, expected at least 1");
  if (options.grid.empty()) throw InputError("yield at no frequency was asked for, expected at least 1");
  const Spread& s = options.spread;
  for (const double percent : {s.resistor_percent, s.capacitor_percent, s.unit_capacitor_percent}) {
    if (!(percent >= 0.0) || percent >= 100.0) {
      throw InputError(
          fmt::format("a tolerance of {} % was asked for, expected 0 or more and less than 100", percent));
    }
  }
  if (!(s.sigmas > 0.0)) throw InputError("the tolerance in standard deviations must be above 0");
  if (!(s.temperature_low_c <= s.temperature_high_c))
    throw InputError("the lowest temperature is above the highest");
  for (const Hertz f : options.grid) {
    if (!(std::abs(design.reference(f)) > 0.0)) {
      throw InputError(fmt::format("{}: the response is 0 at {} Hz, expected a frequency where it is not",
                                   design.name, rounded_text(f.value)));
    }
  }
}

/// Ranges of the histograms from the sensitivities; worst case and ranking.
Result empty_result(const Design& design, const Options& options) {
  Result out;
  out.name = design.name;
  out.grid = options.grid;
  const Sensitivity s = sensitivity_of(design, options);
  // Twice the first-order worst case: far enough for six standard deviations and for curvature.
  constexpr double kRoom = 2.0;
  double worst_db = 0.0, worst_deg = 0.0, largest_variance = -1.0;
  size_t loudest = 0;
  for (size_t i = 0; i < options.grid.size(); ++i) {
    double db = 0.0, deg = 0.0, variance = 0.0;
    for (size_t p = 0; p < design.parts.size(); ++p) {
      db += std::abs(s.db_per_percent[p][i]) * s.limit_percent[p];
      deg += std::abs(s.deg_per_percent[p][i]) * s.limit_percent[p];
      variance += std::pow(s.db_per_percent[p][i] * s.limit_percent[p], 2);
    }
    if (variance > largest_variance) {
      largest_variance = variance;
      loudest = i;
    }
    const std::complex<double> offset = design.nominal(options.grid[i]) / design.reference(options.grid[i]);
    const double off_db = std::clamp(std::abs(to_decibel(std::abs(offset))), 0.0, kFar);
    out.worst_case_db = std::max(out.worst_case_db, db + off_db);
    const double range_db = std::min(kRoom * (db + off_db) + 1e-6, kFar);
    const double range_deg = std::min(kRoom * (deg + std::abs(to_degrees(std::arg(offset)))) + 1e-6, 180.0);
    worst_db = std::max(worst_db, range_db);
    worst_deg = std::max(worst_deg, range_deg);
    out.magnitude_db.push_back({-range_db, range_db, {}, 0.0, 0.0});
    out.phase_deg.push_back({-range_deg, range_deg, {}, 0.0, 0.0});
  }
  out.worst_db = {0.0, worst_db, {}, 0.0, 0.0};
  out.worst_deg = {0.0, worst_deg, {}, 0.0, 0.0};
  for (size_t p = 0; p < design.parts.size(); ++p) {
    PartRank rank;
    rank.part = design.parts[p].name;
    for (size_t i = 0; i < options.grid.size(); ++i) {
      const double db = std::abs(s.db_per_percent[p][i]) * s.limit_percent[p];
      if (db > rank.worst_db || i == 0) {
        rank.worst_db = db;
        rank.worst_hz = options.grid[i];
        rank.db_per_percent = s.db_per_percent[p][i];
      }
    }
    const double own = s.db_per_percent[p][loudest] * s.limit_percent[p];
    rank.share = largest_variance > 0.0 ? own * own / largest_variance : 0.0;
    out.ranking.push_back(std::move(rank));
  }
  std::stable_sort(out.ranking.begin(), out.ranking.end(),
                   [](const PartRank& a, const PartRank& b) { return a.share > b.share; });
  return out;
}

void count_block(const Kernel& kernel, const Options& options, int count, Counts& counts) {
  double worst_db[Kernel::kBlock] = {}, worst_deg[Kernel::kBlock] = {};
  for (size_t i = 0; i < options.grid.size(); ++i) {
    const double* const db = kernel.decibel(i);
    const double* const deg = kernel.degrees(i);
    for (int k = 0; k < count; ++k) {
      const double d = std::clamp(db[k], -kFar, kFar);
      counts.add(i, d, deg[k]);
      worst_db[k] = std::max(worst_db[k], std::abs(d));
      worst_deg[k] = std::max(worst_deg[k], std::abs(deg[k]));
    }
  }
  for (int k = 0; k < count; ++k) {
    const bool within = (!options.limit_db || worst_db[k] <= *options.limit_db) &&
                        (!options.limit_deg || worst_deg[k] <= *options.limit_deg);
    counts.add_worst(worst_db[k], worst_deg[k], within);
  }
}

/// Samples [first, last) of this process: every size()-th chunk from rank() on.
void run_round(std::vector<Kernel>& kernels, std::vector<Counts>& counts, const Options& options,
               std::uint64_t first, std::uint64_t last, const Team& team) {
  std::atomic<std::uint64_t> next{static_cast<std::uint64_t>(team.rank())};
  const auto work = [&](size_t thread) {
    for (;;) {
      const std::uint64_t chunk = next.fetch_add(static_cast<std::uint64_t>(team.size()));
      const std::uint64_t begin = first + chunk * kChunk;
      if (begin >= last || interrupted()) return;
      const std::uint64_t end = std::min(begin + kChunk, last);
      for (std::uint64_t at = begin; at < end; at += Kernel::kBlock) {
        const int count = static_cast<int>(std::min<std::uint64_t>(Kernel::kBlock, end - at));
        kernels[thread].evaluate(at, count);
        count_block(kernels[thread], options, count, counts[thread]);
      }
    }
  };
  std::vector<std::thread> others;
  for (size_t t = 1; t < kernels.size(); ++t) others.emplace_back(work, t);
  work(0);
  for (std::thread& thread : others) thread.join();
}

std::string checkpoint_key(const Design& design, const Options& options) {
  return sha256_hex(fmt::format("{}|{}|{}|{}|{}", options.job, design.name, options.samples, options.seed,
                                options.grid.size()));
}

/// Where to go on, with the counts so far; 0 when there is nothing (valid) to take up.
std::uint64_t take_up(const Design& design, const Options& options, Counts& counts) {
  std::error_code ignored;
  if (options.checkpoint.empty() || !std::filesystem::exists(options.checkpoint, ignored)) return 0;
  const std::string text = read_file(options.checkpoint);
  const std::string head = std::string(kMagic) + checkpoint_key(design, options) + "\n";
  if (!text.starts_with(head) || !counts.from_bytes(std::string_view(text).substr(head.size()))) return 0;
  return counts.samples();
}

}  // namespace

double Histogram::quantile(double p) const {
  const std::uint64_t total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  if (total == 0) return 0.0;
  if (p <= 0.0) return least;
  if (p >= 1.0) return greatest;
  const double target = p * static_cast<double>(total);
  const double width = (high - low) / static_cast<double>(counts.size());
  double before = 0.0;
  for (size_t i = 0; i < counts.size(); ++i) {
    const double here = static_cast<double>(counts[i]);
    if (before + here >= target && here > 0.0) {
      return std::clamp(low + width * (static_cast<double>(i) + (target - before) / here), least, greatest);
    }
    before += here;
  }
  return greatest;
}

Result run_monte_carlo(const Design& design, const Options& options, const Team& team) {
  check(design, options);
  Result result = empty_result(design, options);
  Counts total(result);  // of this process; the leader's holds what a checkpoint gave
  std::uint64_t done = team.leads() ? take_up(design, options, total) : 0;
  done = team.from_leader(done);

  int threads = options.threads;
  if (threads <= 0)
    threads = team.size() > 1 ? 1 : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const std::uint64_t chunks = (options.samples - std::min(done, options.samples) + kChunk - 1) / kChunk;
  threads = static_cast<int>(std::clamp<std::uint64_t>(chunks, 1, static_cast<std::uint64_t>(threads)));
  std::vector<Kernel> kernels;
  kernels.reserve(static_cast<size_t>(threads));
  std::vector<Counts> counts;
  for (int t = 0; t < threads; ++t) {
    kernels.emplace_back(design, options);
    counts.emplace_back(result);
  }

  Stopwatch since;
  double kept_at = 0.0;
  Counts whole = total;
  while (done < options.samples) {
    const std::uint64_t last = std::min(done + kRound, options.samples);
    run_round(kernels, counts, options, done, last, team);
    // One stops, all stop: the leader decides, what the others left out of the round is not counted.
    const bool stop = team.from_leader(interrupted() ? 1 : 0) != 0;
    if (stop || interrupted()) throw Interrupted();
    done = last;
    if (options.progress) options.progress(static_cast<double>(done) / static_cast<double>(options.samples));
    if (options.checkpoint.empty() || done >= options.samples) continue;
    const bool keep = team.from_leader(since.seconds() - kept_at > 0.5 ? 1 : 0) != 0;
    if (!keep) continue;
    whole = total;
    for (const Counts& one : counts) whole.merge(one);
    whole.gather(team);
    if (team.leads()) {
      write_file(options.checkpoint,
                 std::string(kMagic) + checkpoint_key(design, options) + "\n" + whole.bytes());
    }
    kept_at = since.seconds();
  }
  for (const Counts& one : counts) total.merge(one);
  total.gather(team);
  total.put_into(result);
  if (team.leads() && !options.checkpoint.empty()) {
    std::error_code ignored;
    std::filesystem::remove(options.checkpoint, ignored);
  }
  return result;
}

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
  // Wide tolerances are cheap, capacitors dearer than resistors at the same figure.
  const auto price = [](const Purchase& p) { return 1.0 / p.resistor_percent + 4.0 / p.capacitor_percent; };
  std::stable_sort(out.begin(), out.end(), [&](const Purchase& a, const Purchase& b) {
    if (a.meets != b.meets) return a.meets;
    return a.meets ? price(a) < price(b) : a.worst_db_95 < b.worst_db_95;
  });
  return out;
}

Json to_json(const Result& result, const Options& options) {
  static const std::pair<const char*, double> kQuantiles[] = {
      {"p0_135", 0.00135}, {"p2_5", 0.025}, {"p50", 0.5}, {"p97_5", 0.975}, {"p99_865", 0.99865}};
  Json out;
  out["name"] = result.name;
  out["samples"] = result.samples;
  out["worst_db"] = Json::object();
  out["worst_deg"] = Json::object();
  for (const auto& [key, p] : {std::pair{"p50", 0.5}, {"p90", 0.9}, {"p95", 0.95}, {"p99", 0.99}}) {
    out["worst_db"][key] = result.worst_db.quantile(p);
    out["worst_deg"][key] = result.worst_deg.quantile(p);
  }
  out["worst_db"]["max"] = result.worst_db.greatest;
  out["worst_deg"]["max"] = result.worst_deg.greatest;
  out["worst_case_db"] = result.worst_case_db;
  if (options.limit_db || options.limit_deg) {
    const double n = static_cast<double>(result.samples), share = static_cast<double>(result.within) / n;
    // Wilson's interval, 95 %.
    const double z = 1.959963984540054, zz = z * z / n;
    const double middle = (share + 0.5 * zz) / (1.0 + zz);
    const double half = z * std::sqrt(share * (1.0 - share) / n + 0.25 * zz / n) / (1.0 + zz);
    out["yield"] = {{"within", result.within},
                    {"percent", 100.0 * share},
                    {"percent_low", 100.0 * std::max(0.0, middle - half)},
                    {"percent_high", 100.0 * std::min(1.0, middle + half)}};
    if (options.limit_db) out["yield"]["limit_db"] = *options.limit_db;
    if (options.limit_deg) out["yield"]["limit_deg"] = *options.limit_deg;
  }
  Json frequencies = Json::array();
  for (const Hertz f : result.grid) frequencies.push_back(f.value);
  out["frequency_hz"] = frequencies;
  const auto table = [&](const std::vector<Histogram>& all) {
    Json columns = Json::object();
    columns["min"] = Json::array();
    for (const auto& [key, p] : kQuantiles) columns[key] = Json::array();
    columns["max"] = Json::array();
    for (const Histogram& h : all) {
      columns["min"].push_back(h.least);
      for (const auto& [key, p] : kQuantiles) columns[key].push_back(h.quantile(p));
      columns["max"].push_back(h.greatest);
    }
    return columns;
  };
  out["magnitude_db"] = table(result.magnitude_db);
  out["phase_deg"] = table(result.phase_deg);
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

}  // namespace bodesmith::yield
