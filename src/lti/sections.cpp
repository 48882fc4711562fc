#include "lti/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/documents/json.hpp"
#include "lti/steep_flanks.hpp"

namespace bodesmith {
namespace {

std::vector<Complex> read_one_or_two(const Node& node) {
  std::vector<Complex> roots = roots_from(node);
  const bool paired = (roots.size() == 2 && roots[0] == std::conj(roots[1])) ||
                      std::ranges::all_of(roots, [](Complex r) { return r.imag() == 0.0; });
  if (!paired) node.fail("has a complex root without its conjugate, expected real roots or a conjugate pair");
  return roots;
}

}  // namespace

std::vector<Complex> roots_from(const Node& node) {
  std::vector<Complex> out;
  for (const Node& item : node.items()) {
    const std::vector<double> parts = item.numbers();
    if (parts.size() != 2) item.fail(fmt::format("has {} numbers, expected [re, im] in rad/s", parts.size()));
    out.emplace_back(parts[0], parts[1]);
  }
  return out;
}

Json roots_json(const std::vector<Complex>& roots) {
  Json out = Json::array();
  for (const Complex& root : roots) out.push_back({root.real(), root.imag()});
  return out;
}

Complex Section::response(Complex s) const {
  // Factor by factor, a zero against a pole: no overflow for corners far apart.
  Complex h = gain;
  for (std::size_t i = 0; i < std::max(zeros.size(), poles.size()); ++i) {
    if (i < zeros.size()) h *= s - zeros[i];
    if (i < poles.size()) h /= s - poles[i];
  }
  return h;
}

double Section::dc_gain() const {
  if (integrates(*this)) return std::copysign(INFINITY, gain);
  return response(Complex(0.0, 0.0)).real();
}

bool Section::is_stable() const {
  return std::ranges::all_of(poles, [](Complex p) { return p.real() < 0.0; });
}

bool integrates(const Section& section) {
  bool out = false;
  for (const Complex& pole : section.poles) {
    if (pole == Complex(0.0, 0.0)) {
      out = true;
    } else if (!(pole.real() < 0.0)) {
      return false;
    }
  }
  return out;
}

Section Section::pole_zero(double dc_gain, RadPerSecond zero, RadPerSecond pole) {
  return {.gain = dc_gain * pole.value / zero.value,
          .zeros = {Complex(-zero.value, 0.0)},
          .poles = {Complex(-pole.value, 0.0)}};
}

Complex Sections::response(Complex s) const {
  Complex h = gain;
  for (const Section& section : sections) h *= section.response(s);
  if (delay_s != 0.0) h *= std::exp(-s * delay_s);
  return h;
}

double Sections::dc_gain() const {
  double g = gain;
  for (const Section& section : sections) g *= section.dc_gain();
  return g;
}

bool integrates(const Sections& sections) {
  return std::ranges::any_of(sections.sections, [](const Section& s) { return integrates(s); });
}

int Sections::pole_count() const {
  std::size_t n = 0;
  for (const Section& section : sections) n += section.poles.size();
  return static_cast<int>(n);
}

Band Sections::corner_band() const {
  double low = INFINITY;
  double high = 0.0;
  for (const Section& section : sections) {
    for (const auto* roots : {&section.zeros, &section.poles}) {
      for (const Complex& root : *roots) {
        if (std::abs(root) == 0.0) continue;
        low = std::min(low, std::abs(root));
        high = std::max(high, std::abs(root));
      }
    }
  }
  if (high == 0.0) low = 0.0;
  return {RadPerSecond{low}.hz(), RadPerSecond{high}.hz()};
}

Sections Sections::from_node(const Node& node) {
  node.expect_schema("sections");
  Sections out;
  out.gain = node.number_or("gain", 1.0);
  if (out.gain == 0.0) node.at("gain").fail("is 0, expected a gain other than 0");
  for (const Node& item : node.at("sections").items()) {
    Section section;
    section.gain = item.number_or("gain", 1.0);
    if (section.gain == 0.0) item.at("gain").fail("is 0, expected a gain other than 0");
    section.zeros = read_one_or_two(item.at("zeros_rad_s"));
    section.poles = read_one_or_two(item.at("poles_rad_s"));
    if (section.poles.empty() || section.poles.size() > 2) {
      item.at("poles_rad_s")
          .fail(fmt::format("has {} poles, expected one or two a section", section.poles.size()));
    }
    if (section.zeros.size() > section.poles.size()) {
      item.at("zeros_rad_s")
          .fail(fmt::format("has {} zeros with {} poles, expected no more zeros than poles",
                            section.zeros.size(), section.poles.size()));
    }
    if (!section.is_stable() && !integrates(section))
      item.at("poles_rad_s")
          .fail("has a pole that is not in the left half plane, expected Re < 0, or [0, 0]");
    out.sections.push_back(std::move(section));
  }
  out.delay_s = node.number_or("delay_s", 0.0);
  if (out.delay_s < 0.0) node.at("delay_s").fail("is below 0, expected a delay of 0 or more");
  if (node.has("error")) {
    const Node error = node.at("error");
    const std::vector<double> band = error.at("band_hz").numbers();
    if (band.size() != 2) error.at("band_hz").fail("expected [from, to]");
    out.error =
        Error{{Hertz{band[0]}, Hertz{band[1]}},
              error.at("max_magnitude_db").number(),
              error.has("max_phase_deg") ? std::optional(error.at("max_phase_deg").number()) : std::nullopt,
              error.at("everywhere_max_magnitude_db").number()};
  }
  return out;
}

Sections Sections::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

Json Sections::to_json() const {
  Json out = {{"gain", gain}, {"sections", Json::array()}};
  for (const Section& section : sections) {
    out["sections"].push_back({{"gain", section.gain},
                               {"zeros_rad_s", roots_json(section.zeros)},
                               {"poles_rad_s", roots_json(section.poles)}});
  }
  if (delay_s != 0.0) out["delay_s"] = delay_s;
  if (error) {
    out["error"] = {{"band_hz", {error->band.from.value, error->band.to.value}},
                    {"max_magnitude_db", error->max_magnitude_db},
                    {"everywhere_max_magnitude_db", error->everywhere_max_magnitude_db}};
    if (error->max_phase_deg) out["error"]["max_phase_deg"] = *error->max_phase_deg;
  }
  return out;
}

ResponseDifference compare_responses(const std::vector<Hertz>& grid, const std::vector<Complex>& got,
                                     const std::vector<Complex>& wanted) {
  if (grid.size() != got.size() || grid.size() != wanted.size()) {
    throw std::logic_error("responses of different length were compared");
  }
  ResponseDifference out;
  const FlankedCurve curve(grid, wanted);
  bool first = true;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!curve.is_judged(i)) continue;
    const FlankedCurve::Error error = curve.error(i, got[i]);
    out.max_magnitude_db = std::max(out.max_magnitude_db, kDecibelPerNeper * error.neper);
    out.max_phase_deg = std::max(out.max_phase_deg, to_degrees(error.rad));
    const double percent = 100.0 * error.relative;
    if (percent > out.max_complex_percent || first) {
      first = false;
      out.max_complex_percent = percent;
      out.worst = grid[i];
    }
  }
  return out;
}

}  // namespace bodesmith
