#include "fpaa/plan/board_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "fpaa/plan/plan_graph.hpp"

namespace bodesmith::fpaa {
namespace {

/// Of voltages that depend on one another within an instant; more is a loop.
constexpr int kDeepest = 200;

/// A placed CAM's network, where its switches are known and its capacitors given.
std::optional<ClockedNetwork> network_of_cam(const PlacedCam& cam, std::int64_t period) {
  const auto stage = cam.cam->switches(cam);
  if (!stage || stage->capacitors.empty()) return std::nullopt;
  return ClockedNetwork(circuit_of(*stage), {period});
}

}  // namespace

BoardRun::BoardRun(const std::vector<WiredCam>& cams, std::vector<Part> parts, const Board& board)
    : parts_(std::move(parts)), known_parts_(parts_.size()), ticks_per_second_(ticks_per_second(board)) {
  for (const WiredCam& cam : cams) {
    Node node;
    node.name = cam.name;
    std::int64_t period =
        std::max<std::int64_t>(2, nearest_whole<long long>(ticks_per_second_ / cam.clock_a.value));
    period += period % 2;
    node.network = network_of_cam(cam, period);
    if (node.network) {
      // At rest; the first instant, at 0, begins phase 1.
      node.interval = node.network->intervals().size() - 1;
      node.charges = Eigen::VectorXd::Zero(node.network->intervals().back().m.cols());
      node.edge = {0, period / 2};
    } else {
      node.step = cam.cam->step(cam);
      if (!node.step) {
        throw DesignError(fmt::format("{} is a {} without capacitors, expected a CAM that is made of some",
                                      node.name, cam.cam_name()));
      }
      const std::int64_t offset = cam.phase == 2 ? 0 : period / 2;
      const std::int64_t delay = nearest_whole<long long>(cam.delay_cycles * static_cast<double>(period));
      if (delay < 0) {
        throw DesignError(
            fmt::format("{} is late by {} cycles, expected 0 or more", node.name, cam.delay_cycles));
      }
      node.edge = {offset, period};
      if (delay > 0) node.shown = {offset + delay, period};
    }
    node.read.assign(cam.inputs.size(), 0.0);
    nodes_.push_back(std::move(node));
  }
  for (std::size_t i = 0; i < cams.size(); ++i) {
    for (const std::string& name : cams[i].inputs) nodes_[i].sources.push_back(source_of(name, cams[i].name));
  }
  for (const Part& part : parts_) {
    part_sources_.emplace_back();
    for (const std::string& name : part.inputs) part_sources_.back().push_back(source_of(name, part.name));
  }
  // The first periods show any loop without delay.
  run_instant(0);
  for (std::size_t i = 0; i < nodes_.size(); ++i) (void)voltage(i);
}

std::size_t BoardRun::source_of(const std::string& name, const std::string& reader) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].name == name) return i;
  }
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].name == name) return nodes_.size() + i;
  }
  throw DesignError(
      fmt::format("{} reads '{}', which is no CAM and comes from nowhere outside", reader, name));
}

double BoardRun::limited(Node& node, double volts) const {
  const double out = std::clamp(volts, -kFullScaleV, kFullScaleV);
  if (out != volts) node.clipped = true;
  return out;
}

double BoardRun::network_voltage(Node& node, int depth) {
  if (node.known_at == readings_) return node.known;
  const ClockedNetwork::Interval& at = node.network->intervals()[node.interval];
  const auto row = static_cast<Eigen::Index>(node.network->output());
  double volts = 0.0;
  for (Eigen::Index k = 0; k < node.charges.size(); ++k) volts += at.c(row, k) * node.charges(k);
  for (std::size_t k = 0; k < node.sources.size(); ++k) {
    const auto input = static_cast<Eigen::Index>(k);
    if (input < at.d.cols() && at.d(row, input) != 0.0)
      volts += at.d(row, input) * voltage(node.sources[k], depth + 1);
  }
  node.known = limited(node, volts);
  node.known_at = readings_;
  return node.known;
}

