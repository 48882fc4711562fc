// A Python script that rebuilds sections, a linear model or an FPAA plan with python-control, and checks itself against responses computed here.
#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "exchange/writer.hpp"
#include "exchange/writers/script_data.hpp"

namespace bodesmith::exchange {
namespace {

class PythonWriter : public Writer {
 public:
  std::string_view name() const override { return "python-control"; }
  std::string_view endings() const override { return ".py"; }
  std::string_view what() const override {
    return "a script that rebuilds sections, a linear model or an FPAA plan with python-control";
  }
  Written write(const Exportable& from, const ExportOptions&) const override {
    const auto text = [](const std::complex<double>& c) {
      if (c.imag() == 0.0) return number_text(c.real());
      return fmt::format("complex({}, {})", number_text(c.real()), number_text(c.imag()));
    };
    const std::vector<std::string> said = {
        "run by itself it compares python-control's system with responses computed here"};
    if (is_model(from)) return {render_template("exchange/model.py", model_script_data(from, text)), said};
    if (is_plan(from)) return {render_template("exchange/plan.py", plan_script_data(from, text)), said};
    return {render_template("exchange/sections.py", script_data(from, need_sections(from, *this), text)),
            said};
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, python_writer, PythonWriter)

}  // namespace bodesmith::exchange
