#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hertz_values.hpp"
#include "base/progress.hpp"
#include "base/provenance.hpp"
#include "base/text.hpp"
#include "numeric/parallel_for.hpp"
#include "synthesis/circuit_file.hpp"
#include "tolerance/counts.hpp"
#include "tolerance/judge.hpp"
#include "tolerance/kernel.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::tolerance {
namespace {

constexpr std::uint64_t kChunk = 1024;  // samples a thread takes at a time
constexpr std::uint64_t kRound =
    128 * 1024;                             // samples of a process between two looks at clock and checkpoint
constexpr double kCheckpointEvery_s = 0.5;  // at the most: a checkpoint is to cost a twentieth of the time
constexpr double kCheckpointsApart = 20.0;
constexpr std::string_view kMagic = "bodesmith yield checkpoint 3\n";

void validate(const Design& design, const Options& options) {
  if (options.samples == 0) throw InputError("yield of 0 samples was asked for, expected at least 1");
  if (options.grid.empty()) throw InputError("yield at no frequency was asked for, expected at least 1");
  constexpr std::size_t kMostFrequencies = 2000;  // each takes 128 KiB of counts in every thread
  if (options.grid.size() > kMostFrequencies) {
    throw InputError(fmt::format("yield at {} frequencies was asked for, expected at most {}",
                                 options.grid.size(), kMostFrequencies));
  }
  const Spread& s = options.spread;
  for (const double percent : {s.resistor_percent, s.capacitor_percent, s.mismatch.unit_percent}) {
    if (!(percent >= 0.0) || percent >= 100.0) {
      throw InputError(
          fmt::format("a tolerance of {} % was asked for, expected 0 or more and less than 100", percent));
    }
  }
  if (!(s.sigmas > 0.0)) throw InputError("the tolerance in standard deviations must be above 0");
  if (!(s.temperature_low_c <= s.temperature_high_c))
    throw InputError("the lowest temperature is above the highest");
  if (!(s.temperature_low_c > -273.15)) throw InputError("the lowest temperature is below absolute zero");
  for (const Hertz f : options.grid) {
    if (!(std::abs(design.wanted(f)) > 0.0)) {
      throw InputError(fmt::format("{}: the response is 0 at {} Hz, expected a frequency where it is not",
                                   design.name, rounded_text(f.value)));
    }
  }
}

void count_block(const Kernel& kernel, const Judge& judge, const Options& options, int count,
                 Counts& counts) {
  double worst_db[Kernel::kBlock] = {}, worst_deg[Kernel::kBlock] = {}, worst_percent[Kernel::kBlock] = {};
  for (std::size_t i = 0; i < options.grid.size(); ++i) {
    const double* const db = kernel.decibel(i);
    const double* const deg = kernel.degrees(i);
    for (int k = 0; k < count; ++k) {
      const double d = std::clamp(db[k], -kMaxDeviationDb, kMaxDeviationDb);
      counts.add(i, d, deg[k]);
      const Judge::Worst worst = judge(i, d, deg[k], {worst_db[k], worst_deg[k], worst_percent[k]});
      worst_db[k] = std::max(worst_db[k], worst.db);
      worst_deg[k] = std::max(worst_deg[k], worst.deg);
      worst_percent[k] = std::max(worst_percent[k], worst.percent);
    }
  }
  for (int k = 0; k < count; ++k) {
    const bool within = (!options.limit_db || worst_db[k] <= *options.limit_db) &&
                        (!options.limit_deg || worst_deg[k] <= *options.limit_deg);
    counts.add_worst(worst_db[k], worst_deg[k], worst_percent[k], within);
  }
}

/// One thread's share of the work.
struct Worker {
  Kernel kernel;
  Counts counts;
};

/// Samples [first, last) of this process: every size()-th chunk from rank() on.
void run_round(std::vector<Worker>& workers, const Judge& judge, const Options& options, std::uint64_t first,
               std::uint64_t last, const Team& team) {
  std::atomic<std::uint64_t> next{static_cast<std::uint64_t>(team.rank())};
  parallel_for(workers.size(), static_cast<int>(workers.size()), [&](std::size_t thread) {
    Worker& worker = workers[thread];
    for (;;) {
      const std::uint64_t chunk = next.fetch_add(static_cast<std::uint64_t>(team.size()));
      const std::uint64_t begin = first + chunk * kChunk;
      if (begin >= last || interrupted()) return;
      const std::uint64_t end = std::min(begin + kChunk, last);
      for (std::uint64_t at = begin; at < end; at += Kernel::kBlock) {
        const int count = static_cast<int>(std::min<std::uint64_t>(Kernel::kBlock, end - at));
        worker.kernel.evaluate(at, count);
        count_block(worker.kernel, judge, options, count, worker.counts);
      }
    }
  });
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

/// As many as are asked for and can have a chunk each.
std::vector<Worker> make_workers(const Design& design, const Options& options, const Result& shape,
                                 std::uint64_t samples_left, const Team& team) {
  int threads = options.threads;
  if (threads <= 0) threads = team.size() > 1 ? 1 : thread_count(0);
  constexpr int kThreadsOfACore = 4;  // more gain nothing, and each has its own counts
  threads = std::min(threads, kThreadsOfACore * thread_count(0));
  const std::uint64_t chunks = (samples_left + kChunk - 1) / kChunk;
  const std::uint64_t count = std::clamp<std::uint64_t>(chunks, 1, static_cast<std::uint64_t>(threads));
  std::vector<Worker> out;
  out.reserve(count);
  for (std::uint64_t t = 0; t < count; ++t) out.push_back({Kernel(design, options), Counts(shape)});
  return out;
}

/// What the whole team has counted, on its leader.
Counts gathered(const Counts& before, const std::vector<Worker>& workers, const Team& team) {
  Counts out = before;
  for (const Worker& worker : workers) out.merge(worker.counts);
  out.gather(team);
  return out;
}

}  // namespace

Spread::Spread(const Design& design) {
  if (design.netlist) Tolerances::operator=(design.netlist->tolerances);
  if (design.board) mismatch = design.board->mismatch;
}

std::string job_text(const Options& options, const Provenance& from) {
  const Spread& s = options.spread;
  std::string text = fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(s.kind), s.sigmas,
                                 s.resistor_percent, s.capacitor_percent, s.mismatch.unit_percent,
                                 s.mismatch.systematic_units, s.temperature_low_c, s.temperature_high_c,
                                 s.resistor_ppm_per_k, s.capacitor_ppm_per_k, options.limit_db.value_or(-1.0),
                                 options.limit_deg.value_or(-1.0));
  for (const Hertz f : options.grid) text += " " + number_text(f.value);
  for (const InputFile& file : from.inputs) text += " " + file.sha256;
  return text;
}

