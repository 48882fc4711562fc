#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "approximate/approximate.hpp"
#include "approximate/merge_sections.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/modes.hpp"
#include "lti/section_making.hpp"

namespace bodesmith::cli {
namespace {

std::string approximation_summary(const CascadeApproximation& result) {
  if (result.sections.sections.empty()) {
    return fmt::format("every order is 0: a plain gain of {}, no filter is needed\n",
                       rounded_text(result.sections.gain, 6));
  }
  std::string text = fmt::format("{}: {} sections, {} poles\n", result.method,
                                 result.sections.sections.size(), result.sections.pole_count());
  text +=
      fmt::format("whole cascade: {} dB and {} deg over {} .. {} Hz, {} dB and {} deg at any frequency\n",
                  rounded_text(result.error.band_db, 3), rounded_text(result.error.band_deg, 3),
                  rounded_text(result.error.band.from.value), rounded_text(result.error.band.to.value),
                  rounded_text(result.error.everywhere_db, 3), rounded_text(result.error.everywhere_deg, 3));
  for (const TermApproximation& term : result.terms) {
    text += fmt::format("  {:>10} .. {:<10} Hz  beta {:<9} order {:<2}  {:>9} dB  (at best {} dB)\n",
                        rounded_text(term.term.low_corner().hz().value),
                        rounded_text(term.term.high_corner().hz().value), rounded_text(term.term.beta),
                        term.order, rounded_text(term.error.everywhere_db, 3),
                        rounded_text(term.limit_law_db, 3));
  }
  if (!result.limit_met()) text += limit_not_met(*result.max_error_db, "dB");
  return text;
}

void declare_approximate(CommandLine& line) {
  line.option<std::string>("method", method_registry().names(), ApproximationOptions{}.method);
  line.words("method", method_registry().name_list());
  line.option<int>("order", "poles of each term's approximation, whole powers counted (default 4)");
  line.option<double>(
      "max-error-db",
      "instead of --order: the fewest poles with which the error of the whole cascade stays within "
      "this at every frequency");
  line.flag("over-band", "minimax: equal ripple between the corners instead of over all frequencies");
  line.flag(
      "complex",
      "minimax with |beta| > 2: allow complex pairs of poles and zeros (a fraction of the error of real ones)");
  line.flag("arrange", "pair and order the sections for the smallest internal span, with even stage gains");
  line.option<double>(
      "merge-db",
      "leave out pole-zero pairs that nearly cancel while the error at every frequency stays within "
      "this");
  line.flag("biquads", "pairs of real poles as one second-order section");
  line.option<int>("max-order", "largest order of a term that --max-error-db may choose", 12);
  add_fractional_options(line);
  line.positional("CASCADE.json|FRACTIONAL.toml", 1, 1);
  line.seed();
  line.output("file for the sections");
}

ApproximationOptions read_approximation_options(const CommandLine& line) {
  ApproximationOptions options;
  options.method = line.get<std::string>("method");
  (void)method_registry().get(options.method);
  options.max_error_db = line.maybe_positive("max-error-db");
  if (line.has("order")) options.order = line.integer("order", 1, 40);
  if (options.order && options.max_error_db) line.fail("--order and --max-error-db cannot be combined");
  options.max_order = line.integer("max-order", 1, 40);
  if (options.method == "minimax") {
    options.over_band = line.has("over-band");
    options.real_roots = !line.has("complex");
  }
  return options;
}

/// What --merge-db and --arrange did to the sections.
struct Rearrangement {
  std::optional<int> pairs_left_out;
  std::optional<OrderedSections> order;
};

Rearrangement rearrange(const CommandLine& line, const Cascade& cascade, CascadeApproximation& result) {
  Rearrangement out;
  if (line.has("merge-db")) {
    const MergedSections merged = merge_sections(result.sections, cascade, line.positive("merge-db"));
    result.sections = merged.sections;
    result.error = merged.error;
    out.pairs_left_out = merged.pairs_left_out;
  }
  if (result.sections.sections.empty()) return out;
  if (line.has("biquads")) result.sections = as_biquads(result.sections);
  if (line.has("arrange")) {
    out.order = order_sections(result.sections, result.error.band);
    result.sections = out.order->sections;
  }
  return out;
}

Json sections_json(const CascadeApproximation& result, const Rearrangement& done) {
  Json out = result.sections.to_json();
  out["approximation"] = result.report_json();
  if (done.order) {
    out["arrangement"] = {{"span_before_db", done.order->span_before_db},
                          {"span_after_db", done.order->span_after_db},
                          {"exhaustive", done.order->exhaustive}};
  }
  if (done.pairs_left_out) out["pairs_left_out"] = *done.pairs_left_out;
  return out;
}

std::string rearrangement_text(const CascadeApproximation& result, const Rearrangement& done) {
  std::string text;
  if (done.pairs_left_out) {
    text += fmt::format("{} near-cancelling pairs left out: {} poles, {} dB\n", *done.pairs_left_out,
                        result.sections.pole_count(), rounded_text(result.error.everywhere_db, 3));
  }
  if (done.order) {
    text +=
        fmt::format("internal span {} dB, {} dB before pairing and ordering\n",
                    rounded_text(done.order->span_after_db, 3), rounded_text(done.order->span_before_db, 3));
  }
  return text;
}

/// With |beta| above 2 real poles and zeros cost accuracy; what complex pairs would reach, where that is worth a word.
std::string complex_hint(const Cascade& cascade, const ApproximationOptions& options,
                         const CascadeApproximation& real) {
  constexpr double kWorthAWord = 0.97;
  const bool steep = std::ranges::any_of(
      real.terms, [](const TermApproximation& term) { return std::abs(term.term.beta) > 2.0; });
  if (!steep || !options.real_roots || options.method != ApproximationOptions{}.method ||
      options.max_error_db)
    return {};
  ApproximationOptions complex = options;
  complex.real_roots = false;
  try {
    const CascadeApproximation other = approximate_cascade(cascade, complex);
    if (other.error.everywhere_db > kWorthAWord * real.error.everywhere_db) return {};
    return fmt::format("with complex pairs of poles and zeros (--complex) {} dB at any frequency\n",
                       rounded_text(other.error.everywhere_db, 3));
  } catch (const DesignError&) {
    return {};  // complex pairs do not converge for every term
  }
}

int approximate_file(const CommandLine& line, const ApproximationOptions& options) {
  for (const char* option : {"from-hz", "to-hz", "keep-integrator", "real"}) {
    if (line.has(option))
      line.fail(std::string("--") + option + " is for a FRACTIONAL.toml; a cascade has its corners");
  }
  Provenance from;
  const Cascade cascade = Cascade::read(line.files().front(), from);
  const Stopwatch watch;
  CascadeApproximation result = approximate_cascade(cascade, options);
  const std::string hint = complex_hint(cascade, options, result);
  const Rearrangement done = rearrange(line, cascade, result);
  const double seconds = watch.seconds();
  write_file(line.output_path(),
             to_text(timed_document("sections", from, sections_json(result, done), seconds)));

  Json summary = {{"sections", result.sections.sections.size()}, {"poles", result.sections.pole_count()}};
  summary.update(result.report_json());
  if (result.sections.error) summary["error"] = result.sections.to_json()["error"];
  return print_summary(line, approximation_summary(result) + hint + rearrangement_text(result, done),
                       timed_document("approximate_summary", from, summary, seconds), result.limit_met());
}

}  // namespace

int run_approximate(const std::vector<std::string>& arguments) {
  CommandLine line(
      "approximate", "bodesmith approximate cascade.json -o sections.json --max-error-db 0.01",
      "Turns the fractional terms of a cascade into integer pole-zero sections; or a whole fractional\n"
      "transfer function (bodesmith.fractional/1: a fractional PID, s^alpha) into sections over a band:\n"
      "  bodesmith approximate pid.toml --from-hz 0.1 --to-hz 1000 --order 6 -o sections.json");
  declare_approximate(line);
  if (!line.parse(arguments)) return kDone;
  const ApproximationOptions options = read_approximation_options(line);
  const bool fractional = std::filesystem::path(line.files().front()).extension() == ".toml";
  return fractional ? approximate_fractional(line) : approximate_file(line, options);
}

}  // namespace bodesmith::cli
