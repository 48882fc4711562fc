#include "gap/batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/progress.hpp"
#include "chain/model_file.hpp"
#include "gap/settle.hpp"

namespace hidden {

using namespace bodesmith;

Outcome solve(const Case& c, int threads) {
  Outcome o;
  o.hidden_case = &c;
  const auto chain = chain::model_from_node(parse_toml(c.model, "model.toml"));
  gap::TimeExperiment train(c.train);
  gap::TimeExperiment holdout(c.holdout);
  train.set_skip(gap::unscored_samples(chain, c.train));
  holdout.set_skip(gap::unscored_samples(chain, c.holdout));
  gap::SearchOptions options;
  options.threads = threads;
  Stopwatch watch;
  const auto result = gap::search(chain, {&train}, {&holdout}, options);
  o.seconds = watch.seconds();
  o.verdict = gap::verdict_of(result, gap::rms_of(result.final, {&train}), options.enough);
  for (const auto& s : result.steps) {
    o.named.emplace_back(s.effect->name());
    o.tied.insert(o.tied.end(), s.tied_with.begin(), s.tied_with.end());
  }
  if (std::getenv("GAP_DEBUG") != nullptr) {
    const auto show = [&](const std::vector<gap::Ranked>& ranking) {
      for (const auto& r : ranking) {
        fmt::print(
            "      {:<24} {:<15} score {:.3f} train {:.4f} holdout {:.4f} z {:.1f}/{:.1f} cond {:.1e} {}",
            r.effect->name(), r.placed, r.score, r.train_rms / c.noise_rms, r.holdout_rms / c.noise_rms,
            r.train_z, r.z, r.condition_number, r.word);
        if (!r.model.terms().empty()) {
          for (const auto& u : r.model.terms().back().unknowns) fmt::print(" {}={:.4g}", u.name, u.value);
        }
        fmt::print("\n");
      }
    };
    fmt::print("    base train {:.3f} holdout {:.3f} floor {} {:.3f}\n",
               gap::rms_of(result.base, {&train}) / c.noise_rms,
               gap::rms_of(result.base, {&holdout}) / c.noise_rms, result.floor.word(),
               result.floor.rms / c.noise_rms);
    for (const auto& s : result.steps) {
      fmt::print("    step {} control {:.3f}\n", s.effect->name(), s.control_gain);
      show(s.ranking);
    }
    fmt::print("    refused\n");
    show(result.refused);
    for (const auto& s : result.structure) fmt::print("    sign: {} {:.2f}\n", s.what, s.strength);
    for (const auto& n : result.notes) fmt::print("    note: {}\n", n);
  }
  const double first = gap::rms_of(result.base, {&holdout});
  const double last = gap::rms_of(result.final, {&holdout});
  const double noise = c.noise_rms;
  o.noise_share = last / noise;
  const double open = std::sqrt(std::max(0.0, first * first - noise * noise));
  const double left = std::sqrt(std::max(0.0, last * last - noise * noise));
  o.closure = open > 0.0 ? 1.0 - left / open : 0.0;
  const auto said = [&](const std::string& e) {
    return std::find(o.named.begin(), o.named.end(), e) != o.named.end();
  };
  const auto hinted = [&](const std::string& e) {
    return said(e) || std::find(o.tied.begin(), o.tied.end(), e) != o.tied.end();
  };
  if (c.kind == Kind::effect || c.kind == Kind::pair) {
    o.exact = std::all_of(c.truth.begin(), c.truth.end(), said);
    o.right = std::all_of(c.truth.begin(), c.truth.end(), hinted);
  } else if (c.kind == Kind::control) {
    o.right = o.exact = o.named.empty() && o.verdict == gap::Verdict::nothing_missing;
  } else {
    o.right = o.exact = o.verdict == gap::Verdict::unexplained || o.verdict == gap::Verdict::partly_explained;
  }
  return o;
}

std::string line_of(const Outcome& o) {
  const auto& c = *o.hidden_case;
  std::string named;
  for (const auto& n : o.named) named += (named.empty() ? "" : ", ") + n;
  std::string tied;
  for (const auto& n : o.tied) tied += (tied.empty() ? " tied: " : ", ") + n;
  return fmt::format("{} {:<10} {:<36} x{:<4} -> {} [{}]{}  closure {:.2f}  left {:.2f} noise  {:.1f} s",
                     o.right ? (o.exact ? "ok " : "tie") : "BAD", c.base, c.name, c.ratio,
                     gap::word(o.verdict), named, tied, o.closure, o.noise_share, o.seconds);
}

std::string confusion_table(const std::vector<Outcome>& outcomes) {
  std::string text;
  std::map<double, std::array<int, 3>> sizes;
  std::vector<double> closures;
  int controls = 0, alarms = 0, control_verdicts = 0, outside = 0, abstained = 0, pairs = 0, pairs_right = 0,
      pairs_partly = 0;
  std::map<std::string, std::map<std::string, int>> table;
  std::set<std::string> columns;
  for (const auto& o : outcomes) {
    const auto& c = *o.hidden_case;
    if (c.kind == Kind::effect) {
      auto& s = sizes[c.ratio];
      ++s[0];
      s[1] += o.right ? 1 : 0;
      s[2] += o.exact ? 1 : 0;
      closures.push_back(o.closure);
      const std::string got = o.named.empty() ? "(none)"
                              : std::find(o.named.begin(), o.named.end(), c.truth[0]) != o.named.end()
                                  ? c.truth[0]
                              : o.right ? "(tied)"
                                        : o.named[0];
      ++table[c.truth[0]][got];
    } else if (c.kind == Kind::pair) {
      ++pairs;
      pairs_right += o.right ? 1 : 0;
      pairs_partly += !o.right && !o.named.empty() ? 1 : 0;
    } else if (c.kind == Kind::control) {
      ++controls;
      alarms += o.named.empty() ? 0 : 1;
      control_verdicts += o.right ? 1 : 0;
      ++table["control: " + c.name][o.named.empty() ? gap::word(o.verdict) : o.named[0]];
    } else {
      ++outside;
      abstained += o.right ? 1 : 0;
      ++table["outside: " + c.name][gap::word(o.verdict)];
    }
  }
  text += "| size over noise | cases | named (ties counted) | named outright |\n|---|---|---|---|\n";
  for (const auto& [ratio, s] : sizes) {
    text += fmt::format("| {} | {} | {} ({:.0f} %) | {} ({:.0f} %) |\n", ratio, s[0], s[1],
                        100.0 * s[1] / s[0], s[2], 100.0 * s[2] / s[0]);
  }
  std::sort(closures.begin(), closures.end());
  if (!closures.empty())
    text += fmt::format("\nClosure of the gap, held-out, median: {:.3f}\n", closures[closures.size() / 2]);
  if (pairs > 0)
    text += fmt::format("\nPairs: {} cases, both named {} , at least one {}\n", pairs, pairs_right,
                        pairs_right + pairs_partly);
  if (controls > 0)
    text +=
        fmt::format("\nControls: {} cases, an effect named in {} ({:.1f} %), verdict nothing_missing in {}\n",
                    controls, alarms, 100.0 * alarms / controls, control_verdicts);
  if (outside > 0)
    text += fmt::format("\nOutside the catalogue: {} cases, told so in {} ({:.0f} %)\n", outside, abstained,
                        100.0 * abstained / outside);
  text += "\n| hidden | taken for (cases) |\n|---|---|\n";
  for (const auto& [truth, row] : table) {
    text += fmt::format("| {} |", truth);
    std::vector<std::pair<int, std::string>> cells;
    for (const auto& [got, count] : row) cells.emplace_back(count, got);
    std::sort(cells.rbegin(), cells.rend());
    for (const auto& [count, got] : cells)
      text += fmt::format(" {} {}", count, got) + (&got == &cells.back().second ? "" : ",");
    text += " |\n";
  }
  return text;
}

}  // namespace hidden
