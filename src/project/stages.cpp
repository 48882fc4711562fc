#include "project/stages.hpp"

#include <future>
#include <utility>

namespace bodesmith::project {

Stages::Stage Stages::add(std::vector<Stage> needs, std::function<void()> work) {
  stages_.push_back({std::move(needs), std::move(work)});
  return stages_.size() - 1;
}

void Stages::run() {
  std::vector<std::shared_future<void>> done;
  for (const One& one : stages_) {
    std::vector<std::shared_future<void>> needed;
    for (const Stage need : one.needs) needed.push_back(done.at(need));
    done.push_back(std::async(std::launch::async, [this, &one, needed = std::move(needed)] {
                     for (const auto& need : needed) need.wait();
                     if (failed_) return;
                     try {
                       one.work();
                     } catch (...) {
                       failed_ = true;
                       throw;
                     }
                   }).share());
  }
  for (const auto& stage : done) stage.wait();
  for (const auto& stage : done) stage.get();
}

}  // namespace bodesmith::project
