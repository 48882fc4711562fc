#include <fmt/format.h>

#include <optional>
#include <string>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "filters/design.hpp"
#include "filters/equalisers.hpp"

namespace bodesmith::cli {
namespace {

using filters::Family;
using filters::Kind;

void declare_design(CommandLine& line) {
  line.positional("lowpass|highpass|bandpass|bandstop|peaking|low-shelf|high-shelf|delay", 1, 1);
  line.option<std::string>("family", filters::family_registry().names(), "butterworth");
  line.words("family", filters::family_registry().name_list());
  line.option<int>("order", "order of the low-pass prototype (a band filter has twice as many poles)");
  line.option<double>("corner-hz", "low pass, high pass, shelf: the corner; peaking: the centre");
  line.band("band pass, band stop: lower corner", "upper corner");
  line.option<double>("ripple-db", "largest attenuation in the pass band", 0.5);
  line.option<double>("stop-db", "least attenuation in the stop band", 60.0);
  line.option<double>("gain-db", "peaking and shelves: gain at the centre or end");
  line.option<double>("q", "peaking: quality factor", 1.0);
  line.option<double>("delay-s", "delay: the group delay of the all-pass");
  line.group("Instead of --order and corners: the least order that keeps --ripple-db and --stop-db between");
  line.option<double>("pass-hz", "low pass, high pass: edge of the pass band");
  line.option<double>("stop-hz", "low pass, high pass: edge of the stop band");
  line.list<double>("pass-band-hz", "band pass, band stop: both edges of the pass band");
  line.list<double>("stop-band-hz", "band pass, band stop: both edges of the stop band");
  line.output("file for the sections");
}

struct Designed {
  Sections sections;
  std::string words;
  Json about;
};

std::optional<Kind> kind_of(const std::string& word) {
  for (const Kind kind : {Kind::lowpass, Kind::highpass, Kind::bandpass, Kind::bandstop}) {
    if (word == to_string(kind)) return kind;
  }
  return std::nullopt;
}

bool is_band(Kind kind) {
  return kind == Kind::bandpass || kind == Kind::bandstop;
}

/// A positive option that this kind of filter needs.
double needed(const CommandLine& line, const std::string& option, const std::string& kind) {
  if (!line.has(option)) line.fail(fmt::format("{} needs --{}", kind, option));
  return line.positive(option);
}

Band edges(const CommandLine& line, const std::string& option, const std::string& kind) {
  const auto given = line.maybe<std::vector<double>>(option);
  if (!given || given->size() != 2)
    line.fail(fmt::format("{} needs --{} with two frequencies", kind, option));
  return {Hertz{(*given)[0]}, Hertz{(*given)[1]}};
}

bool wants_mask(const CommandLine& line) {
  return line.has("pass-hz") || line.has("stop-hz") || line.has("pass-band-hz") || line.has("stop-band-hz");
}

filters::Mask read_mask(const CommandLine& line, Kind kind, const std::string& word) {
  if (line.has("order") || line.has("corner-hz") || line.has("from-hz")) {
    line.fail("a mask (--pass-hz …) and --order or corners cannot be combined");
  }
  filters::Mask mask;
  mask.kind = kind;
  mask.ripple_db = line.positive("ripple-db");
  mask.stop_db = line.positive("stop-db");
  if (is_band(kind)) {
    mask.pass = edges(line, "pass-band-hz", word);
    mask.stop = edges(line, "stop-band-hz", word);
  } else {
    mask.pass.from = mask.pass.to = Hertz{needed(line, "pass-hz", word)};
    mask.stop.from = mask.stop.to = Hertz{needed(line, "stop-hz", word)};
  }
  return mask;
}

filters::Placing read_placing(const CommandLine& line, Kind kind, const std::string& word) {
  filters::Placing placing{kind, {}};
  if (is_band(kind)) {
    const std::optional<Band> band = line.maybe_band();
    if (!band) line.fail(fmt::format("{} needs --from-hz and --to-hz", word));
    placing.corner = *band;
  } else {
    placing.corner.from = placing.corner.to = Hertz{needed(line, "corner-hz", word)};
  }
  return placing;
}

Designed standard_filter(const CommandLine& line, Kind kind, const std::string& word) {
  const Family& family = filters::family_registry().get(line.get<std::string>("family"));
  if (wants_mask(line)) {
    const filters::MaskedDesign design = least_order(family, read_mask(line, kind, word));
    return {place(design.prototype, design.placing),
            fmt::format("{} {}, order {} is the least: {} dB at the pass edge, {} dB at the stop edge",
                        family.name(), word, design.order, rounded_text(design.ripple_db),
                        rounded_text(design.stop_db)),
            {{"family", family.name()},
             {"kind", word},
             {"order", design.order},
             {"pass_edge_db", design.ripple_db},
             {"stop_edge_db", design.stop_db}}};
  }
  if (!line.has("order")) line.fail(fmt::format("{} needs --order, or a mask (--pass-hz …)", word));
  const filters::PrototypeTask task{line.get<int>("order"), line.get<double>("ripple-db"),
                                    line.get<double>("stop-db")};
  const filters::Prototype prototype = make_prototype(family, task);
  return {place(prototype, read_placing(line, kind, word)),
          fmt::format("{} {}, order {} ({})", family.name(), word, task.order, family.what()),
          {{"family", family.name()}, {"kind", word}, {"order", task.order}}};
}

Designed equaliser(const CommandLine& line, const std::string& word) {
  if (word == "delay") {
    const double delay_s = needed(line, "delay-s", word);
    const int order = line.has("order") ? line.get<int>("order") : 2;
    return {filters::delay_allpass(delay_s, order),
            fmt::format("all-pass of order {} that delays by {}", order, engineering_text(delay_s, "s")),
            {{"kind", word}, {"order", order}, {"delay_s", delay_s}}};
  }
  const Hertz corner{needed(line, "corner-hz", word)};
  if (!line.has("gain-db")) line.fail(fmt::format("{} needs --gain-db", word));
  const auto gain_db = line.get<double>("gain-db");
  Json about = {{"kind", word}, {"corner_hz", corner.value}, {"gain_db", gain_db}};
  const std::string words =
      fmt::format("{}, {} dB at {}", word, rounded_text(gain_db), engineering_text(corner.value, "Hz"));
  if (word == "low-shelf") return {filters::low_shelf(corner, gain_db), words, about};
  if (word == "high-shelf") return {filters::high_shelf(corner, gain_db), words, about};
  return {filters::peaking(corner, gain_db, line.positive("q")), words, about};
}

std::string roots_summary(const Sections& sections) {
  std::string text;
  for (const Section& section : sections.sections) {
    const Complex pole = section.poles.front();
    text += fmt::format("  pole{} at {}", section.poles.size() == 1 ? "" : "s",
                        engineering_text(RadPerSecond{std::abs(pole)}.hz().value, "Hz", 5));
    if (pole.imag() != 0.0)
      text += fmt::format(", Q {}", rounded_text(-0.5 * std::abs(pole) / pole.real(), 5));
    if (!section.zeros.empty()) {
      text +=
          fmt::format("; zero{} at {}", section.zeros.size() == 1 ? "" : "s",
                      engineering_text(RadPerSecond{std::abs(section.zeros.front())}.hz().value, "Hz", 5));
    }
    text += "\n";
  }
  return text;
}

}  // namespace

int run_design(const std::vector<std::string>& arguments) {
  CommandLine line(
      "design",
      "bodesmith design lowpass --family elliptic --order 5 --corner-hz 1000 --ripple-db 0.5 --stop-db 60 "
      "-o sections.json",
      "Standard filters and equalisers as sections, for fpaa, spice, yield and the rest.\n"
      "The corner is -3 dB (butterworth, bessel, gaussian), -6 dB (linkwitz-riley), the edge of the ripple\n"
      "(chebyshev1, elliptic) or of the stop band (chebyshev2).");
  declare_design(line);
  if (!line.parse(arguments)) return kDone;
  const std::string word = line.files().front();
  const std::optional<Kind> kind = kind_of(word);
  if (!kind && word != "peaking" && word != "low-shelf" && word != "high-shelf" && word != "delay") {
    line.fail(
        fmt::format("there is no '{}', expected lowpass, highpass, bandpass, bandstop, peaking, low-shelf, "
                    "high-shelf or delay",
                    word));
  }
  const Stopwatch watch;
  const Designed designed = kind ? standard_filter(line, *kind, word) : equaliser(line, word);
  const double seconds = watch.seconds();

  const Provenance from;
  Json out = designed.sections.to_json();
  out["design"] = designed.about;
  write_file(line.output_path(), to_text(timed_document("sections", from, out, seconds)));
  Json summary = designed.about;
  summary["poles"] = designed.sections.pole_count();
  summary["sections"] = designed.sections.sections.size();
  return print_summary(line, designed.words + "\n" + roots_summary(designed.sections),
                       timed_document("design_summary", from, summary, seconds));
}

}  // namespace bodesmith::cli
