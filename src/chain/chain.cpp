#include "chain/chain.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace bodesmith::chain {

std::vector<std::string> Trained::beyond(const SignalExtent& drive, double least_output,
                                         double most_output) const {
  std::vector<std::string> out;
  const auto say = [&](std::string what, double value, std::string trained) {
    out.push_back(fmt::format("{} {}, the training records' {}", what, rounded_text(value), trained));
  };
  // A little beyond the ends is nothing new.
  const double width = 0.01 * (input.upper - input.lower);
  const std::string range =
      fmt::format("from {} to {}", rounded_text(input.lower), rounded_text(input.upper));
  if (drive.lower < input.lower - width) say("the drive goes down to", drive.lower, range);
  if (drive.upper > input.upper + width) say("the drive goes up to", drive.upper, range);
  if (drive.max_rate_per_s > 1.1 * input.max_rate_per_s)
    say("the drive's rate a second goes up to", drive.max_rate_per_s,
        fmt::format("up to {}", rounded_text(input.max_rate_per_s)));
  if (drive.to_hz > 1.5 * input.to_hz)
    say("the drive's frequencies in Hz go up to", drive.to_hz,
        fmt::format("up to {}", rounded_text(input.to_hz)));
  const double height = 0.01 * (output_upper - output_lower);
  const std::string outputs =
      fmt::format("from {} to {}", rounded_text(output_lower), rounded_text(output_upper));
  if (least_output < output_lower - height) say("the reference goes down to", least_output, outputs);
  if (most_output > output_upper + height) say("the reference goes up to", most_output, outputs);
  return out;
}

std::string Trained::far_beyond(const SignalExtent& drive) const {
  const double reach = 0.1 * (input.upper - input.lower);
  if (drive.lower >= input.lower - reach && drive.upper <= input.upper + reach) return {};
  return fmt::format("the drive goes from {} to {}, the training records' from {} to {}",
                     rounded_text(drive.lower), rounded_text(drive.upper), rounded_text(input.lower),
                     rounded_text(input.upper));
}

std::optional<Complex> Chain::response(RadPerSecond w) const {
  Complex h = 1.0;
  for (const Block& block : blocks) {
    const auto factor = block.response(w);
    if (!factor) return std::nullopt;
    h *= *factor;
  }
  return h;
}

std::string Chain::label(const Parameter& parameter) const {
  for (size_t i = 0; i < blocks.size(); ++i) {
    for (const Parameter& p : blocks[i].parameters()) {
      if (&p != &parameter) continue;
      const std::string& part = blocks[i].part;
      return fmt::format("block {} ({}{}{}) {}", i + 1, blocks[i].type_name(), part.empty() ? "" : ", ", part,
                         p.name());
    }
  }
  return parameter.name();
}

}  // namespace bodesmith::chain
