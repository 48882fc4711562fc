#include "fpaa/cam_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan_graph.hpp"

namespace bodesmith::fpaa {

CamSimulation::CamSimulation(const std::vector<Cell>& cells, std::vector<Part> parts, const Board& board)
    : parts_(std::move(parts)),
      ticks_per_second_(ticks_per_second(board)),
      full_scale_v_(board.full_scale_v) {
  for (const Cell& cell : cells) {
    Node node;
    node.name = cell.cam.name;
    node.step = cell.cam.cam->step(cell.cam);
    node.period =
        std::max<std::int64_t>(2, nearest_whole<long long>(ticks_per_second_ / cell.cam.clock_a.value));
    node.offset = cell.cam.phase == 2 ? node.period / 2 : 0;
    node.delay = nearest_whole<long long>(cell.cam.delay_cycles * static_cast<double>(node.period));
    if (node.delay < 0) {
      throw DesignError(
          fmt::format("{} is late by {} cycles, expected 0 or more", node.name, cell.cam.delay_cycles));
    }
    for (std::size_t i = 0; i < cell.late.size(); ++i) {
      if (cell.late[i]) node.late.push_back(i);
    }
    node.read.assign(cell.inputs.size(), 0.0);
    nodes_.push_back(std::move(node));
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const std::string& name : cells[i].inputs)
      nodes_[i].sources.push_back(source_of(name, cells[i].cam.name));
  }
  for (const Part& part : parts_) {
    part_sources_.emplace_back();
    for (const std::string& name : part.inputs) part_sources_.back().push_back(source_of(name, part.name));
  }
  find_order();
  for (std::size_t i = 0; i < nodes_.size(); ++i) add_beats(i);
  for (Beat& b : beats_) {
    std::sort(b.edges.begin(), b.edges.end(),
              [&](std::size_t i, std::size_t j) { return rank_[i] < rank_[j]; });
  }
}

std::size_t CamSimulation::source_of(const std::string& name, const std::string& reader) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].name == name) return i;
  }
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].name == name) return nodes_.size() + i;
  }
  throw DesignError(
      fmt::format("{} reads '{}', which is no CAM and comes from nowhere outside", reader, name));
}

CamSimulation::Beat& CamSimulation::beat(std::int64_t period, std::int64_t offset) {
  for (Beat& b : beats_) {
    if (b.period == period && b.next == offset % period) return b;
  }
  beats_.push_back({period, offset % period, {}, {}, {}});
  return beats_.back();
}

void CamSimulation::add_beats(std::size_t i) {
  const Node& node = nodes_[i];
  beat(node.period, node.offset).edges.push_back(i);
  if (node.delay > 0) beat(node.period, node.offset + node.delay).appear.push_back(i);
  if (!node.late.empty()) beat(node.period, node.offset + node.period / 2).latch.push_back(i);
}

/// The CAMs whose outputs a source shows at once.
void CamSimulation::add_reads(std::size_t source, std::vector<std::size_t>& cells) const {
  if (source < nodes_.size()) {
    if (nodes_[source].delay == 0) cells.push_back(source);
    return;
  }
  for (const std::size_t s : part_sources_[source - nodes_.size()]) add_reads(s, cells);
}

/// Each CAM after those that it reads within the same instant.
void CamSimulation::find_order() {
  const std::size_t n = nodes_.size();
  std::vector<std::vector<std::size_t>> before(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < nodes_[i].sources.size(); ++k) {
      const auto& late = nodes_[i].late;
      if (std::find(late.begin(), late.end(), k) == late.end()) add_reads(nodes_[i].sources[k], before[i]);
    }
  }
  rank_.assign(n, n);
  for (std::size_t placed = 0; placed < n; ++placed) {
    std::size_t next = n;
    for (std::size_t i = 0; i < n && next == n; ++i) {
      const bool ready =
          std::all_of(before[i].begin(), before[i].end(), [&](std::size_t b) { return rank_[b] < n; });
      if (rank_[i] == n && ready) next = i;
    }
    if (next == n) {
      const auto stuck = std::find(rank_.begin(), rank_.end(), n) - rank_.begin();
      throw DesignError(fmt::format("{} stands in a loop without any delay, expected a Hold in it",
                                    nodes_[static_cast<std::size_t>(stuck)].name));
    }
    rank_[next] = placed;
  }
}

