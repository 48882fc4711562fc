// Digital biquads as one C file without dependencies (C99), with the error that sampling brings written above them.
#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "exchange/writer.hpp"

namespace bodesmith::exchange {
namespace {

std::string error_text(const DigitalFilter::Error& error) {
  return fmt::format("{} dB, {} degrees, {} % (worst at {}) from {} to {}, above -60 dB",
                     rounded_text(error.max_magnitude_db, 3), rounded_text(error.max_phase_deg, 3),
                     rounded_text(error.max_complex_percent, 3), engineering_text(error.worst.value, "Hz", 4),
                     engineering_text(error.band.from.value, "Hz", 4),
                     engineering_text(error.band.to.value, "Hz", 4));
}

class CWriter : public Writer {
 public:
  CWriter() : Writer("c-biquads", ".c .h", "digital biquads in C, at a sampling rate") {}
  Written write(const Exportable& from, const ExportOptions& options) const override {
    const Sections& sections = need_sections(from, *this);
    if (!(options.discretise.sample_hz > 0.0))
      throw InputError(from.source, 0, "becomes digital biquads only with a sampling rate");
    const DigitalFilter filter = discretise(sections, options.discretise);
    Written out;
    out.content = render_template("exchange/biquads.c", data_of(from, sections, filter, options));
    out.said.push_back(fmt::format("{} biquads by {} at {}: off by {}", filter.biquads.size(),
                                   to_string(filter.method), engineering_text(filter.sample_hz, "Hz", 6),
                                   error_text(filter.error)));
    if (!filter.error.steep.empty()) out.said.push_back(filter.error.steep);
    DiscretiseOptions other = options.discretise;
    other.method = filter.method == Discretisation::tustin ? Discretisation::matched : Discretisation::tustin;
    try {
      out.said.push_back(fmt::format("{} would be off by {}", to_string(other.method),
                                     error_text(discretise(sections, other).error)));
    } catch (const InputError& why) {
      out.said.push_back(fmt::format("{} would not do: {}", to_string(other.method), why.what()));
    }
    if (sections.delay_s > 0.0)
      out.said.push_back(fmt::format("the delay of {} ({} samples) is not in it",
                                     engineering_text(sections.delay_s, "s", 4),
                                     rounded_text(sections.delay_s * filter.sample_hz)));
    return out;
  }

 private:
  static Json data_of(const Exportable& from, const Sections& sections, const DigitalFilter& filter,
                      const ExportOptions& options) {
    const bool single = options.discretise.single_precision;
    const auto number = [single](double value) {
      return single ? fmt::format("{}f", fmt::format("{:.9g}", value).find_first_of(".e") == std::string::npos
                                             ? fmt::format("{:.9g}.0", value)
                                             : fmt::format("{:.9g}", value))
                    : number_text(value);
    };
    Json data = {
        {"source", from.source},
        {"name", from.name},
        {"upper", upper_case(from.name)},
        {"type", single ? "float" : "double"},
        {"count", std::to_string(filter.biquads.size())},
        {"gain", number(filter.gain)},
        {"sample_hz", number_text(filter.sample_hz)},
        {"method", std::string(to_string(filter.method))},
        {"at", options.discretise.prewarp
                   ? fmt::format("exact at {}", engineering_text(options.discretise.prewarp->value, "Hz", 6))
               : filter.method == Discretisation::tustin
                   ? std::string("every section exact at the corner of its poles")
                   : std::string("gains met at DC")},
        {"error", error_text(filter.error)},
        {"steep", filter.error.steep.empty() ? "" : "; " + filter.error.steep},
        {"delay", sections.delay_s > 0.0 ? fmt::format("The delay of {} s ({} samples) is not in it.",
                                                       number_text(sections.delay_s),
                                                       rounded_text(sections.delay_s * filter.sample_hz))
                                         : std::string("It has no further delay.")},
        {"biquads", Json::array()}};
    for (const Biquad& q : filter.biquads) {
      data["biquads"].push_back({{"b0", number(q.b0)},
                                 {"b1", number(q.b1)},
                                 {"b2", number(q.b2)},
                                 {"a1", number(q.a1)},
                                 {"a2", number(q.a2)}});
    }
    return data;
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, c_writer, CWriter)

}  // namespace bodesmith::exchange
