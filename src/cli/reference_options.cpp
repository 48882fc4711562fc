#include "cli/reference_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace bodesmith::cli {
namespace {

constexpr double kSamplesAPeriod = 500.0;
constexpr double kSamplesOfTheHighest = 20.0;
constexpr double kPeriods = 3.0;

}  // namespace

void add_reference_options(CommandLine& line, UsualLength usual) {
  const bool periods = usual == UsualLength::periods;
  line.option<double>("frequency-hz", "of the reference; of a chirp's or multisine's lowest end", 1.0);
  line.option<double>("last-hz", "highest frequency of a chirp or multisine", 100.0);
  line.option<double>("amplitude", "half the height of the reference", 0.5);
  line.option<double>("offset", "middle of the reference (default: the amplitude, so that it starts at 0)");
  line.option<double>(
      "duration-s", fmt::format("length of the reference (default: {})", periods ? "three periods" : "1 s"));
  line.option<double>(
      "step-s", fmt::format("time between its samples (default: {})", periods ? "500 a period" : "1 ms"));
  line.option<int>("steps", "levels of a stair", 10);
}

simulate::ReferenceSpec read_reference_options(const CommandLine& line, const std::string& kind,
                                               UsualLength usual) {
  simulate::ReferenceSpec spec;
  spec.kind = kind;
  spec.frequency = Hertz{line.positive("frequency-hz")};
  spec.last = Hertz{line.positive("last-hz")};
  spec.amplitude = line.positive("amplitude");
  spec.offset = line.maybe<double>("offset").value_or(spec.amplitude);
  const double period = 1.0 / simulate::fundamental_of(spec).value_or(spec.frequency).value;
  const bool periods = usual == UsualLength::periods;
  spec.duration_s = line.maybe_positive("duration-s").value_or(periods ? kPeriods * period : 1.0);
  const bool wide = kind == "chirp" || kind == "multisine";
  const double step = wide
                          ? std::min(period / kSamplesAPeriod, 1.0 / (kSamplesOfTheHighest * spec.last.value))
                          : period / kSamplesAPeriod;
  spec.step_s = line.maybe_positive("step-s").value_or(periods ? step : 1e-3);
  spec.steps = line.get<int>("steps");
  spec.seed = line.seed_value();
  return spec;
}

bool names_a_reference(const std::string& text) {
  std::error_code ignored;
  if (std::filesystem::exists(text, ignored)) return false;
  const auto& kinds = simulate::reference_kinds();
  return text == "steps" || std::any_of(kinds.begin(), kinds.end(), [&](const simulate::ReferenceKind& kind) {
           return kind.name == text;
         });
}

}  // namespace bodesmith::cli
