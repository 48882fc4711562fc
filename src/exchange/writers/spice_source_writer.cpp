// A voltage source with its points inside, to be included by any SPICE: `.include drive.inc` gives V<name> at node <name>.
#include <fmt/format.h>

#include "base/text.hpp"
#include "exchange/writer.hpp"
#include "exchange/writers/pwl_points.hpp"

namespace bodesmith::exchange {
namespace {

class SpiceSourceWriter : public Writer {
 public:
  std::string_view name() const override { return "spice-source"; }
  std::string_view endings() const override { return ".inc .lib"; }
  std::string_view what() const override { return "a voltage source PWL(…) for any SPICE"; }
  Written write(const Exportable& from, const ExportOptions& options) const override {
    PwlPoints points = pwl_points(from, *this, options);
    Written out;
    out.content = fmt::format("* {}\nV{} {} 0 PWL(", from.source, from.name, from.name);
    for (const auto& [time, value] : points.points)
      out.content += fmt::format("\n+ {} {}", number_text(time), number_text(value));
    out.content += ")\n";
    out.said = std::move(points.said);
    out.said.push_back(fmt::format("source V{} between node {} and ground", from.name, from.name));
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, spice_source_writer, SpiceSourceWriter)

}  // namespace bodesmith::exchange
