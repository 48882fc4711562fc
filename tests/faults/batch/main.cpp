// Blind boards: circuits that `bodesmith spice` made, soldered with parts of a tolerance and real op-amps, most of them
// with something wrong, measured by ngspice with noise, and diagnosed. Prints what docs/faults.md quotes.
//   faults_batch [--seen] [--truth] [--keep DIR] [--capacitor-percent P] COUNT SEED FAULTS CIRCUIT.json…   (cmake --build build --target faults_batch)
// FAULTS: how many each board has; -1: drawn, one in eight good, one in eight with two. --seen: two faults are drawn again until both
// can be seen. --truth: prints how likely the likeliest explanation by what is wrong is, beside the one that was found.
// --keep: drawn boards are written there, and read where they are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>

#include "../boards/built.hpp"
#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "faults/circuit_board.hpp"
#include "faults/diagnosis.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::faults {
namespace {

struct Tally {
  int boards = 0;
  int named = 0;
  int extra = 0;  ///< named with something else beside it
  int tied = 0;
  int missed = 0;  ///< "nothing wrong"
  int uncertain = 0;
  int wrong = 0;
  int unexplained = 0;
};

bool accuses(const Suspect& suspect, const std::vector<std::string>& names) {
  return std::any_of(suspect.best.faults.begin(), suspect.best.faults.end(), [&](const Fault* fault) {
    return std::any_of(fault->parts.begin(), fault->parts.end(), [&](const std::string& part) {
      return std::find(names.begin(), names.end(), part) != names.end();
    });
  });
}

/// What is known of a board when it comes to be diagnosed, and what is wrong with it.
struct MeasuredBoard {
  Channel channel;
  std::vector<std::vector<std::string>> wrong;  ///< BuiltBoard::wrong
  std::string words;
  double change = 0.0;  ///< largest, against the good board
};

bool accuses_all(const Suspect& suspect, const MeasuredBoard& board) {
  return std::all_of(board.wrong.begin(), board.wrong.end(),
                     [&](const auto& names) { return accuses(suspect, names); });
}

void count(const Diagnosis& d, const MeasuredBoard& board, Tally& tally) {
  ++tally.boards;
  if (d.verdict == Verdict::nothing_wrong) {
    ++tally.missed;
  } else if (d.verdict == Verdict::uncertain) {
    ++tally.uncertain;
  } else if (d.verdict == Verdict::unexplained) {
    ++tally.unexplained;
  } else if (d.verdict != Verdict::tie) {
    const bool right = accuses_all(d.suspects[0], board);
    const bool more = d.suspects[0].best.faults.size() > board.wrong.size();
    ++(!right ? tally.wrong : more ? tally.extra : tally.named);
  } else {
    const bool in = std::any_of(d.suspects.begin(), d.suspects.begin() + static_cast<std::ptrdiff_t>(d.tied),
                                [&](const Suspect& s) { return accuses_all(s, board); });
    ++(in ? tally.tied : tally.wrong);
  }
}

/// Relative to the good board, or to a thousandth of the input where that is more.
double largest_change(const std::vector<std::complex<double>>& a,
                      const std::vector<std::complex<double>>& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    out = std::max(out, std::abs(a[i] - b[i]) / std::max(std::abs(b[i]), 1e-3));
  return out;
}

/// Points below this part of the good board's largest gain do not count when it is asked whether a fault can be seen.
constexpr double kSeenAbove = 0.01;
constexpr double kSeen = 0.08;

bool differs(const std::vector<std::complex<double>>& a, const std::vector<std::complex<double>>& b,
             const std::vector<std::complex<double>>& good) {
  double largest = 0.0;
  for (const auto& h : good) largest = std::max(largest, std::abs(h));
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::abs(good[i]) < kSeenAbove * largest) continue;
    if (std::abs(a[i] - b[i]) > kSeen * std::abs(good[i])) return true;
  }
  return false;
}

/// Two faults of which neither alone looks like both.
BuiltBoard with_two_seen(const BuiltBoard& good, const std::vector<Hertz>& grid, Random& random) {
  constexpr int kMostDraws = 60;
  const auto healthy = response_of(good, grid);
  BuiltBoard both = good;
  for (int draw = 0; draw < kMostDraws; ++draw) {
    BuiltBoard first = good;
    spoil(first, random);
    both = first;
    Random same = random;
    spoil(both, random);
    BuiltBoard second = good;
    spoil(second, same);
    if (second.wrong.front() != both.wrong.back() || both.wrong.front() == both.wrong.back()) continue;
    const auto together = response_of(both, grid);
    if (differs(response_of(first, grid), together, healthy) &&
        differs(response_of(second, grid), together, healthy))
      break;
  }
  return both;
}