double CamSimulation::read(std::size_t source) const {
  if (source < nodes_.size()) return nodes_[source].visible;
  constexpr std::size_t kMostInputs = 8;
  double inputs[kMostInputs];
  const auto& from = part_sources_[source - nodes_.size()];
  const std::size_t count = std::min(from.size(), kMostInputs);
  for (std::size_t i = 0; i < count; ++i) inputs[i] = read(from[i]);
  return parts_[source - nodes_.size()].value(static_cast<double>(now_) / ticks_per_second_, {inputs, count});
}

void CamSimulation::edge(std::size_t i) {
  Node& node = nodes_[i];
  auto late = node.late.begin();
  for (std::size_t k = 0; k < node.sources.size(); ++k) {
    if (late != node.late.end() && *late == k) {
      ++late;
    } else {
      node.read[k] = read(node.sources[k]);
    }
  }
  const double made = node.step->at_edge(node.read);
  const double out = std::clamp(made, -full_scale_v_, full_scale_v_);
  if (out != made) node.clipped = true;
  if (node.delay == 0) {
    node.visible = out;
  } else {
    node.pending.push_back(out);
  }
}

/// The sample that was made `delay` ago, if that was not before the first edge.
void CamSimulation::appear(Node& node, std::int64_t tick) {
  if (tick < node.offset + node.delay || node.pending.empty()) return;
  node.visible = node.pending.front();
  node.pending.pop_front();
}

void CamSimulation::run_beats(std::int64_t tick) {
  now_ = tick;
  Beat* only = nullptr;
  std::size_t due = 0;
  for (Beat& b : beats_) {
    if (b.next != tick) continue;
    b.next += b.period;
    ++due;
    only = &b;
    for (const std::size_t i : b.appear) appear(nodes_[i], tick);
  }
  const auto just = [&](const Beat& b) { return b.next - b.period == tick; };
  if (due == 1) {
    for (const std::size_t i : only->edges) edge(i);
  } else {
    std::vector<std::size_t> edges;
    for (const Beat& b : beats_) {
      if (just(b)) edges.insert(edges.end(), b.edges.begin(), b.edges.end());
    }
    std::sort(edges.begin(), edges.end(), [&](std::size_t i, std::size_t j) { return rank_[i] < rank_[j]; });
    for (const std::size_t i : edges) edge(i);
  }
  for (const Beat& b : beats_) {
    if (!just(b)) continue;
    for (const std::size_t i : b.latch) {
      for (const std::size_t k : nodes_[i].late) nodes_[i].read[k] = read(nodes_[i].sources[k]);
    }
  }
}

void CamSimulation::advance_to(double time_s) {
  const auto last = whole_number<std::int64_t>(std::floor(time_s * ticks_per_second_ * (1.0 + 1e-15)));
  for (;;) {
    std::int64_t next = last + 1;
    for (const Beat& b : beats_) next = std::min(next, b.next);
    if (next > last) break;
    run_beats(next);
  }
  now_ = std::max(now_, last);
}

double CamSimulation::value(const std::string& name) const {
  return read(source_of(name, "the caller"));
}

std::vector<std::string> CamSimulation::clipped() const {
  std::vector<std::string> out;
  for (const Node& node : nodes_) {
    if (node.clipped) out.push_back(node.name);
  }
  return out;
}

void CamSimulation::forget_clipping() {
  for (Node& node : nodes_) node.clipped = false;
}

}  // namespace bodesmith::fpaa