double BoardRun::voltage(std::size_t source, int depth) {
  if (source < nodes_.size()) {
    Node& node = nodes_[source];
    if (depth > kDeepest) {
      throw DesignError(
          fmt::format("{} stands in a loop without any delay, expected a Hold in it", node.name));
    }
    return node.network ? network_voltage(node, depth) : node.visible;
  }
  constexpr std::size_t kMostInputs = 8;
  double inputs[kMostInputs];
  const std::size_t part = source - nodes_.size();
  KnownPart& known = known_parts_[part];
  if (known.at == readings_) return known.volts;
  const auto& from = part_sources_[part];
  const std::size_t count = std::min(from.size(), kMostInputs);
  for (std::size_t i = 0; i < count; ++i) inputs[i] = voltage(from[i], depth + 1);
  known = {readings_, parts_[part].value(static_cast<double>(now_) / ticks_per_second_, {inputs, count})};
  return known.volts;
}

void BoardRun::switch_over(Node& node) {
  const ClockedNetwork::Interval& at = node.network->intervals()[node.interval];
  node.next_charges.resize(at.m.rows());
  for (Eigen::Index r = 0; r < at.m.rows(); ++r) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < at.m.cols(); ++k) sum += at.m(r, k) * node.charges(k);
    for (std::size_t k = 0; k < node.sources.size(); ++k) {
      const auto input = static_cast<Eigen::Index>(k);
      if (input < at.n.cols()) sum += at.n(r, input) * node.read[k];
    }
    node.next_charges(r) = sum;
  }
  node.charges.swap(node.next_charges);
  node.interval = (node.interval + 1) % node.network->intervals().size();
}

void BoardRun::take_step(Node& node) {
  // What other steps have just shown is read as it is now.
  for (std::size_t k = 0; k < node.sources.size(); ++k) {
    const std::size_t source = node.sources[k];
    if (source < nodes_.size() && nodes_[source].step) node.read[k] = nodes_[source].visible;
  }
  const double out = limited(node, node.step(node.read));
  if (node.shown.next == Edge::kNever) {
    node.visible = out;
  } else {
    node.pending.push_back(out);
  }
}

void BoardRun::run_instant(std::int64_t tick) {
  now_ = tick;
  ++readings_;
  const auto due = [&](const Edge& edge) { return edge.next == now_; };
  for (Node& node : nodes_) {
    for (std::size_t k = 0; due(node.edge) && k < node.sources.size(); ++k)
      node.read[k] = voltage(node.sources[k]);
  }
  for (Node& node : nodes_) {
    if (due(node.shown) && !node.pending.empty()) {
      node.visible = node.pending.front();
      node.pending.pop_front();
    }
  }
  for (Node& node : nodes_) {
    if (node.step && due(node.edge)) take_step(node);
  }
  for (Node& node : nodes_) {
    if (node.network && due(node.edge)) switch_over(node);
  }
  next_ = Edge::kNever;
  for (Node& node : nodes_) {
    for (Edge* edge : {&node.edge, &node.shown}) {
      if (due(*edge)) edge->next += edge->every;
      next_ = std::min(next_, edge->next);
    }
  }
  ++readings_;
}

void BoardRun::advance_to(double time_s) {
  const auto last = whole_number<std::int64_t>(std::floor(time_s * ticks_per_second_ * (1.0 + 1e-15)));
  while (next_ <= last) run_instant(next_);
  if (last > now_) {
    now_ = last;
    ++readings_;
  }
}

void BoardRun::skip_towards(double time_s) {
  const std::int64_t ahead = whole_number<std::int64_t>(std::floor(time_s * ticks_per_second_)) - now_;
  std::int64_t common = 1;
  for (const Node& node : nodes_) {
    common = std::lcm(common, node.network ? 2 * node.edge.every : node.edge.every);
    if (common > ahead) return;
  }
  const std::int64_t by = ahead / common * common;
  for (Node& node : nodes_) {
    node.edge.next += by;
    if (node.shown.next != Edge::kNever) node.shown.next += by;
  }
  next_ += by;
  now_ += by;
}

double BoardRun::value(const std::string& name) {
  return voltage(source_of(name, "the caller"));
}

std::vector<std::string> BoardRun::clipped() const {
  std::vector<std::string> out;
  for (const Node& node : nodes_) {
    if (node.clipped) out.push_back(node.name);
  }
  return out;
}

void BoardRun::forget_clipping() {
  for (Node& node : nodes_) node.clipped = false;
}

}  // namespace bodesmith::fpaa