/// The likeliest explanation that accuses exactly what is wrong: what a search that reaches everything would find at least.
Finding truth_of(const Board& board, const MeasuredBoard& built, const Diagnosis& d) {
  constexpr int kTeeth = 11;
  const std::vector<double> shares = log_priors(d.faults);
  const auto accusing = [&](const std::vector<std::string>& names) {
    std::vector<const Fault*> out;
    for (const Fault& fault : d.faults) {
      if (std::any_of(fault.parts.begin(), fault.parts.end(), [&](const std::string& part) {
            return std::find(names.begin(), names.end(), part) != names.end();
          }))
        out.push_back(&fault);
    }
    return out;
  };
  const auto prior_of = [&](const Fault* fault) {
    return shares[static_cast<std::size_t>(fault - d.faults.data())];
  };
  Finding best;
  best.log_evidence = -1e300;
  const auto try_these = [&](const std::vector<const Fault*>& faults, double log_prior) {
    Finding start;
    start.faults = faults;
    start.log_prior = log_prior;
    double largest = -1e300;
    for (const double a : comb(*faults[0], kTeeth)) {
      for (const double b : faults.size() > 1 ? comb(*faults[1], kTeeth) : std::vector{0.0}) {
        Finding tried = start;
        tried.sizes = {a, b};
        tried.sizes.resize(faults.size());
        const double density = Likelihood(board, board.predict(tried.effect()), d.noise).log_density();
        if (density > largest) start.sizes = tried.sizes;
        largest = std::max(largest, density);
      }
    }
    const Finding found = refined(board, polished(board, start, d.noise), d.faults, d.noise);
    if (found.log_weight() > best.log_weight()) best = found;
  };
  const Priors priors;
  const auto firsts = accusing(built.wrong.front());
  if (built.wrong.size() == 1) {
    for (const Fault* fault : firsts) try_these({fault}, std::log(priors.one_fault) + prior_of(fault));
    return best;
  }
  for (const Fault* a : firsts) {
    for (const Fault* b : accusing(built.wrong.back()))
      try_these({a, b}, std::log(priors.two_faults) + prior_of(a) + prior_of(b));
  }
  return best;
}

struct Request {
  bool seen = false;
  bool truth = false;
  std::filesystem::path keep;  ///< folder; empty: boards are not kept
  double capacitor_percent = 1.0;
};

MeasuredBoard drawn(const synthesis::CircuitFile& made, int faults, const Request& request, Random& random) {
  BuiltBoard board = good_board(made.circuit, 1.0, request.capacitor_percent, random);
  const std::vector<Hertz> grid =
      log_grid({Hertz{made.band.from.value / 5.0}, Hertz{made.band.to.value * 5.0}}, 60);
  const auto good = response_of(board, grid);
  if (faults == 2 && request.seen) {
    board = with_two_seen(board, grid, random);
  } else {
    for (int i = 0; i < faults; ++i) spoil(board, random);
  }
  const auto response = faults == 0 ? good : response_of(board, grid);
  const bool with_phase = random.uniform() < 0.8;
  return {measured(response, grid, 0.02, 0.1, with_phase, random), board.wrong, board.words,
          largest_change(response, good)};
}

/// Drawing takes longer than diagnosing: a board that was drawn before is read.
MeasuredBoard drawn_or_kept(const std::filesystem::path& kept, const synthesis::CircuitFile& made, int faults,
                            const Request& request, Random& random) {
  if (std::ifstream file(kept); !kept.empty() && file) {
    const Json json = Json::parse(file);
    MeasuredBoard out;
    out.channel.file = kept.string();
    for (const double hz : json.at("frequency_hz")) out.channel.grid.push_back(Hertz{hz});
    json.at("log_gain").get_to(out.channel.log_gain);
    json.at("phase_rad").get_to(out.channel.phase_rad);
    json.at("wrong").get_to(out.wrong);
    json.at("words").get_to(out.words);
    json.at("change").get_to(out.change);
    out.channel.measured_points = out.channel.grid.size();
    return out;
  }
  MeasuredBoard out = drawn(made, faults, request, random);
  if (kept.empty()) return out;
  std::vector<double> frequency_hz;
  for (const Hertz f : out.channel.grid) frequency_hz.push_back(f.value);
  std::ofstream(kept) << Json{{"frequency_hz", frequency_hz},
                              {"log_gain", out.channel.log_gain},
                              {"phase_rad", out.channel.phase_rad},
                              {"wrong", out.wrong},
                              {"words", out.words},
                              {"change", out.change}};
  return out;
}

