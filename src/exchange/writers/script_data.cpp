#include "exchange/writers/script_data.hpp"

#include <algorithm>

#include "base/json.hpp"
#include "base/text.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::exchange {
namespace {

std::string root_list(const std::vector<std::complex<double>>& roots, const ComplexText& text) {
  std::vector<std::string> out;
  for (const std::complex<double>& root : roots) out.push_back(text(root));
  return join(out, ", ");
}

}  // namespace

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
    const std::complex<double> s(0.0, f.rad_s().value);
    data["checks"].push_back(
        {{"frequency_hz", number_text(f.value)}, {"response", text(sections.response(s))}});
  }
  return data;
}

}  // namespace bodesmith::exchange
