#include "synthesis/realise_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "lti/bulk_response.hpp"
#include "lti/judge_responses.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// Of the op-amp's output resistance: twice what stages take by themselves (stages/opamp_rc.cpp), which is not enough
/// where large capacitors load an op-amp.
constexpr double kIsolatingShare = 0.4;

/// As one types it: "22u", "4.7M".
std::string typed(double value) {
  std::string out = engineering_text(value, "", 3);
  out.erase(std::remove(out.begin(), out.end(), ' '), out.end());
  const std::size_t micro = out.find("\xC2\xB5");
  if (micro != std::string::npos) out.replace(micro, 2, "u");
  return out;
}

void judge(const Sections& sections, const BuildSearch& search, Candidate& candidate) {
  candidate.judged_band = search.options.band.value_or(judged_band(sections));
  candidate.judged = judge_responses(
      [&](const std::vector<Hertz>& grid) {
        return schematic::network_response(candidate.made.circuit, grid);
      },
      [&](const std::vector<Hertz>& grid) { return responses(sections, grid); }, candidate.judged_band);
  if (candidate.opamps.min_phase_margin_deg < search.limits.min_phase_margin_deg) {
    candidate.shortfalls.push_back(
        fmt::format("an op-amp has {} degrees of phase margin, expected {} or more",
                    rounded_text(candidate.opamps.min_phase_margin_deg, 3),
                    rounded_text(search.limits.min_phase_margin_deg)));
  }
  if (!(candidate.judged.max_magnitude_db <= search.limits.max_error_db)) {
    candidate.shortfalls.push_back(fmt::format(
        "parts and op-amps are {} dB off between {} and {}, expected {} dB or less",
        rounded_text(candidate.judged.max_magnitude_db, 3),
        engineering_text(candidate.judged_band.from.value, "Hz"),
        engineering_text(candidate.judged_band.to.value, "Hz"), rounded_text(search.limits.max_error_db)));
  }
}

Outcome<Candidate> candidate_with(const Sections& sections, const BuildSearch& search,
                                  const RealiseOptions& options) {
  Outcome<Realised> made = try_realise(sections, options);
  if (const Refusal* refusal = refusal_of(made)) return *refusal;
  Candidate out;
  out.realisation = options.realisation;
  out.made = std::get<Realised>(std::move(made));
  out.opamps = check_opamps(out.made.circuit, out.made.report.band, search.amplitude_v);
  judge(sections, search, out);
  return out;
}

/// Fewer shortfalls first, then fewer warnings, then the smaller error.
bool falls_short_less(const Candidate& a, const Candidate& b) {
  if (a.shortfalls.size() != b.shortfalls.size()) return a.shortfalls.size() < b.shortfalls.size();
  if (!a.shortfalls.empty()) return a.judged.max_magnitude_db < b.judged.max_magnitude_db;
  if (a.opamps.warnings.size() != b.opamps.warnings.size())
    return a.opamps.warnings.size() < b.opamps.warnings.size();
  return a.judged.max_magnitude_db < b.judged.max_magnitude_db;
}

/// With the given op-amp, or the first of the library that leaves nothing to say; the best one where none does.
Outcome<Candidate> candidate_of(const Sections& sections, const BuildSearch& search,
                                const RealiseOptions& options) {
  if (search.opamps == nullptr) return candidate_with(sections, search, options);
  std::optional<Candidate> best;
  Refusal last{"the list of op-amps is empty, expected at least one type"};
  for (const OpAmpModel& model : search.opamps->types()) {
    if (model.is_ideal) continue;
    RealiseOptions trial = options;
    trial.opamp = model;
    Outcome<Candidate> one = candidate_with(sections, search, trial);
    if (const Refusal* refusal = refusal_of(one)) {
      last = *refusal;
      continue;
    }
    auto& candidate = std::get<Candidate>(one);
    const bool clean = candidate.shortfalls.empty() && candidate.opamps.warnings.empty();
    if (!best || falls_short_less(candidate, *best)) best = std::move(candidate);
    if (clean) break;
  }
  if (!best) return last;
  return *std::move(best);
}

/// The same with another realisation, and its own limits where nobody gave any.
RealiseOptions options_for(const BuildSearch& search, const Realisation& other) {
  RealiseOptions out = search.options;
  out.realisation = std::string(other.name());
  if (!search.limits_given) out.limits = other.usual_limits();
  return out;
}

std::string why_not(const Candidate& candidate) {
  return candidate.realisation + ": " + join(candidate.shortfalls, "; ");
}

bool can_be_made(const Sections& sections, const RealiseOptions& options) {
  return refusal_of(try_realise(sections, options)) == nullptr;
}

}  // namespace

