#include "project/track_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace bodesmith::project {
namespace {

using Branch = Disturbance::Branch;
using Shape = tracking::Reference::Shape;

Shape shape_of(const Node& node) {
  const std::string word = node.one_of({to_string(Shape::triangle), to_string(Shape::sine),
                                        to_string(Shape::two_tone), to_string(Shape::decaying_triangle)});
  for (const Shape shape : {Shape::sine, Shape::two_tone, Shape::decaying_triangle})
    if (word == to_string(shape)) return shape;
  return Shape::triangle;
}

/// The items of a list, or the one value that stands for a list of one.
std::vector<Node> one_or_more(const Node& node) {
  if (node.kind() != Node::Kind::array) return {node};
  if (node.size() == 0) node.fail("is empty, expected at least one");
  return node.items();
}

/// The frequencies at which the rate gains are known, and those that are tracked.
std::vector<Hertz> all_frequencies(const Project& project) {
  std::vector<Hertz> out = project.track.frequency;
  const auto& table = project.target.disturbance.rate.frequency;
  out.insert(out.end(), table.begin(), table.end());
  return out;
}

/// Lowest and highest v with v + K d(v) = r for r in [0, amplitude], over both branches and all gains.
std::array<double, 2> drive_extremes(const Project& project, double amplitude) {
  std::array<double, 2> out = {0.0, 0.0};
  for (const Hertz f : all_frequencies(project)) {
    const Disturbance curve = project.target.disturbance.at(amplitude, f);
    for (const Branch branch : kBranches) {
      for (int i = 0; i <= 64; ++i) {
        const double r = amplitude * i / 64.0;
        double v = r;
        for (int round = 0; round < 60; ++round) v = r - curve.value(branch, v);
        if (!std::isfinite(v)) continue;  // a loop that does not settle is told elsewhere
        out = {std::min(out[0], v), std::max(out[1], v)};
      }
    }
  }
  return out;
}

}  // namespace

Project::Track read_track(const Node& node) {
  node.allow_only({"waveform", "amplitude", "frequency_hz", "measured_percent"});
  Project::Track track;
  if (node.has("waveform")) {
    track.waveforms.clear();
    for (const Node& item : one_or_more(node.at("waveform"))) track.waveforms.push_back(shape_of(item));
  }
  if (node.has("amplitude")) {
    track.amplitudes.clear();
    for (const Node& item : one_or_more(node.at("amplitude"))) {
      const double amplitude = item.positive();
      if (amplitude > 1.0)
        item.fail(fmt::format("is {}, beyond the full stroke, expected at most 1", rounded_text(amplitude)));
      track.amplitudes.push_back(amplitude);
    }
  }
  for (const Node& item : node.at("frequency_hz").items()) {
    track.frequency.push_back(Hertz{item.positive()});
    if (track.frequency.back().value < 1e-6 || track.frequency.back().value > 1e9)
      item.fail("is not within 1e-6 to 1e9");
  }
  if (track.frequency.empty()) node.at("frequency_hz").fail("is empty, expected at least one frequency");
  if (node.has("measured_percent")) {
    track.measured_percent = node.at("measured_percent").numbers();
    if (track.measured_percent.size() != track.frequency.size()) {
      node.at("measured_percent")
          .fail(fmt::format("has {} numbers, expected one for each of the {} tracked frequencies",
                            track.measured_percent.size(), track.frequency.size()));
    }
  }
  return track;
}

void check_drive(const Project& project, const Node& node) {
  if (!project.plant->drive_range) return;
  const auto [lowest, highest] = *project.plant->drive_range;
  constexpr double kRounding = 1e-9;
  for (const double amplitude : project.track.amplitudes) {
    const auto [low, high] = drive_extremes(project, amplitude);
    if (low >= lowest - kRounding && high <= highest + kRounding) continue;
    const Node track = node.at("track");
    (track.has("amplitude") ? track.at("amplitude") : track)
        .fail(fmt::format("an amplitude of {} takes a drive of {} to {} full strokes, the amplifier (plant."
                          "drive_range) makes {} to {}",
                          rounded_text(amplitude), rounded_text(low, 3), rounded_text(high, 3),
                          rounded_text(lowest), rounded_text(highest)));
  }
}

void check_loop(const Project& project, const Node& node, const std::filesystem::path& folder) {
  for (const Branch branch : kBranches) {
    for (const Hertz f : all_frequencies(project)) {
      for (const double amplitude : project.track.amplitudes) {
        const double gain = project.target.disturbance.at(amplitude, f).steepest(branch, amplitude);
        if (gain < 1.0) continue;
        Provenance ignored;
        const Node file = read_document(folder / node.at("target").at("disturbance").string(), ignored);
        file.at(to_string(branch))
            .fail(fmt::format(
                "has a slope of {} with its gains at {} Hz: a generator fed by its own drive does not "
                "settle, expected less than 1 ([choose] by = \"as_asked\" builds one pass)",
                rounded_text(gain, 3), rounded_text(f.value)));
      }
    }
  }
}

}  // namespace bodesmith::project
