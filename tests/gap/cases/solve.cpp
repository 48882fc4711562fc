#include "gap/cases/solve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "chain/model_file.hpp"
#include "gap/diagnosis.hpp"
#include "gap/runner.hpp"
#include "gap/search.hpp"
#include "gap/study.hpp"

namespace hidden {

using namespace bodesmith;

namespace {

gap::Study study_of(const Case& c, const chain::Chain& base) {
  return c.train_responses.empty() ? gap::Study::of(c.train, c.holdout, base)
                                   : gap::Study::of(c.train_responses, c.holdout_responses, base);
}

std::size_t samples_of(const Case& c) {
  std::size_t samples = 0;
  for (const auto* records : {&c.train, &c.holdout}) {
    for (const auto& r : *records) samples += r.size();
  }
  for (const auto* responses : {&c.train_responses, &c.holdout_responses}) {
    for (const auto& r : *responses) samples += r.frequency.size();
  }
  return samples;
}

void explain(const gap::SearchResult& result, const gap::Study& study, double noise) {
  const auto show = [&](const std::vector<gap::Ranked>& ranking) {
    for (const auto& r : ranking) {
      fmt::print("      {:<24} {:<15} score {:.3f} train {:.4f} holdout {:.4f} log evidence {:.1f} {}",
                 r.effect->name(), r.placed, r.score, r.train_rms / noise, r.holdout_rms / noise,
                 r.log_evidence, to_string(r.outcome));
      if (!r.model.terms().empty()) {
        for (const auto& u : r.model.terms().back().unknowns) fmt::print(" {}={:.4g}", u.name, u.value);
      }
      fmt::print("\n");
    }
  };
  fmt::print("    base train {:.3f} holdout {:.3f} floor {} {:.3f}\n",
             gap::rms_of(result.base, study.train()) / noise,
             gap::rms_of(result.base, study.holdout()) / noise, to_string(result.floor.source),
             result.floor.rms / noise);
  for (const auto& s : result.steps) {
    fmt::print("    step {}\n", s.effect->name());
    show(s.ranking);
  }
  fmt::print("    refused\n");
  show(result.refused);
  for (const auto& s : result.structure) fmt::print("    sign: {} {:.2f}\n", to_string(s.kind), s.strength);
  for (const auto& n : result.notes) fmt::print("    note: {}\n", n);
}

bool is_in(const std::vector<std::string>& list, const std::string& e) {
  return std::find(list.begin(), list.end(), e) != list.end();
}

}  // namespace

Outcome solve(const Case& c, const SolveOptions& wanted) {
  Outcome o;
  o.specification = c.specification;
  const auto base = chain::model_from_node(parse_toml(c.model, "model.toml"));
  const auto study = study_of(c, base);
  o.samples = samples_of(c);
  gap::SearchOptions options;
  options.threads = wanted.threads;
  options.max_terms = wanted.max_terms;
  Stopwatch watch;
  options.stop = [&] {
    return interrupted() || (wanted.max_seconds > 0.0 && watch.seconds() > wanted.max_seconds);
  };
  const auto found = gap::diagnose(base, study, options);
  const auto& result = found.search;
  o.seconds = watch.seconds();
  const auto verdict = found.verdict;
  o.verdict = to_string(verdict);
  for (const auto& s : result.steps) {
    o.named.emplace_back(s.effect->name());
    o.tied.insert(o.tied.end(), s.tied_with.begin(), s.tied_with.end());
  }
  if (wanted.explain) explain(result, study, c.noise_rms);
  const double first = gap::rms_of(result.base, study.holdout());
  const double last = gap::rms_of(result.final, study.holdout());
  const double noise = c.noise_rms;
  o.noise_share = last / noise;
  const double open = std::sqrt(std::max(0.0, first * first - noise * noise));
  const double left = std::sqrt(std::max(0.0, last * last - noise * noise));
  o.closure = open > 0.0 ? 1.0 - left / open : 0.0;
  const auto said = [&](const std::string& e) { return is_in(o.named, e); };
  const auto hinted = [&](const std::string& e) { return said(e) || is_in(o.tied, e); };
  switch (c.specification.kind) {
    case Kind::effect:
    case Kind::pair:
      o.exact = std::all_of(c.truth.begin(), c.truth.end(), said);
      o.right = std::all_of(c.truth.begin(), c.truth.end(), hinted);
      break;
    case Kind::control:
      o.right = o.exact = o.named.empty() && verdict == gap::Verdict::nothing_missing;
      break;
    case Kind::outside:
      o.right = o.exact = verdict == gap::Verdict::unexplained || verdict == gap::Verdict::partly_explained;
      break;
  }
  return o;
}

std::size_t Outcome::further() const {
  const auto& s = specification;
  const bool hides = s.kind == Kind::effect || s.kind == Kind::pair;
  return static_cast<std::size_t>(std::count_if(
      named.begin(), named.end(), [&](const std::string& n) { return !hides || !is_in(s.what, n); }));
}

std::string line_of(const Outcome& o) {
  const auto& s = o.specification;
  std::string named;
  for (const auto& n : o.named) named += (named.empty() ? "" : ", ") + n;
  std::string tied;
  for (const auto& n : o.tied) tied += (tied.empty() ? " tied: " : ", ") + n;
  return fmt::format(
      "{} {:<9} {:<7} {:<14} {:<30} x{:<4} -> {} [{}]{}  closure {:.2f}  left {:.2f} noise  {} samples  "
      "{:.1f} s  "
      "seed {}",
      o.right ? (o.exact ? "ok " : "tie") : "BAD", to_string(s.world), to_string(s.kind), s.base,
      s.what_text(), s.ratio, o.verdict, named, tied, o.closure, o.noise_share, o.samples, o.seconds, s.seed);
}

}  // namespace hidden
