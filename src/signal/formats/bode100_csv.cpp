// OMICRON Bode 100 (Bode Analyzer Suite): semicolons, often decimal commas, headings "Frequency (Hz)", "Trace 1: Gain:
// Real", "Trace 1: Gain: Imaginary", "Trace 1: Gain: Magnitude (dB)", "Trace 2: Gain: Phase (°)"; with or without a
// block "---Measurement settings---" above. The suite of 2016 wrote "---Measurement Setup---", commas and decimal points, and
// "TR1: Gain (Real)", "TR1: Gain (Imag)", "TR1: Gain (dB)", "TR2: Gain (Degree)".
#include "signal/formats/format.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

class Bode100Csv : public Format {
 public:
  std::string_view name() const override { return "Bode 100 CSV"; }
  bool recognises(const Source& source) const override {
    const std::string_view head = source.text.substr(0, 8000);
    return (head.find("---Measurement settings---") != std::string_view::npos ||
            head.find("---Measurement Setup---") != std::string_view::npos ||
            head.find("Trace 1: ") != std::string_view::npos) &&
           looks_like_table(source);
  }
  Foreign read(const Source& source) const override {
    return read_by_headings(source, read_table(source), {std::string(name()), {}});
  }
};

}  // namespace

BODESMITH_ENTRY(Format, bode100_csv, Bode100Csv)

}  // namespace bodesmith::formats
