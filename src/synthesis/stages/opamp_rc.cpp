#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/parts/search.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/stages/pairing.hpp"

namespace bodesmith::synthesis {
namespace {

constexpr int kStageSearchGrid = 33;
constexpr double kTrimAbovePercent = 0.4;
constexpr double kFallbackAbovePercent = 1.0;
/// Another form or a part more must bring the error down to this share, or what is simpler stays.
constexpr double kWorthwhile = 0.7;
constexpr double kIsolationAboveDb = 0.005;
/// A fifth of the output resistance leaves a lag of at most asin(5/7) = 46 degrees, and that below the
/// crossing.
constexpr double kIsolationShare = 0.2;

/// Sections in the order of the signal, each with the form that makes it.
struct ChainPlan {
  std::vector<Section> sections;  ///< gains above 0
  std::vector<const StageRealisation*> forms;

  void put_in_front(double gain, const StageRealisation& form) {
    Section constant;
    constant.gain = gain;
    sections.insert(sections.begin(), constant);
    forms.insert(forms.begin(), &form);
  }
};

/// The form that was asked for, or the best; a stage that does not have the asked form's poles gets the best.
Outcome<const StageRealisation*> form_of(const Section& section, const StageRealisation* asked,
                                         std::size_t number) {
  if (asked == nullptr || section.poles.empty()) return best_form(section);
  const std::optional<Refusal> refusal = integrates(section) && section.poles.size() > 1
                                             ? Refusal{"it makes no pole at 0"}
                                             : asked->refusal(section);
  if (!refusal) return asked;
  // A single real pole next to two-pole forms is always made by the first-order one.
  if (section.poles.size() == 1) return best_form(section);
  return Refusal{fmt::format("stage {} cannot be made as {}: {}; opamp-rc chooses a form that can",
                             number + 1, asked->name(), refusal->reason)};
}

/// Every inverting form turns the sign; an inverter in front makes up for an odd number. In front, because it
/// gives the source a resistor to drive.
void make_up_for_sign(ChainPlan& plan, double gain) {
  if (plan.sections.empty()) {
    if (gain < 0.0) {
      plan.put_in_front(-gain, inverter());
    } else {
      plan.put_in_front(std::sqrt(gain), inverter());
      plan.put_in_front(std::sqrt(gain), inverter());
    }
  }
  bool negative = gain < 0.0;
  for (const StageRealisation* form : plan.forms) negative = negative != form->inverts();
  if (negative) plan.put_in_front(1.0, inverter());
}

Outcome<ChainPlan> plan_chain(const Sections& sections, const StageRealisation* asked, Band band) {
  const Split split = asked != nullptr && asked->makes_two_poles() ? split_into_two_pole_stages(sections)
                                                                   : split_into_stages(sections);
  if (!(std::abs(split.leading_gain) > 0.0) || !std::isfinite(split.leading_gain)) {
    return Refusal{
        fmt::format("the overall gain is {}, expected a finite gain other than 0", split.leading_gain)};
  }
  ChainPlan plan;
  plan.sections = order_stages(split.stages, split.leading_gain, band).stages;
  for (std::size_t i = 0; i < plan.sections.size(); ++i) {
    const auto form = form_of(plan.sections[i], asked, i);
    if (const Refusal* refusal = refusal_of(form)) return *refusal;
    plan.forms.push_back(std::get<const StageRealisation*>(form));
  }
  make_up_for_sign(plan, split.leading_gain);
  return plan;
}

/// A plan with values for every part.
struct FoundChain {
  ChainPlan plan;
  std::vector<std::unique_ptr<StageForm>> forms;
  PartsFound parts;
};

std::string stage_title(const Section& section, const StageRealisation& form) {
  std::vector<std::string> poles;
  for (const Complex p : section.poles) poles.push_back(rounded_text(std::abs(p)));
  return poles.empty() ? std::string(form.name())
                       : fmt::format("{}, poles at {} rad/s", form.name(), join(poles, " and "));
}

Outcome<FoundChain> search_chain(const ChainPlan& plan, const FormOptions& form_options,
                                 const RealiseOptions& options, const SearchGrid& grid) {
  FoundChain out;
  out.plan = plan;
  std::vector<std::string> titles;
  for (std::size_t i = 0; i < plan.sections.size(); ++i) {
    out.forms.push_back(plan.forms[i]->make(plan.sections[i], form_options));
    titles.push_back(stage_title(plan.sections[i], *plan.forms[i]));
  }
  Outcome<PartsFound> found = search_parts(out.forms, titles, options, grid);
  if (const Refusal* refusal = refusal_of(found)) return *refusal;
  out.parts = std::get<PartsFound>(std::move(found));
  return out;
}

/// Replaces `found` by the other plan where that is worthwhile; one that cannot be made is not.
void take_if_worthwhile(FoundChain& found, Outcome<FoundChain> other) {
  FoundChain* better = std::get_if<FoundChain>(&other);
  if (better == nullptr) return;
  if (better->parts.worst_complex_percent < kWorthwhile * found.parts.worst_complex_percent) {
    found = std::move(*better);
  }
}

/// Too few parts to meet the gain: the first stage that has such a form gets a trimming part.
std::optional<ChainPlan> trimmed_plan(const ChainPlan& plan) {
  for (std::size_t i = 0; i < plan.sections.size(); ++i) {
    const StageRealisation* trimmed = plan.forms[i]->trimmed();
    if (trimmed == nullptr || trimmed->refusal(plan.sections[i])) continue;
    ChainPlan out = plan;
    out.forms[i] = trimmed;
    return out;
  }
  return std::nullopt;
}

/// Every form that has another one for the same section and sign, by that one.
std::optional<ChainPlan> fallback_plan(const ChainPlan& plan) {
  ChainPlan out = plan;
  for (std::size_t i = 0; i < plan.sections.size(); ++i) {
    const StageRealisation* other = plan.forms[i]->fallback();
    if (other != nullptr && other->inverts() == plan.forms[i]->inverts() &&
        !other->refusal(plan.sections[i])) {
      out.forms[i] = other;
    }
  }
  if (out.forms == plan.forms) return std::nullopt;
  return out;
}

/// The plan's parts, or those of a plan with a trimming part or other forms where these come much nearer.
Outcome<FoundChain> find_chain(const ChainPlan& plan, bool forms_are_free, const FormOptions& form_options,
                               const RealiseOptions& options, const SearchGrid& grid) {
  Outcome<FoundChain> outcome = search_chain(plan, form_options, options, grid);
  FoundChain* found = std::get_if<FoundChain>(&outcome);
  if (found == nullptr) return outcome;
  if (found->parts.worst_complex_percent > kTrimAbovePercent && !options.capacitors.is_exact()) {
    if (const auto other = trimmed_plan(found->plan))
      take_if_worthwhile(*found, search_chain(*other, form_options, options, grid));
  }
  if (found->parts.worst_complex_percent > kFallbackAbovePercent && forms_are_free &&
      !options.resistors.is_exact()) {
    if (const auto other = fallback_plan(found->plan))
      take_if_worthwhile(*found, search_chain(*other, form_options, options, grid));
  }
  return outcome;
}

/// What the isolating resistors take from the magnitude.
double isolation_costs_db(const FoundChain& found, const std::vector<Hertz>& grid) {
  double out = 0.0;
  for (const Hertz f : grid) {
    double db = 0.0;
    for (std::size_t i = 0; i < found.forms.size(); ++i) {
      const std::vector<double>& values = found.parts.values[i];
      db += to_decibel(std::abs(found.forms[i]->transfer(values).response(f.rad_s()) /
                                found.forms[i]->aim(values).response(f.rad_s())));
    }
    out = std::max(out, std::abs(db));
  }
  return out;
}

/// The stages as they are wanted: their gains moved so that every stage keeps the level its parts gave it and
/// the product is still exactly the design.
std::vector<std::shared_ptr<const StageForm>> wanted_forms(const FoundChain& found,
                                                           const FormOptions& form_options,
                                                           const std::vector<Hertz>& grid) {
  std::vector<double> level;
  double sum = 0.0;
  for (std::size_t i = 0; i < found.forms.size(); ++i) {
    const Biquad realised = found.forms[i]->transfer(found.parts.values[i]);
    const Biquad& wanted = found.forms[i]->wanted();
    double largest = 0.0;
    for (const Hertz f : grid) largest = std::max(largest, std::abs(wanted.response(f.rad_s())));
    double sum_of_logs = 0.0;
    int judged = 0;
    for (const Hertz f : grid) {
      const double size = std::abs(wanted.response(f.rad_s()));
      const double got = std::abs(realised.response(f.rad_s()));
      // Near a zero on the axis there is no level.
      if (!(size >= kJudgedFloor * largest) || !(got > 0.0)) continue;
      sum_of_logs += std::log(got / size);
      ++judged;
    }
    level.push_back(judged > 0 ? sum_of_logs / judged : 0.0);
    sum += level.back();
  }
  const double share = sum / static_cast<double>(level.size());
  std::vector<std::shared_ptr<const StageForm>> out;
  for (std::size_t i = 0; i < found.forms.size(); ++i) {
    Section section = found.plan.sections[i];
    section.gain *= std::exp(level[i] - share);
    out.push_back(found.plan.forms[i]->make(section, form_options));
  }
  return out;
}

Circuit chain_circuit(const FoundChain& found, const FormOptions& form_options, const RealiseOptions& options,
                      const std::vector<Hertz>& grid) {
  Circuit out;
  out.opamp = options.opamp;
  const auto wanted = wanted_forms(found, form_options, grid);
  for (std::size_t i = 0; i < found.forms.size(); ++i) {
    const std::vector<double>& values = found.parts.values[i];
    StageDesign stage;
    stage.realisation = found.plan.forms[i]->name();
    stage.parts = found.forms[i]->parts();
    stage.opamps = found.forms[i]->opamps();
    stage.realised_values = values;
    // What each part should have been: the exact design at its impedance.
    stage.wanted_values = wanted[i]->exact_near(values).value_or(values);
    stage.wanted = {wanted[i]->wanted()};
    stage.realised = {found.forms[i]->transfer(values)};
    stage.form = wanted[i];
    add_stage(out, stage, found.forms.size(), options);
  }
  return out;
}

/// Every wanted value rounded on its own.
std::vector<Biquad> nearest_rounding(const FoundChain& found, const Circuit& circuit,
                                     const RealiseOptions& options) {
  std::vector<Biquad> out;
  for (std::size_t i = 0; i < found.forms.size(); ++i) {
    std::vector<double> values;
    for (const Part& part : circuit.parts_of(circuit.stages[i])) {
      values.push_back(
          (part.kind == Part::Kind::resistor ? options.resistors : options.capacitors).nearest(part.wanted));
    }
    out.push_back(found.forms[i]->transfer(values));
  }
  return out;
}

/// Sections as a chain of op-amp RC stages. Real poles and zeros of all sections are pooled, paired sorted by
/// frequency (least span a stage) and each pair becomes a stage, e.g. R1||C1 into R2||C2 around an inverting
/// op-amp,
///   H(s) = -(R2/R1)(1 + s R1 C1)/(1 + s R2 C2);
/// complex pairs become biquads. Stages are ordered so that no node between them is far above or below the
/// signal, the gain is spread over them, an inverter is added where the number of inversions is odd.
/// Resistors and capacitors of all stages are then searched jointly in their series for the least complex
/// error of the whole chain. `form`: for every stage that it can make; null: the best for each.
Outcome<Realised> realise_as_stages(const Sections& asked, const StageRealisation* form,
                                    const RealiseOptions& options) {
  const Sections sections = without_far_zeros(asked);
  const Band band = options.band.value_or(searched_band(sections));
  const Outcome<ChainPlan> planned = plan_chain(sections, form, band);
  if (const Refusal* refusal = refusal_of(planned)) return *refusal;
  const ChainPlan& plan = std::get<ChainPlan>(planned);
  const SearchGrid grid(sections, band, kStageSearchGrid);

  FormOptions form_options;
  form_options.isolation_ohm = options.isolation_ohm.value_or(
      options.resistors.is_exact() ? 0.0 : kIsolationShare * options.opamp.output_resistance_ohm);
  const bool forms_are_free = form == nullptr;
  Outcome<FoundChain> outcome = find_chain(plan, forms_are_free, form_options, options, grid);
  if (const Refusal* refusal = refusal_of(outcome)) return *refusal;
  if (!options.isolation_ohm && form_options.isolation_ohm > 0.0 &&
      isolation_costs_db(std::get<FoundChain>(outcome), grid.at) > kIsolationAboveDb) {
    // The band reaches up to the isolating poles: better a warning of the phase margin.
    form_options.isolation_ohm = 0.0;
    outcome = find_chain(plan, forms_are_free, form_options, options, grid);
    if (const Refusal* refusal = refusal_of(outcome)) return *refusal;
  }
  const FoundChain& found = std::get<FoundChain>(outcome);

  Realised out;
  out.circuit = chain_circuit(found, form_options, options, grid.at);
  const std::vector<Biquad> nearest = nearest_rounding(found, out.circuit, options);
  report_realised(out, asked, band, [&](RadPerSecond w) {
    Complex h = 1.0;
    for (const Biquad& one : nearest) h *= one.response(w);
    return h;
  });
  return out;
}

class OpAmpRc final : public Realisation {
 public:
  std::string_view name() const override { return "opamp-rc"; }
  Outcome<Realised> design(const Sections& sections, const RealiseOptions& options) const override {
    return realise_as_stages(sections, nullptr, options);
  }
};

}  // namespace

Outcome<Realised> StageRealisation::design(const Sections& sections, const RealiseOptions& options) const {
  return realise_as_stages(sections, this, options);
}

BODESMITH_ENTRY(Realisation, opamp_rc, OpAmpRc)

Outcome<const StageRealisation*> best_form(const Section& section) {
  const StageRealisation* best = nullptr;
  int highest = 0;
  for (const Realisation* one : realisation_registry().all()) {
    const StageRealisation* form = one->stage_realisation();
    if (form == nullptr || form->bid(section) <= highest || form->refusal(section)) continue;
    highest = form->bid(section);
    best = form;
  }
  if (best == nullptr) return Refusal{"a section fits none of the op-amp RC forms"};
  return best;
}

}  // namespace bodesmith::synthesis