std::string_view to_string(Spread::Kind kind) {
  constexpr std::array kWords = {"uniform", "gaussian", "corners"};
  return kWords.at(static_cast<std::size_t>(kind));
}

Result run_monte_carlo(const Design& design, const Options& options, const Team& team) {
  validate(design, options);
  const Judge judge(design, options.grid);
  Result result = expected_result(design, options, judge);
  Counts before(result);  // of this process; the leader's holds what a checkpoint gave
  std::uint64_t done = team.leads() ? take_up(design, options, before) : 0;
  done = team.from_leader(done);
  std::vector<Worker> workers =
      make_workers(design, options, result, options.samples - std::min(done, options.samples), team);

  const Stopwatch since;
  double kept_at_s = 0.0;
  double next_after_s = kCheckpointEvery_s;
  const std::uint64_t round = kRound * static_cast<std::uint64_t>(team.size());
  while (done < options.samples) {
    const std::uint64_t last = std::min(done + round, options.samples);
    run_round(workers, judge, options, done, last, team);
    // One stops, all stop: the leader decides, what the others left out of the round is not counted.
    const bool stop = team.from_leader(interrupted() ? 1 : 0) != 0;
    if (stop || interrupted()) throw Interrupted();
    done = last;
    if (options.progress) options.progress(static_cast<double>(done) / static_cast<double>(options.samples));
    if (options.checkpoint.empty() || done >= options.samples) continue;
    if (team.from_leader(since.seconds() - kept_at_s > next_after_s ? 1 : 0) == 0) continue;
    const double begun_s = since.seconds();
    const Counts all = gathered(before, workers, team);
    if (team.leads()) {
      write_file(options.checkpoint,
                 std::string(kMagic) + checkpoint_key(design, options) + "\n" + all.bytes());
    }
    kept_at_s = since.seconds();
    next_after_s = std::max(kCheckpointEvery_s, kCheckpointsApart * (kept_at_s - begun_s));
  }
  gathered(before, workers, team).put_into(result);
  if (team.leads() && !options.checkpoint.empty()) {
    std::error_code ignored;
    std::filesystem::remove(options.checkpoint, ignored);
  }
  return result;
}

std::vector<Purchase> tolerances_to_buy(const Design& design, const Options& options, double limit_db) {
  Options trial = options;
  trial.samples =
      std::min<std::uint64_t>(options.samples, 4096);  // more tell no tolerance from its neighbour
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
  std::ranges::stable_sort(out, [&](const Purchase& a, const Purchase& b) {
    if (a.meets != b.meets) return a.meets;
    return a.meets ? price(a) < price(b) : a.worst_db_95 < b.worst_db_95;
  });
  return out;
}

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
              {"tolerances", synthesis::to_json(options.spread)},
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
  out["frequency_hz"] = hertz_values(result.grid);
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

}  // namespace bodesmith::tolerance
