#include "tuning/plant_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "chain/model_file.hpp"
#include "fit/measured/measured_fit.hpp"
#include "lti/sections.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith::tuning {
namespace {

/// What a fit says of its own parameters.
struct StatedDeviations {
  struct Root {
    bool zero = false;
    bool pair = false;
    double frequency_hz = 0.0;  ///< negative: a single root in the right half plane
    double frequency_deviation_hz = 0.0;
    double damping = 1.0;
    double damping_deviation = 0.0;
  };
  double gain_percent = 0.0;
  double delay_s = 0.0;
  std::vector<Root> roots;
};

/// 0 for what the data did not determine: it does not matter to the response either.
double known(double deviation) {
  return std::isfinite(deviation) ? deviation : 0.0;
}

void add_roots(StatedDeviations& out, const std::vector<MeasuredFit::Root>& roots, bool zero) {
  for (const MeasuredFit::Root& root : roots)
    out.roots.push_back({zero, root.pair, root.frequency.value, known(root.frequency_deviation.value),
                         root.damping, known(root.damping_deviation)});
}

StatedDeviations deviations_of(const MeasuredFit& fit) {
  StatedDeviations out;
  out.gain_percent = known(fit.gain_deviation_percent);
  out.delay_s = known(fit.delay_deviation_s);
  add_roots(out, fit.poles, false);
  add_roots(out, fit.zeros, true);
  return out;
}

double number_or_zero(const Node& node, const char* key) {
  return node.has(key) && node.at(key).kind() == Node::Kind::number ? node.at(key).number() : 0.0;
}

void add_roots(StatedDeviations& out, const Node& roots, bool zero) {
  for (const Node& root : roots.items()) {
    out.roots.push_back({zero, root.has("damping_ratio"), root.at("frequency_hz").number(),
                         number_or_zero(root, "frequency_deviation_hz"), root.number_or("damping_ratio", 1.0),
                         number_or_zero(root, "damping_ratio_deviation")});
  }
}

/// `fit` of a sections.json that fit --measured wrote; empty for any other.
StatedDeviations deviations_of(const Node& node) {
  StatedDeviations out;
  if (!node.has("fit") || !node.at("fit").has("gain_deviation_percent")) return out;
  const Node fit = node.at("fit");
  out.gain_percent = number_or_zero(fit, "gain_deviation_percent");
  out.delay_s = number_or_zero(fit, "delay_deviation_s");
  add_roots(out, fit.at("poles"), false);
  add_roots(out, fit.at("zeros"), true);
  return out;
}

/// (1 - s/r) over both roots of a pair, or over one.
Complex root_factor(Complex s, double frequency_hz, double damping, bool pair) {
  const Complex x = s / Hertz{frequency_hz}.rad_s().value;
  return pair ? 1.0 + 2.0 * damping * x + x * x : 1.0 + x;
}

/// H with one root moved, the gain at rest kept.
Response with_moved_root(const Sections& sections, const StatedDeviations::Root& root, double frequency_hz,
                         double damping) {
  return [sections, root, frequency_hz, damping](RadPerSecond w) {
    const Complex s(0.0, w.value);
    const Complex ratio = root_factor(s, frequency_hz, damping, root.pair) /
                          root_factor(s, root.frequency_hz, root.damping, root.pair);
    return sections.response(s) * (root.zero ? ratio : 1.0 / ratio);
  };
}

/// Lognormal: what is hardly known does not change its sign; what is not known at all moves by e.
double moved_by(double relative) {
  return std::exp(std::clamp(relative, -1.0, 1.0));
}

std::string moved_name(const char* what, double hz, double sigmas) {
  return fmt::format("{} of {:.4g} Hz {:+g} sigma", what, std::abs(hz), sigmas);
}

void add_deviations(PlantFamily& out, const Sections& sections, const StatedDeviations& stated,
                    double sigmas) {
  for (const double side : {sigmas, -sigmas}) {
    if (stated.gain_percent > 0.0) {
      const double factor = std::exp(side * stated.gain_percent / 100.0);
      out.members.push_back({fmt::format("gain {:+g} sigma", side),
                             [sections, factor](RadPerSecond w) { return factor * sections.response(w); }});
    }
    if (stated.delay_s > 0.0) {
      Sections moved = sections;
      moved.delay_s = std::max(0.0, sections.delay_s + side * stated.delay_s);
      out.members.push_back(
          {fmt::format("delay {:+g} sigma", side), [moved](RadPerSecond w) { return moved.response(w); }});
    }
    for (const StatedDeviations::Root& root : stated.roots) {
      const double hz =
          root.frequency_hz * moved_by(side * root.frequency_deviation_hz / std::abs(root.frequency_hz));
      if (root.frequency_deviation_hz > 0.0)
        out.members.push_back({moved_name(root.zero ? "zero" : "pole", root.frequency_hz, side),
                               with_moved_root(sections, root, hz, root.damping)});
      if (root.pair && root.damping_deviation > 0.0 && root.damping != 0.0) {
        const double damping =
            root.damping * moved_by(side * root.damping_deviation / std::abs(root.damping));
        out.members.push_back(
            {moved_name(root.zero ? "damping of the zero" : "damping of the pole", root.frequency_hz, side),
             with_moved_root(sections, root, root.frequency_hz, damping)});
      }
    }
  }
}

/// exp(j w delay) apart, a plant whose corners are all `scale` times higher is P(w/scale); its delay then is as much shorter.
void add_corners(PlantFamily& out, std::size_t plain, const PlantSpread& spread) {
  const double gain = 1.0 + spread.gain_percent / 100.0;
  const double scale = 1.0 + spread.frequency_percent / 100.0;
  std::vector<double> gains{1.0};
  std::vector<double> scales{1.0};
  if (spread.gain_percent > 0.0) gains = {gain, 1.0 / gain};
  if (spread.frequency_percent > 0.0) scales = {scale, 1.0 / scale};
  if (gains.size() == 1 && scales.size() == 1) return;
  for (std::size_t i = 0; i < plain; ++i) {
    for (const double g : gains) {
      for (const double f : scales) {
        const PlantMember& base = out.members[i];
        out.members.push_back({fmt::format("{}, gain x {:.4g}, frequencies x {:.4g}", base.name, g, f),
                               [response = base.response, g, f](RadPerSecond w) {
                                 return g * response(RadPerSecond{w.value / f});
                               }});
      }
    }
  }
}

chain::Chain checked_model(const std::string& file, Provenance& from) {
  chain::Chain model = chain::read_model(file, from);
  for (const chain::Block& block : model.blocks) {
    if (!block.response(RadPerSecond{1.0}))
      throw InputError(file, block.line,
                       fmt::format("block '{}' has no frequency response (it is not linear), expected linear "
                                   "blocks to tune a loop round",
                                   block.type_name()));
  }
  return model;
}

/// From the slowest to the fastest pole of its blocks; an integrator's stands for none.
std::optional<Band> corners_of(const chain::Chain& model) {
  std::optional<Band> out;
  for (const chain::Block& block : model.blocks) {
    const chain::Kernel kernel = block.kernel();
    const auto* linear = std::get_if<chain::LinearKernel>(&kernel);
    if (linear == nullptr) continue;
    const auto order = static_cast<Eigen::Index>(linear->order());
    for (const Complex pole :
         eigenvalues(Eigen::Map<const Eigen::MatrixXd>(linear->a.data(), order, order))) {
      if (std::abs(pole) < 1e-9) continue;  // the engines' integrators have theirs a little beside 0
      const Hertz at = RadPerSecond{std::abs(pole)}.hz();
      out = out ? Band{std::min(out->from, at), std::max(out->to, at)} : Band{at, at};
    }
  }
  return out;
}

std::optional<Band> corners_of(const Sections& sections) {
  const Band band = sections.corner_band();
  return band.from.value > 0.0 ? std::optional(band) : std::nullopt;
}

bool is_document(const std::filesystem::path& file) {
  return file.extension() == ".json" || file.extension() == ".toml";
}

/// The least order that meets the held-out points within a tenth of the chosen one's error: a pole and zero that nearly
/// cancel for the sake of a little less are no part of a plant that a loop should be shaped by.
MeasuredFit plain_fit(const FrequencyRecord& record) {
  constexpr double kAsGood = 1.1;
  MeasuredFit fit = fit_measured(record, {});
  const auto chosen = std::ranges::find(fit.orders, fit.order, &MeasuredFit::Order::order);
  if (chosen == fit.orders.end()) return fit;
  const double enough = kAsGood * kAsGood * chosen->held_out;  // mean squares
  for (auto order = fit.orders.begin(); order != chosen; ++order) {
    if (order->held_out <= enough) return fit_measured(record, {.order = order->order});
  }
  return fit;
}

/// A file's plant as the first member, and what it says of its uncertainty behind it.
PlantFamily read_plant(const std::string& file, double sigmas, Provenance& from) {
  PlantFamily out;
  const auto add_sections = [&](const Sections& sections, const StatedDeviations& stated) {
    out.members.push_back({file, [sections](RadPerSecond w) { return sections.response(w); }});
    add_deviations(out, sections, stated, sigmas);
  };
  if (!is_document(file)) {
    const FrequencyRecord record = FrequencyRecord::read_csv(file, from);
    const MeasuredFit fit = plain_fit(record);
    out.band = Band{record.frequency.front(), record.frequency.back()};
    out.rms_fit_db = fit.rms_db;
    add_sections(fit.sections, deviations_of(fit));
    return out;
  }
  const Node node = read_document(file, from);
  if (node.kind() == Node::Kind::object && node.string_or("schema", "") == "bodesmith.sections/1") {
    const Sections sections = Sections::from_node(node);
    out.band = corners_of(sections);
    // Margins multiply and divide frequencies: beyond these the squares leave the range of doubles.
    if (out.band && (out.band->from.value < 1e-50 || out.band->to.value > 1e50))
      throw InputError(
          file, 1,
          fmt::format("corners at {:.3g} to {:.3g} Hz, expected a plant's corners within 1e-50 to "
                      "1e50 Hz",
                      out.band->from.value, out.band->to.value));
    add_sections(sections, deviations_of(node));
  } else {
    const chain::Chain model = checked_model(file, from);
    out.band = corners_of(model);
    out.members.push_back({file, [model](RadPerSecond w) { return *model.response(w); }});
  }
  return out;
}

}  // namespace

PlantFamily read_plants(const std::vector<std::string>& files, const PlantSpread& spread, Provenance& from) {
  PlantFamily out = read_plant(files.front(), spread.sigmas, from);
  out.members.front().name = "nominal";
  for (std::size_t i = 1; i < files.size(); ++i) {
    // Each further file is a plant as it stands: its neighbours would count its noise twice.
    const PlantFamily other = read_plant(files[i], spread.sigmas, from);
    out.members.push_back(other.nominal());
    if (out.band && other.band) out.band->to = std::max(out.band->to, other.band->to);
  }
  add_corners(out, out.members.size(), spread);
  return out;
}

}  // namespace bodesmith::tuning
