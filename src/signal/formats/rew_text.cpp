// Text of audio programs: REW, and .frd (frequency, level, phase) and .zma (frequency, impedance, phase) files whose
// comments begin with '*' and name the columns: "* Freq(Hz) SPL(dB) Phase(degrees)", "* Freq(Hz) Z(Ohms) Phase(degrees)".
#include <algorithm>

#include "signal/formats/format.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {

const Format& plain_table();

namespace {

class RewText : public Format {
 public:
  std::string_view name() const override { return "FRD/ZMA text (REW and others)"; }
  bool recognises(const Source& source) const override {
    const std::size_t first = source.text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos || source.text[first] != '*' || !looks_like_table(source))
      return false;
    return true;
  }
  Foreign read(const Source& source) const override {
    NumberTable table = read_table(source);
    const bool rew = std::any_of(table.above.begin(), table.above.end(), [](const std::string& line) {
      return line.find("REW") != std::string::npos;
    });
    Words words{rew ? "REW text" : "FRD/ZMA text", {}};
    const std::vector<Heading> headings = parse_headings(table.headings);
    if (!has_response_headings(headings)) return plain_table().read(source);
    const bool impedance = std::any_of(headings.begin(), headings.end(), [](const Heading& h) {
      return h.quantity == Quantity::magnitude && (h.unit == "Ohms" || h.unit == "ohms" || h.unit == "Ohm");
    });
    if (impedance) words.notes.emplace_back("an impedance: 0 dB is 1 ohm");
    return read_by_headings(source, std::move(table), std::move(words));
  }
};

}  // namespace

BODESMITH_ENTRY(Format, rew_text, RewText)

}  // namespace bodesmith::formats
