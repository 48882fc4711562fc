#include <fmt/format.h>

#include <optional>
#include <string>

#include "approximate/approximate.hpp"
#include "approximate/merge_sections.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/approximate_modes.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "lti/section_making.hpp"

namespace bodesmith::cli {
namespace {

namespace po = boost::program_options;

std::string summary_text(const CascadeApproximation& result) {
  std::string text = fmt::format("{}: {} sections, {} poles\n", result.method,
                                 result.sections.sections.size(), result.sections.pole_count());
  for (const TermApproximation& term : result.terms) {
    text += fmt::format(
        "  {:>10} .. {:<10} Hz  beta {:<9} order {:<2}  {:>9} dB  (no approximation below {} dB)\n",
        rounded_text(term.term.low_corner().hz().value), rounded_text(term.term.high_corner().hz().value),
        rounded_text(term.term.beta), term.order, rounded_text(term.error.everywhere_db, 3),
        rounded_text(term.limit_law_db, 3));
  }
  text +=
      fmt::format("whole cascade: {} dB and {} deg over {} .. {} Hz, {} dB and {} deg at any frequency\n",
                  rounded_text(result.error.band_db, 3), rounded_text(result.error.band_deg, 3),
                  rounded_text(result.error.band.from.value), rounded_text(result.error.band.to.value),
                  rounded_text(result.error.everywhere_db, 3), rounded_text(result.error.everywhere_deg, 3));
  if (!result.limit_met) {
    text += fmt::format("the limit of {} dB is NOT met\n", rounded_text(result.max_error_db));
  }
  return text;
}

}  // namespace

int run_approximate(const std::vector<std::string>& arguments) {
  CommandLine line("approximate", "bodesmith approximate cascade.json -o sections.json --max-error-db 0.01",
                   "Turns the fractional terms of a cascade into integer pole-zero sections; or a whole "
                   "fractional transfer\n"
                   "function (bodesmith.fractional/1: a fractional PID, s^alpha) into sections over a band:\n"
                   "  bodesmith approximate pid.toml --from-hz 0.1 --to-hz 1000 --order 6 -o sections.json");
  std::string methods;
  for (const ApproximationMethod& method : approximation_methods()) {
    methods += (methods.empty() ? "" : ", ") + std::string(method.name);
  }
  line.options().add_options()("method", po::value<std::string>()->default_value("minimax"), methods.c_str())(
      "order", po::value<int>(), "poles of each term's approximation, whole powers counted (default 4)")(
      "max-error-db", po::value<double>(),
      "instead of --order: the fewest poles with which the whole cascade stays within this at every "
      "frequency")("over-band", "minimax: equal ripple between the corners instead of over all frequencies")(
      "complex",
      "minimax with |beta| > 2: allow complex pairs of poles and zeros (a fraction of the error of real "
      "ones)")("arrange",
               "pair and order the sections for the smallest internal span, with even stage gains")(
      "merge-db", po::value<double>(),
      "leave out pole-zero pairs that nearly cancel while the error at every frequency stays within this")(
      "biquads", "pairs of real poles as one section of second order")(
      "max-order", po::value<int>()->default_value(12),
      "largest order of a term that --max-error-db may choose");
  add_fractional_options(line.options());
  line.positional("CASCADE.json|FRACTIONAL.toml", 1, 1);
  line.seed();
  line.output("where the sections go");
  if (!line.parse(arguments)) return kDone;

  ApproximationOptions options;
  options.method = line.get<std::string>("method");
  options.order = line.maybe<int>("order");
  if (line.maybe<double>("max-error-db")) options.max_error_db = line.positive("max-error-db");
  if (options.order && options.max_error_db) line.fail("--order and --max-error-db exclude each other");
  if (options.order && (*options.order < 1 || *options.order > 40)) {
    line.fail(fmt::format("--order is {}, expected 1 to 40", *options.order));
  }
  options.max_order = line.get<int>("max-order");
  if (options.max_order < 1 || options.max_order > 40)
    line.fail("--max-order is out of range, expected 1 to 40");
  options.over_band = line.has("over-band");
  options.real_roots = !line.has("complex");
  (void)approximation_method(options.method);
  const std::filesystem::path file = line.files().front();
  if (file.extension() == ".toml") return approximate_fractional(line);
  for (const char* option : {"from-hz", "to-hz"}) {
    if (line.has(option))
      line.fail(std::string("--") + option + " is for a FRACTIONAL.toml; a cascade has its corners");
  }

  Provenance from;
  const Cascade cascade = Cascade::read(line.files().front(), from);
  const Stopwatch watch;
  CascadeApproximation result = approximate_cascade(cascade, options);
  std::optional<int> left_out;
  if (line.has("merge-db")) {
    const MergedSections merged = merge_sections(result.sections, cascade, line.positive("merge-db"));
    result.sections = merged.sections;
    result.error = merged.error;
    left_out = merged.pairs_left_out;
  }
  if (line.has("biquads")) result.sections = as_biquads(result.sections);
  std::optional<OrderedSections> arranged;
  if (line.has("arrange")) {
    arranged = order_sections(result.sections, result.error.band);
    result.sections = arranged->sections;
  }
  const double seconds = watch.seconds();

  Json out = json_header("sections", from);
  out.update(result.sections.to_json());
  out["approximation"] = result.report_json();
  if (arranged) {
    out["arrangement"] = {{"span_before_db", arranged->span_before_db},
                          {"span_after_db", arranged->span_after_db},
                          {"exhaustive", arranged->exhaustive}};
  }
  if (left_out) out["pairs_left_out"] = *left_out;
  out["timing_s"] = {{"compute", seconds}};
  write_file(line.output_path(), to_text(out));

  Json summary = json_header("approximate_summary", from);
  summary["sections"] = result.sections.sections.size();
  summary["poles"] = result.sections.pole_count();
  summary.update(result.report_json());
  summary["error"] = result.sections.to_json()["error"];
  summary["timing_s"] = {{"compute", seconds}};
  std::string text = summary_text(result);
  if (left_out) {
    text += fmt::format("{} near-cancelling pairs left out: {} poles, {} dB\n", *left_out,
                        result.sections.pole_count(), rounded_text(result.error.everywhere_db, 3));
  }
  if (arranged) {
    text += fmt::format("internal span {} dB, {} dB before pairing and ordering\n",
                        rounded_text(arranged->span_after_db, 3), rounded_text(arranged->span_before_db, 3));
  }
  print_summary(line, text, summary);
  return result.limit_met ? kDone : kLimitMissed;
}

}  // namespace bodesmith::cli
