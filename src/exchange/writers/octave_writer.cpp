// An Octave (or MATLAB) script that rebuilds sections, a linear model or an FPAA plan, with the control package where it is there, and checks itself.
#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "exchange/writer.hpp"
#include "exchange/writers/script_data.hpp"

namespace bodesmith::exchange {
namespace {

class OctaveWriter : public Writer {
 public:
  std::string_view name() const override { return "octave"; }
  std::string_view endings() const override { return ".m"; }
  std::string_view what() const override {
    return "an Octave or MATLAB script that rebuilds sections, a linear model or an FPAA plan";
  }
  Written write(const Exportable& from, const ExportOptions&) const override {
    const auto text = [](const std::complex<double>& c) {
      if (c.imag() == 0.0) return number_text(c.real());
      return fmt::format("complex({}, {})", number_text(c.real()), number_text(c.imag()));
    };
    const std::vector<std::string> said = {
        "it compares itself with responses computed here and ends with an error where they differ"};
    if (is_model(from)) return {render_template("exchange/model.m", model_script_data(from, text)), said};
    if (is_plan(from)) return {render_template("exchange/plan.m", plan_script_data(from, text)), said};
    return {render_template("exchange/sections.m", script_data(from, need_sections(from, *this), text)),
            said};
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, octave_writer, OctaveWriter)

}  // namespace bodesmith::exchange
