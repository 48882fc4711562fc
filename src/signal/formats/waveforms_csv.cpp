// Digilent WaveForms: network analyser ("Frequency (Hz),Channel 1 Magnitude (dB),Channel 2 Magnitude (dB),Channel 2
// Phase (*)"; the frequency may be in kHz, the separator a tab) and scope or logger ("Time (s),Channel 1 (V),Channel 2
// (V)"). Lines of '#' above say, among others, whether a channel's magnitude is relative to channel 1.
#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

std::optional<std::size_t> channel_magnitude(const std::vector<Heading>& headings, std::string_view channel) {
  for (std::size_t i = 0; i < headings.size(); ++i) {
    if (headings[i].quantity == Quantity::magnitude && headings[i].text.starts_with(channel)) return i;
  }
  return std::nullopt;
}

/// What "#Relative:" says below "#Channel: Channel 2"; nothing without such lines.
std::optional<bool> second_is_relative(const std::vector<std::string>& above) {
  bool second = false;
  std::optional<bool> relative;
  for (const std::string& line : above) {
    if (line.starts_with("#Channel:")) second = line.find("Channel 2") != std::string::npos;
    if (second && line.starts_with("#Relative:")) relative = line.find("yes") != std::string::npos;
  }
  return relative;
}

bool is_spectrum(const std::string& line) {
  return line.starts_with("#Digilent WaveForms Spectrum");
}

class WaveformsCsv : public Format {
 public:
  std::string_view name() const override { return "Digilent WaveForms CSV"; }
  bool recognises(const Source& source) const override {
    const std::string_view head = source.text.substr(0, 4000);
    return (head.find("#Digilent WaveForms") != std::string_view::npos ||
            head.find("Channel 2 Magnitude") != std::string_view::npos) &&
           looks_like_table(source);
  }
  Foreign read(const Source& source) const override {
    NumberTable table = read_table(source);
    Words words{std::string(name()), {}};
    const std::vector<Heading> headings = parse_headings(table.headings);
    if (source.choice.empty() && std::ranges::any_of(table.above, is_spectrum))
      throw InputError(
          source.file, table.lines.front(),
          "begins a spectrum, expected a response of the network analyser (FILE:NAME/NAME is one trace "
          "over another)");
    const auto first = channel_magnitude(headings, "Channel 1");
    const auto second = channel_magnitude(headings, "Channel 2");
    Source chosen = source;
    if (!has_response_headings(headings) || !second || !source.choice.empty()) {
      // Besides the channels there may be mathematical ones.
      if (source.choice.empty() && find_name(table.headings, "Channel 1") &&
          find_name(table.headings, "Channel 2"))
        chosen.choice = "Channel 1,Channel 2";
      return read_by_headings(chosen, std::move(table), std::move(words));
    }
    const auto relative = second_is_relative(table.above);
    if (first && relative && !*relative) {
      Words aside;
      const auto a = decibels(source, headings[*first].magnitude, table.columns[*first], aside);
      auto b = decibels(source, headings[*second].magnitude, table.columns[*second], aside);
      for (std::size_t i = 0; i < b.size(); ++i) b[i] -= a[i];
      table.columns[*second] = std::move(b);
      table.headings[*second] = "Channel 2 Magnitude (dB)";
      words.notes.emplace_back("channel 2 less channel 1 in dB, the file's channel 2 not being relative");
    } else {
      words.notes.emplace_back("channel 2 relative to channel 1");
    }
    chosen.choice = table.headings[*second];
    return read_by_headings(chosen, std::move(table), std::move(words));
  }
};

}  // namespace

BODESMITH_ENTRY(Format, waveforms_csv, WaveformsCsv)

}  // namespace bodesmith::formats