int run(int boards, std::uint64_t seed, int wanted, const std::vector<std::string>& files,
        const Request& request) {
  std::map<std::string, Tally> tallies;
  std::vector<double> seconds;
  for (int n = 0; n < boards; ++n) {
    Random random(mixed_bits(seed + static_cast<std::uint64_t>(n)));
    const std::string& file = files[static_cast<std::size_t>(n) % files.size()];
    Provenance from;
    const auto made = synthesis::CircuitFile::from_node(read_document(file, from));
    const int faults = wanted >= 0 ? wanted : std::array{0, 1, 1, 1, 1, 1, 1, 2}[random.below(8)];
    const std::filesystem::path kept =
        request.keep.empty()
            ? request.keep
            : request.keep / fmt::format("{}_{}_{}{}.json", seed, faults, n, request.seen ? "_seen" : "");
    const MeasuredBoard board = drawn_or_kept(kept, made, faults, request, random);
    const bool with_phase = !board.channel.phase_rad.empty();
    const double change = board.change;
    const Measurement measurement{{board.channel}};
    const std::clock_t started = std::clock();  // of the processor: other work does not count
    Spread spread;
    spread.capacitor_percent = request.capacitor_percent;
    const CircuitBoard designed(made.circuit, measurement, spread);
    const Diagnosis d = diagnose_board(designed, DiagnosisOptions());
    seconds.push_back(static_cast<double>(std::clock() - started) / CLOCKS_PER_SEC);
    const char* what = faults == 0     ? "good"
                       : faults == 2   ? "two faults"
                       : change < 0.03 ? "one, hidden"
                                       : "one fault";
    Tally& tally = tallies[what];
    const Tally before = tally;
    count(d, board, tally);
    std::string suspects;
    for (std::size_t i = 0; i < std::min<std::size_t>(d.suspects.size(), std::max<std::size_t>(d.tied, 2));
         ++i)
      suspects += fmt::format(" {} {:.3f}", d.suspects[i].site, d.suspects[i].probability);
    const char* outcome = tally.named > before.named           ? "named"
                          : tally.tied > before.tied           ? "tied"
                          : tally.missed > before.missed       ? "nothing"
                          : tally.uncertain > before.uncertain ? "uncertain"
                          : tally.wrong > before.wrong         ? "WRONG"
                                                               : "unexplained";
    if (request.truth && faults > 0) {
      const Finding truth = truth_of(designed, board, d);
      const Finding& said = d.suspects.front().best;
      fmt::print("     truth: {} weight {:.1f} misfit {:.1f}, said {:.1f} misfit {:.1f} of {:.0f}: {:+.1f}\n",
                 truth.site(), truth.log_weight(), truth.misfit, said.log_weight(), said.misfit, said.rows,
                 truth.log_weight() - said.log_weight());
      for (const Finding& f : {truth, said}) {
        for (std::size_t i = 0; i < f.faults.size(); ++i)
          fmt::print("       {}{}", f.faults[i]->words(f.sizes[i]), i + 1 == f.faults.size() ? "\n" : ";");
      }
    }
    fmt::print(
        "{:4} {:11} {:11} {:.1f} s change {:.2g} {} | good {:.3g} (wider {:.3g}) misfit {:.2f} |{} | {}\n", n,
        what, outcome, seconds.back(), change, with_phase ? "" : "(magnitude)", d.good_probability,
        d.wider_probability, d.misfit, suspects, board.words);
    std::fflush(stdout);
  }
  fmt::print(
      "\n| boards | number | named | named beside another | tie with it | nothing wrong | uncertain | wrong | unexplained |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [what, t] : tallies)
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", what, t.boards, t.named, t.extra, t.tied,
               t.missed, t.uncertain, t.wrong, t.unexplained);
  std::sort(seconds.begin(), seconds.end());
  fmt::print("median {:.2f} s, longest {:.2f} s\n", seconds[seconds.size() / 2], seconds.back());
  return 0;
}

}  // namespace
}  // namespace bodesmith::faults

int main(int argc, char** argv) {
  bodesmith::faults::Request request;
  std::vector<std::string> words(argv + 1, argv + argc);
  while (!words.empty() && words.front().starts_with("--")) {
    if (words.front() == "--seen") {
      request.seen = true;
    } else if (words.front() == "--truth") {
      request.truth = true;
    } else if (words.front() == "--keep" && words.size() > 1) {
      words.erase(words.begin());
      request.keep = words.front();
    } else if (words.front() == "--capacitor-percent" && words.size() > 1) {
      words.erase(words.begin());
      request.capacitor_percent = std::strtod(words.front().c_str(), nullptr);
    } else {
      words.clear();
      break;
    }
    words.erase(words.begin());
  }
  if (words.size() < 4 || !(request.capacitor_percent > 0.0)) {
    fmt::print(
        stderr,
        "usage: faults_batch [--seen] [--truth] [--keep DIR] [--capacitor-percent P] COUNT SEED FAULTS CIRCUIT.json...\n");
    return 2;
  }
  return bodesmith::faults::run(std::atoi(words[0].c_str()), std::strtoull(words[1].c_str(), nullptr, 10),
                                std::atoi(words[2].c_str()), {words.begin() + 3, words.end()}, request);
}
