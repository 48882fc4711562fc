#include "circuit/realise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuit/opamp_check.hpp"
#include "circuit/ordering.hpp"
#include "circuit/pairing.hpp"
#include "circuit/parts_search.hpp"
#include "circuit/realise_ladder.hpp"
#include "circuit/realization.hpp"
#include "circuit/response.hpp"

namespace bodesmith::circuit {
namespace {

using Complex = std::complex<double>;

constexpr int kSearchGrid = 33;
constexpr int kReportGrid = 121;
constexpr double kTrimAbove = 0.4;       // percent
constexpr double kOtherFormAbove = 1.0;  // percent
constexpr double kIsolationAboveDb = 0.005;
// A fifth of the output resistance leaves a lag of at most asin(5/7) = 46 degrees, and that below the
// crossing.
constexpr double kIsolationShare = 0.2;

void check(const RealiseOptions& options) {
  if (!(options.least_ohm > 0.0) || !(options.greatest_ohm >= options.least_ohm)) {
    throw InputError("the limits of the resistors are empty, expected 0 < least <= greatest");
  }
  if (!(options.least_f > 0.0) || !(options.greatest_f >= options.least_f)) {
    throw InputError("the limits of the capacitors are empty, expected 0 < least <= greatest");
  }
}

Band default_band(const Sections& sections) {
  const Band corners = sections.corner_band();
  if (corners.to.value == 0.0) return {Hertz{1.0}, Hertz{1000.0}};
  return {Hertz{corners.from.value / 10.0}, Hertz{corners.to.value * 10.0}};
}

/// The realization of each stage, chosen or asked for.
const Realization& choose(const RealiseOptions& options, const Section& section, size_t number) {
  if (options.realization == "opamp-rc" || section.poles.empty()) return default_realization(section);
  const Realization& asked = realization_named(options.realization);
  const std::string why = asked.refusal(section);
  if (why.empty()) return asked;
  // A single real pole beside two-pole forms is always made by the first-order one.
  if (section.poles.size() == 1) return default_realization(section);
  throw DesignError(fmt::format("stage {} cannot be made as {}: {}; opamp-rc chooses a form that can",
                                number + 1, options.realization, why));
}

std::string title(const Section& section, const Realization& realization) {
  std::vector<std::string> poles;
  for (const Complex p : section.poles) poles.push_back(rounded_text(std::abs(p)));
  return poles.empty() ? realization.name
                       : fmt::format("{}, poles at {} rad/s", realization.name, join(poles, " and "));
}

/// Nodes of stage i: "in" and "out" at the ends of the chain, n1, n2, … between, its own prefixed by s1_, ….
std::string node_name(const std::string& local, size_t stage, size_t count) {
  if (local == "0") return local;
  if (local == "in") return stage == 0 ? "in" : fmt::format("n{}", stage);
  if (local == "out") return stage + 1 == count ? "out" : fmt::format("n{}", stage + 1);
  return fmt::format("s{}_{}", stage + 1, local);
}

void add_stage(Circuit& circuit, const StageForm& form, const Realization& realization, size_t index,
               size_t count, const std::vector<double>& values, const RealiseOptions& options) {
  Stage stage;
  stage.realization = realization.name;
  stage.wanted = {form.wanted()};
  stage.realised = {form.transfer(values)};
  stage.in = node_name("in", index, count);
  stage.out = node_name("out", index, count);
  stage.first_part = circuit.parts.size();
  stage.part_count = form.parts().size();
  for (size_t i = 0; i < form.parts().size(); ++i) {
    const StagePart& drawn = form.parts()[i];
    Part part;
    part.kind = drawn.kind;
    part.name = fmt::format("{}_{}", drawn.name, index + 1);
    part.stage = index;
    part.from = node_name(drawn.from, index, count);
    part.to = node_name(drawn.to, index, count);
    part.series = drawn.kind == Part::Kind::resistor ? options.resistors.name() : options.capacitors.name();
    part.wanted = part.realised = values[i];
    circuit.parts.push_back(std::move(part));
  }
  for (const StageOpAmp& drawn : form.opamps()) {
    circuit.opamps.push_back({fmt::format("{}_{}", drawn.name, index + 1), index,
                              node_name(drawn.plus, index, count), node_name(drawn.minus, index, count),
                              node_name(drawn.out, index, count)});
  }
  circuit.stages.push_back(std::move(stage));
}

/// What each part should have been: the stages' gains moved so that every stage keeps the level its parts
/// gave it and the product is still exactly the design, then the exact design at that impedance.
void set_wanted(Circuit& circuit, const std::vector<const Realization*>& how,
                const std::vector<Section>& stages, const std::vector<std::vector<double>>& values,
                const std::vector<Hertz>& grid, const FormOptions& form_options) {
  std::vector<double> level;
  double sum = 0.0;
  for (const Stage& stage : circuit.stages) {
    double mean = 0.0;
    for (const Hertz f : grid) {
      mean += std::log(std::abs(stage.response(f.rad_s()) / stage.wanted_response(f.rad_s())));
    }
    level.push_back(mean / static_cast<double>(grid.size()));
    sum += level.back();
  }
  const double share = sum / static_cast<double>(level.size());
  for (size_t i = 0; i < circuit.stages.size(); ++i) {
    Section section = stages[i];
    section.gain *= std::exp(level[i] - share);
    const std::shared_ptr<const StageForm> form = how[i]->make(section, form_options);
    circuit.stages[i].wanted = {form->wanted()};
    circuit.stages[i].form = form;
    std::vector<double> exact;
    if (!form->exact_near(values[i], exact)) continue;
    for (size_t k = 0; k < exact.size(); ++k) {
      circuit.parts[circuit.stages[i].first_part + k].wanted = exact[k];
    }
  }
}

std::vector<Biquad> nearest_rounding(const std::vector<const Realization*>& how,
                                     const std::vector<Section>& stages, const Circuit& circuit,
                                     const RealiseOptions& options, const FormOptions& form_options) {
  std::vector<Biquad> out;
  for (size_t i = 0; i < stages.size(); ++i) {
    const std::unique_ptr<StageForm> form = how[i]->make(stages[i], form_options);
    const Stage& stage = circuit.stages[i];
    std::vector<double> values;
    for (const Part& part : circuit.parts_of(stage)) {
      values.push_back(
          (part.kind == Part::Kind::resistor ? options.resistors : options.capacitors).nearest(part.wanted));
    }
    out.push_back(form->transfer(values));
  }
  return out;
}

/// What the isolating resistors take from the magnitude.
double isolation_costs_db(const std::vector<std::unique_ptr<StageForm>>& forms, const PartsFound& found,
                          const std::vector<Hertz>& grid) {
  double out = 0.0;
  for (const Hertz f : grid) {
    double db = 0.0;
    for (size_t i = 0; i < forms.size(); ++i) {
      db += to_decibel(std::abs(forms[i]->transfer(found.values[i]).response(f.rad_s()) /
                                forms[i]->aim(found.values[i]).response(f.rad_s())));
    }
    out = std::max(out, std::abs(db));
  }
  return out;
}

void measure_nodes(const Circuit& circuit, const std::vector<Hertz>& grid, RealiseReport& report) {
  report.highest_node_db = -std::numeric_limits<double>::infinity();
  report.lowest_node_db = std::numeric_limits<double>::infinity();
  for (const Hertz f : grid) {
    Complex h = 1.0;
    for (const Stage& stage : circuit.stages) {
      h *= stage.response(f.rad_s());
      report.highest_node_db = std::max(report.highest_node_db, to_decibel(std::abs(h)));
      report.lowest_node_db = std::min(report.lowest_node_db, to_decibel(std::max(std::abs(h), 1e-300)));
    }
  }
}

}  // namespace

void report_realised(Realised& made, const Sections& sections, Band band,
                     const std::function<Complex(RadPerSecond)>& nearest) {
  RealiseReport& report = made.report;
  report.band = band;
  const std::vector<Hertz> grid = log_grid(band, kReportGrid);
  std::vector<Complex> wanted, rounded;
  for (const Hertz f : grid) {
    wanted.push_back(sections.response(f.rad_s()));
    rounded.push_back(nearest(f.rad_s()));
  }
  const std::vector<Complex> ideal = circuit_response(made.circuit, grid);
  const std::vector<Complex> real = network_response(made.circuit, grid, made.circuit.model);
  report.parts = compare_responses(grid, ideal, wanted);
  report.nearest = compare_responses(grid, rounded, wanted);
  report.opamps = compare_responses(grid, real, ideal);
  report.all = compare_responses(grid, real, wanted);
  measure_nodes(made.circuit, grid, report);
  report.warnings = check_opamps(made.circuit, band).warnings;
}

Sections without_far_zeros(const Sections& sections) {
  double highest = 0.0;
  for (const Section& section : sections.sections) {
    for (const Complex pole : section.poles) highest = std::max(highest, std::abs(pole));
  }
  Sections out = sections;
  for (Section& section : out.sections) {
    std::vector<Complex> kept;
    Complex gain = section.gain;
    for (const Complex zero : section.zeros) {
      if (std::abs(zero) <= 1000.0 * highest) {
        kept.push_back(zero);
      } else {
        gain *= -zero;
      }
    }
    section.gain = gain.real();  // complex zeros come in pairs
    section.zeros = kept;
  }
  return out;
}

Realised realise(const Sections& asked, const RealiseOptions& options) {
  check(options);
  const Sections sections = without_far_zeros(asked);
  if (const auto ladder = ladder_form_named(options.realization))
    return realise_ladders(asked, *ladder, options);
  const bool two_poles = options.realization != "opamp-rc" && options.realization != "first-order";
  if (options.realization != "opamp-rc") realization_named(options.realization);
  const Split split = two_poles ? split_into_two_pole_stages(sections) : split_into_stages(sections);
  if (!(std::abs(split.leading_gain) > 0.0) || !std::isfinite(split.leading_gain)) {
    throw DesignError(
        fmt::format("the overall gain is {}, expected a finite gain other than 0", split.leading_gain));
  }
  const Band band = options.band.value_or(default_band(sections));
  std::vector<Section> stages = order_stages(split.stages, split.leading_gain, band).stages;

  // Signs: every inverting form turns the sign; an inverter in front makes up for an odd number. In front,
  // because it gives the source a resistor to drive.
  std::vector<const Realization*> how;
  for (size_t i = 0; i < stages.size(); ++i) how.push_back(&choose(options, stages[i], i));
  bool negative = split.leading_gain < 0.0;
  for (const Realization* one : how) negative = negative != one->inverts;
  const Realization& inverter = realization_named("inverter");
  const auto put_inverter = [&](double gain) {
    Section constant;
    constant.gain = gain;
    stages.insert(stages.begin(), constant);
    how.insert(how.begin(), &inverter);
  };
  if (stages.empty()) {
    put_inverter(std::sqrt(std::abs(split.leading_gain)));
    put_inverter(std::sqrt(std::abs(split.leading_gain)));
    if (split.leading_gain < 0.0) {
      stages.pop_back();
      how.pop_back();
      stages[0].gain = -split.leading_gain;
    }
  } else if (negative) {
    put_inverter(1.0);
  }

  FormOptions form_options;
  form_options.isolation_ohm = options.isolation_ohm.value_or(
      options.resistors.is_exact() ? 0.0 : kIsolationShare * options.opamp.output_resistance_ohm);
  std::vector<std::unique_ptr<StageForm>> forms;
  std::vector<std::string> titles;
  for (size_t i = 0; i < stages.size(); ++i) {
    forms.push_back(how[i]->make(stages[i], form_options));
    titles.push_back(title(stages[i], *how[i]));
  }
  const std::vector<Hertz> search_grid = log_grid(band, kSearchGrid);
  PartsFound found = search_parts(forms, titles, options, search_grid);
  if (found.worst_complex_percent > kTrimAbove && !options.capacitors.is_exact()) {
    // Too few parts to meet the gain: a trimming capacitor in the first stage that can have one.
    const Realization& trimmed = realization_named("first-order-trimmed");
    for (size_t i = 0; i < stages.size(); ++i) {
      if (how[i]->name != "first-order" || !trimmed.refusal(stages[i]).empty()) continue;
      std::unique_ptr<StageForm> plain = std::exchange(forms[i], trimmed.make(stages[i], form_options));
      PartsFound better = search_parts(forms, titles, options, search_grid);
      if (better.worst_complex_percent < 0.7 * found.worst_complex_percent) {
        how[i] = &trimmed;
        found = std::move(better);
      } else {
        forms[i] = std::move(plain);
      }
      break;
    }
  }

  if (found.worst_complex_percent > kOtherFormAbove && options.realization == "opamp-rc" &&
      !options.resistors.is_exact()) {
    // Zeros far from the poles are small differences in Tow-Thomas; KHN makes them by sums.
    const Realization& khn = realization_named("khn");
    std::vector<const Realization*> other = how;
    std::vector<std::unique_ptr<StageForm>> other_forms;
    for (size_t i = 0; i < stages.size(); ++i) {
      if (how[i]->name == "tow-thomas" && khn.inverts == how[i]->inverts && khn.refusal(stages[i]).empty())
        other[i] = &khn;
      other_forms.push_back(other[i]->make(stages[i], form_options));
    }
    std::optional<PartsFound> better;
    try {
      if (other != how) better = search_parts(other_forms, titles, options, search_grid);
    } catch (const DesignError&) {
      // Not within these limits: what was found stands.
    }
    if (better && better->worst_complex_percent < 0.7 * found.worst_complex_percent) {
      how = std::move(other);
      forms = std::move(other_forms);
      found = *std::move(better);
    }
  }

  if (!options.isolation_ohm && form_options.isolation_ohm > 0.0 &&
      isolation_costs_db(forms, found, search_grid) > kIsolationAboveDb) {
    // The band reaches up to the isolating poles: better a warning of the phase margin.
    RealiseOptions bare = options;
    bare.isolation_ohm = 0.0;
    return realise(asked, bare);
  }

  Realised out;
  Circuit& circuit = out.circuit;
  circuit.model = options.opamp;
  for (size_t i = 0; i < stages.size(); ++i) {
    add_stage(circuit, *forms[i], *how[i], i, stages.size(), found.values[i], options);
  }
  set_wanted(circuit, how, stages, found.values, search_grid, form_options);

  const std::vector<Biquad> nearest = nearest_rounding(how, stages, circuit, options, form_options);
  report_realised(out, asked, band, [&](RadPerSecond w) {
    Complex h = 1.0;
    for (const Biquad& one : nearest) h *= one.response(w);
    return h;
  });
  return out;
}

}  // namespace bodesmith::circuit
