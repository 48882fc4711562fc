// Any table whose headings say what its columns are: CSV with commas, semicolons or tabs, decimal points or commas, a
// line of units below the headings (PicoScope and others). Among them
// - OMICRON Bode 100 (Bode Analyzer Suite): semicolons, often decimal commas, "Trace 1: Gain: Magnitude (dB)"; the suite of 2016
//   wrote "TR1: Gain (Real)", "TR1: Gain (dB)", "TR2: Gain (Degree)" below "---Measurement Setup---";
// - audio programs: REW, and .frd and .zma files whose comments begin with '*' and name the columns:
//   "* Freq(Hz) SPL(dB) Phase(degrees)", "* Freq(Hz) Z(Ohms) Phase(degrees)".
#include "base/text.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

/// What the program that wrote it is called, by its marks.
std::string called(std::string_view text) {
  const std::string_view head = text.substr(0, 8000);
  for (const char* mark : {"---Measurement settings---", "---Measurement Setup---", "Trace 1: "}) {
    if (head.find(mark) != std::string_view::npos) return "Bode 100 CSV";
  }
  if (trim(head).starts_with('*'))
    return head.find("REW") != std::string_view::npos ? "REW text" : "FRD/ZMA text";
  return "table with headings";
}

class HeadedTable : public Format {
 public:
  std::string_view name() const override { return "table with headings"; }
  bool recognises(const Source& source) const override {
    const auto head = table_head(source);
    if (!head) return false;
    const std::vector<Heading> headings = parse_headings(head->headings);
    return has_response_headings(headings) || is_record(source, *head, headings);
  }
  Foreign read(const Source& source) const override {
    return read_by_headings(source, read_table(source), {called(source.text), {}});
  }
};

}  // namespace

BODESMITH_ENTRY(Format, headed_table, HeadedTable)

}  // namespace bodesmith::formats
