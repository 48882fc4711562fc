// An Octave (or MATLAB) script that rebuilds sections, a linear model or a board, with the control package where it is there, and checks itself.
// A Python script that rebuilds sections, a linear model or a board with python-control, and checks itself against responses computed here.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "base/documents/json.hpp"
#include "base/documents/json_fwd.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "exchange/writer.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::exchange {
namespace {

/// How a language writes a complex number: "1.0-2.0j", "complex(1.0,-2.0)".
using ComplexText = std::function<std::string(const Complex&)>;

std::string root_list(const std::vector<Complex>& roots, const ComplexText& text) {
  std::vector<std::string> out;
  for (const Complex& root : roots) out.push_back(text(root));
  return join(out, ", ");
}

std::string number_list(const std::vector<double>& numbers) {
  std::vector<std::string> out;
  for (const double number : numbers) out.push_back(number_text(number));
  return join(out, ", ");
}

/// The blocks in series at some of the source's own points.
Json checks_of(const Exportable& from, const ComplexText& text) {
  Json out = Json::array();
  const std::vector<Hertz>& grid = from.response->frequency;
  for (std::size_t i = 0; i < grid.size(); i += std::max<std::size_t>(1, grid.size() / 12)) {
    const Complex s(0.0, grid[i].rad_s().value);
    Complex h = 1.0;
    for (const ChainBlock& block : from.chain) h *= response(block.system, s) * std::exp(-s * block.delay_s);
    out.push_back({{"frequency_hz", number_text(grid[i].value)}, {"response", text(h)}});
  }
  return out;
}

/// {source, name, blocks: [{name, order, a, b, c, d, delay_s}], checks}: matrices row by row.
Json model_script_data(const Exportable& from, const ComplexText& text) {
  Json data = {{"source", from.source},
               {"name", from.name},
               {"blocks", Json::array()},
               {"checks", checks_of(from, text)}};
  for (const ChainBlock& block : from.chain) {
    data["blocks"].push_back({{"name", block.name},
                              {"order", std::to_string(block.system.order())},
                              {"a", number_list(block.system.a)},
                              {"b", number_list(block.system.b)},
                              {"c", number_list(block.system.c)},
                              {"d", number_text(block.system.d)},
                              {"delay_s", number_text(block.delay_s)}});
  }
  return data;
}

/// What the scripts' templates are filled with: source, name, gain, delay_s, sections (gain, zeros, poles as lists of
/// text), and responses at a few frequencies, by which a script checks itself.
Json script_data(const Exportable& from, const Sections& sections, const ComplexText& text) {
  Json data = {{"source", from.source},
               {"name", from.name},
               {"gain", number_text(sections.gain)},
               {"delay_s", number_text(sections.delay_s)},
               {"sections", Json::array()},
               {"checks", Json::array()}};
  for (std::size_t i = 0; i < sections.sections.size(); ++i) {
    const Section& section = sections.sections[i];
    data["sections"].push_back({{"number", std::to_string(i + 1)},
                                {"gain", number_text(section.gain)},
                                {"zeros", root_list(section.zeros, text)},
                                {"poles", root_list(section.poles, text)}});
  }
  Band band = sections.corner_band();
  if (!(band.to.value > 0.0)) band = {Hertz{1.0}, Hertz{1.0}};
  band = {Hertz{0.3 * band.from.value}, Hertz{3.0 * band.to.value}};
  for (const Hertz f : log_grid(band, 7)) {
    const Complex s(0.0, f.rad_s().value);
    data["checks"].push_back(
        {{"frequency_hz", number_text(f.value)}, {"response", text(sections.response(s))}});
  }
  return data;
}

/// Of the templates with its ending; both languages write complex numbers alike.
class ScriptWriter : public Writer {
 public:
  bool rebuilds_chains() const override { return true; }

 protected:
  using Writer::Writer;
  Written script(const Exportable& from, const std::string& said) const {
    const auto text = [](const Complex& c) {
      if (c.imag() == 0.0) return number_text(c.real());
      return fmt::format("complex({}, {})", number_text(c.real()), number_text(c.imag()));
    };
    const auto rendered = [&](const char* what, const Json& data) {
      return Written{render_template(fmt::format("exchange/{}{}", what, endings()), data), {said}};
    };
    if (!from.chain.empty()) return rendered("model", model_script_data(from, text));
    return rendered("sections", script_data(from, need_sections(from, *this), text));
  }
};

class OctaveWriter : public ScriptWriter {
 public:
  OctaveWriter()
      : ScriptWriter("octave", ".m",
                     "an Octave or MATLAB script that rebuilds sections, a linear model or a board") {}
  Written write(const Exportable& from, const ExportOptions&) const override {
    return script(from,
                  "it compares itself with responses computed here and ends with an error where they differ");
  }
};

class PythonWriter : public ScriptWriter {
 public:
  PythonWriter()
      : ScriptWriter("python-control", ".py",
                     "a script that rebuilds sections, a linear model or a board with python-control") {}
  Written write(const Exportable& from, const ExportOptions&) const override {
    return script(from, "run by itself it compares python-control's system with responses computed here");
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, octave_writer, OctaveWriter)

BODESMITH_ENTRY(Writer, python_writer, PythonWriter)

}  // namespace bodesmith::exchange