std::optional<std::string> limits_that_do(const Sections& sections, const RealiseOptions& options) {
  struct Limit {
    const char* name;
    double PartLimits::*value;
    double step;  ///< a decade wider
  };
  static constexpr std::array<Limit, 4> kAll = {{{"capacitors up to", &PartLimits::max_f, 10.0},
                                                 {"resistors up to", &PartLimits::max_ohm, 10.0},
                                                 {"resistors down to", &PartLimits::min_ohm, 0.1},
                                                 {"capacitors down to", &PartLimits::min_f, 0.1}}};
  RealiseOptions trial = options;
  trial.resistors = Series::named("exact");
  trial.capacitors = Series::named("exact");
  for (const int decades : {1, 2}) {
    for (const Limit& limit : kAll) {
      trial.limits = options.limits;
      trial.limits.*limit.value *= std::pow(limit.step, decades);
      if (can_be_made(sections, trial))
        return fmt::format("{} {}", limit.name, typed(trial.limits.*limit.value));
    }
  }
  trial.limits = options.limits;
  std::string all;
  for (const Limit& limit : kAll) {
    trial.limits.*limit.value *= limit.step * limit.step;
    all += fmt::format("{}{} {}", all.empty() ? "" : ", ", limit.name,
                       rounded_text(trial.limits.*limit.value, 3));
  }
  if (can_be_made(sections, trial)) return all;
  return std::nullopt;
}

namespace {

/// The best candidate so far.
class Candidates {
 public:
  Candidates(const Sections& sections, const BuildSearch& search) : sections_(sections), search_(search) {}

  /// The reason when it cannot be made.
  std::optional<Refusal> add(const RealiseOptions& options, const std::string& how) {
    const Progress progress("parts for " + how);
    Outcome<Candidate> one = candidate_of(sections_, search_, options);
    if (const Refusal* refusal = refusal_of(one)) return *refusal;
    auto& candidate = std::get<Candidate>(one);
    candidate.how = how;
    if (!best_ || falls_short_less(candidate, *best_)) best_ = std::move(candidate);
    return std::nullopt;
  }
  bool done() const { return best_ && best_->shortfalls.empty(); }
  std::optional<Candidate>& best() { return best_; }

 private:
  const Sections& sections_;
  const BuildSearch& search_;
  std::optional<Candidate> best_;
};

/// The realisation asked for with isolating resistors although they cost a little at the ends of the band.
RealiseOptions isolated(RealiseOptions options) {
  options.isolation_ohm = kIsolatingShare * options.opamp.output_resistance_ohm;
  return options;
}

/// The usual form with parts as wide as a ladder's, then with isolating resistors too.
void try_wide_parts(const BuildSearch& search, Candidates& candidates) {
  RealiseOptions wide = search.options;
  if (!search.limits_given) wide.limits = realisation_registry().get("foster1").usual_limits();
  const std::string name = search.options.realisation + " with wider limits of its parts";
  (void)candidates.add(wide, name);
  if (!candidates.done() && !search.options.isolation_ohm)
    (void)candidates.add(isolated(wide), name + " and isolating resistors");
}

void try_other_realisations(const BuildSearch& search, Candidates& candidates) {
  for (const Realisation* other : realisation_registry().all()) {
    const std::string name(other->name());
    // Forms of one stage that opamp-rc has already weighed are left to it.
    const bool weighed = other->stage_realisation() != nullptr && name != "tow-thomas";
    if (name != search.options.realisation && !weighed)
      (void)candidates.add(options_for(search, *other), name);
  }
}

}  // namespace

Outcome<BuildChoice> realise_for_building(const Sections& sections, const BuildSearch& search) {
  Candidates candidates(sections, search);
  const std::optional<Refusal> refusal = candidates.add(search.options, search.options.realisation);
  if (candidates.done() || (!refusal && !search.may_choose))
    return BuildChoice{*std::move(candidates.best()), {}};
  const std::string reason =
      refusal ? search.options.realisation + ": " + refusal->reason : why_not(*candidates.best());
  if (search.may_choose) {
    if (!refusal && !search.options.isolation_ohm)
      (void)candidates.add(isolated(search.options),
                           search.options.realisation + " with isolating resistors");
    if (!candidates.done()) try_other_realisations(search, candidates);
    if (!candidates.done()) try_wide_parts(search, candidates);
  }
  if (!candidates.best()) {
    const auto limits = limits_that_do(sections, search.options);
    return Refusal{refusal->reason + (limits ? "; " + *limits + " would do" : std::string())};
  }
  BuildChoice out{*std::move(candidates.best()), {}};
  if (out.best.how != search.options.realisation) out.passed_over = {reason};
  return out;
}

}  // namespace bodesmith::synthesis
