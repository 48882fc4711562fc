#include "fpaa/split_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {
namespace {

using Roots = std::vector<std::complex<double>>;

bool has_complex(const Roots& roots) {
  return std::any_of(roots.begin(), roots.end(), [](const auto& root) { return root.imag() != 0.0; });
}

/// Corner frequencies of real roots (negative in the right half plane), ascending.
std::vector<double> ascending_corners(const Roots& roots) {
  std::vector<double> out;
  for (const auto& root : roots) out.push_back(-root.real());
  std::sort(out.begin(), out.end());
  return out;
}

/// How far apart zero and pole of a piece are, in nepers.
double pair_width(double zero, double pole) {
  return zero > 0.0 ? std::abs(std::log(zero / pole)) : 0.0;
}

CamOffer offer_of(const Cam& cam, const FirstOrderPiece& piece) {
  return cam.offer_first_order(piece);
}
CamOffer offer_of(const Cam& cam, const SecondOrderPiece& piece) {
  return cam.offer_second_order(piece);
}

/// The first CAM's offer, or the first refusal.
template <class Piece>
Outcome<CamOffer> first_offer(const Piece& piece) {
  std::optional<Refusal> why_not;
  for (const Cam* cam : cam_registry().all()) {
    CamOffer offer = offer_of(*cam, piece);
    if (offer.task) return offer;
    if (offer.refusal && !why_not) why_not = std::move(offer.refusal);
  }
  if (why_not) return *why_not;
  return Refusal{fmt::format("no CAM makes section {}, expected real poles and zeros", piece.section + 1)};
}

std::string piece_name(std::size_t section) {
  return fmt::format("Section{}", section + 1);
}

/// Appends a section of real roots.
std::optional<Refusal> add_real(const Section& section, std::size_t number, TaskChain& out) {
  std::vector<double> poles = ascending_corners(section.poles);
  const std::vector<double> zeros = ascending_corners(section.zeros);
  out.log_gain += std::log(std::abs(section.gain));
  for (const double pole : poles) out.log_gain -= std::log(pole);
  for (const double zero : zeros) {
    if (zero != 0.0) out.log_gain += std::log(std::abs(zero));
    out.negative = out.negative != (zero < 0.0);
  }
  // Two and two: ascending with ascending is the pairing whose widest pair is narrowest. One and two: the
  // zero takes the nearer pole.
  if (zeros.size() == 1 && poles.size() == 2 &&
      pair_width(zeros[0], poles[1]) < pair_width(zeros[0], poles[0])) {
    std::swap(poles[0], poles[1]);
  }
  for (std::size_t k = 0; k < poles.size(); ++k) {
    FirstOrderPiece piece{number, piece_name(number), std::nullopt, {poles[k]}};
    if (poles.size() > 1) piece.name += k == 0 ? "a" : "b";
    if (k < zeros.size()) piece.zero = RadPerSecond{zeros[k]};
    const Outcome<CamOffer> offer = first_offer(piece);
    if (const Refusal* refusal = refusal_of(offer)) return *refusal;
    out.tasks.push_back(std::get<CamOffer>(offer).task);
  }
  return std::nullopt;
}

/// Appends a section with complex roots.
std::optional<Refusal> add_whole(const Section& section, std::size_t number, TaskChain& out) {
  const Outcome<CamOffer> outcome =
      first_offer(SecondOrderPiece{number, piece_name(number), section.zeros, section.poles});
  if (const Refusal* refusal = refusal_of(outcome)) return *refusal;
  const CamOffer& offer = std::get<CamOffer>(outcome);
  out.log_gain += std::log(std::abs(section.gain));
  out.log_gain += offer.log_gain;
  out.tasks.push_back(offer.task);
  return std::nullopt;
}

}  // namespace

Outcome<TaskChain> split_into_tasks(const Sections& sections) {
  TaskChain out;
  out.negative = sections.gain < 0.0;
  out.log_gain = std::log(std::abs(sections.gain));
  for (std::size_t i = 0; i < sections.sections.size(); ++i) {
    const Section& section = sections.sections[i];
    out.negative = out.negative != (section.gain < 0.0);
    const bool whole = has_complex(section.poles) || has_complex(section.zeros);
    const auto refusal = whole ? add_whole(section, i, out) : add_real(section, i, out);
    if (refusal) return *refusal;
  }
  return out;
}

}  // namespace bodesmith::fpaa
