// Times and values, one pair a line: LTspice's PWL file="…", KiCad, and ngspice's filesource.
#include "base/text.hpp"
#include "exchange/writer.hpp"
#include "exchange/writers/pwl_points.hpp"

namespace bodesmith::exchange {
namespace {

class PwlWriter : public Writer {
 public:
  std::string_view name() const override { return "pwl"; }
  std::string_view endings() const override { return ".pwl .txt"; }
  std::string_view what() const override { return "times and values for LTspice's PWL file="; }
  Written write(const Exportable& from, const ExportOptions& options) const override {
    PwlPoints points = pwl_points(from, *this, options);
    Written out;
    for (const auto& [time, value] : points.points)
      out.content += number_text(time) + " " + number_text(value) + "\n";
    out.said = std::move(points.said);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, pwl_writer, PwlWriter)

}  // namespace bodesmith::exchange
