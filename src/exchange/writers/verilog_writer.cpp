// Digital biquads as fixed-point parameters of a Verilog file, and what they take of an FPGA: the disturbance paper's eq. 25,
//   N f_cf = f_s N_w N_c,
// N multipliers of one product a clock f_cf, N_w products a sample, N_c samples a period of f_s: N_c f_s is the sampling rate.
#include <fmt/format.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "exchange/writer.hpp"

namespace bodesmith::exchange {
namespace {

constexpr int kProducts = 5;  // of a biquad

class VerilogWriter : public Writer {
 public:
  VerilogWriter()
      : Writer("verilog-biquads", ".vh", "digital biquads in fixed point for an FPGA, at a sampling rate") {}
  Written write(const Exportable& from, const ExportOptions& options) const override {
    const Sections& sections = need_sections(from, *this);
    if (!(options.discretise.sample_hz > 0.0))
      throw InputError(from.source, 0, "becomes digital biquads only with a sampling rate");
    DiscretiseOptions rounded = options.discretise;
    rounded.fixed_bits = options.bits;
    const DigitalFilter filter = discretise(sections, rounded);
    const std::string before = error_text(discretise(sections, options.discretise).error),
                      after = error_text(filter.error);
    const auto products = static_cast<double>(kProducts * filter.biquads.size());
    const double fastest = options.multipliers * options.clock_hz / products;
    const std::string budget =
        fmt::format("{} products a sample: {} multiplier{} at {} give{} {} samples a second at most (eq. 25)",
                    rounded_text(products), options.multipliers, options.multipliers == 1 ? "" : "s",
                    engineering_text(options.clock_hz, "Hz", 4), options.multipliers == 1 ? "s" : "",
                    engineering_text(fastest, "", 4));
    Written out;
    Json data = {{"source", from.source},
                 {"name", from.name},
                 {"upper", upper_case(from.name)},
                 {"count", std::to_string(filter.biquads.size())},
                 {"bits", std::to_string(options.bits)},
                 {"top", std::to_string(options.bits - 1)},
                 {"fraction", std::to_string(filter.fraction_bits)},
                 {"sample_hz", number_text(filter.sample_hz)},
                 {"method", std::string(to_string(filter.method))},
                 {"error", after},
                 {"unrounded", before},
                 {"steep", filter.error.steep.empty() ? "" : "; " + filter.error.steep},
                 {"budget", budget},
                 {"biquads", Json::array()}};
    int number = 0;
    for (const Biquad& q : filter.biquads) {
      const auto integer = [&](double value) {
        return fmt::format("{:.0f}", std::ldexp(value, filter.fraction_bits));
      };
      data["biquads"].push_back({{"number", std::to_string(++number)},
                                 {"b0", integer(q.b0)},
                                 {"b1", integer(q.b1)},
                                 {"b2", integer(q.b2)},
                                 {"a1", integer(q.a1)},
                                 {"a2", integer(q.a2)}});
    }
    out.content = render_template("exchange/biquads.vh", data);
    out.said.push_back(
        fmt::format("{} biquads of {} bits, {} behind the point, at {}: off by {} ({} before rounding)",
                    filter.biquads.size(), options.bits, filter.fraction_bits,
                    engineering_text(filter.sample_hz, "Hz", 6), after, before));
    if (!filter.error.steep.empty()) out.said.push_back(filter.error.steep);
    out.said.push_back(budget);
    if (fastest < filter.sample_hz)
      out.said.push_back(
          fmt::format("that is less than the {} asked for", engineering_text(filter.sample_hz, "Hz", 6)));
    return out;
  }

 private:
  static std::string error_text(const DigitalFilter::Error& error) {
    return fmt::format("{} dB, {} degrees", rounded_text(error.max_magnitude_db, 3),
                       rounded_text(error.max_phase_deg, 3));
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, verilog_writer, VerilogWriter)

}  // namespace bodesmith::exchange
