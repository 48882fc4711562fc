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

std::string number_list(const std::vector<double>& numbers) {
  std::vector<std::string> out;
  for (const double number : numbers) out.push_back(number_text(number));
  return join(out, ", ");
}

/// Every so many of the source's own points, as computed here.
Json checks_of(const Exportable& from, const ComplexText& text) {
  Json out = Json::array();
  const FrequencyRecord& response = *from.response;
  const std::size_t step = std::max<std::size_t>(1, response.frequency.size() / 12);
  for (std::size_t i = 0; i < response.frequency.size(); i += step) {
    out.push_back({{"frequency_hz", number_text(response.frequency[i].value)},
                   {"response", text(response.response[i])}});
  }
  return out;
}

}  // namespace

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

Json plan_script_data(const Exportable& from, const ComplexText& text) {
  const SampledNetwork& network = *from.network;
  Json data = {{"source", from.source},
               {"name", from.name},
               {"output", network.output},
               {"blocks", Json::array()},
               {"checks", checks_of(from, text)}};
  std::vector<std::string> names = {""};
  for (const SampledBlock& block : network.blocks) {
    Json inputs = Json::array();
    for (const SampledBlock::Input& input : block.inputs) {
      const auto at = std::find(names.begin(), names.end(), input.from) - names.begin();
      inputs.push_back(
          {{"from", input.from}, {"place", std::to_string(at)}, {"numerator", number_list(input.numerator)}});
    }
    data["blocks"].push_back({{"name", block.name},
                              {"clock_hz", number_text(block.clock_hz)},
                              {"denominator", number_list(block.denominator)},
                              {"inputs", std::move(inputs)}});
    names.push_back(block.name);
  }
  data["place"] = std::to_string(std::find(names.begin(), names.end(), network.output) - names.begin());
  return data;
}

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
