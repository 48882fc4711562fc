#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

namespace bodesmith::project {

/// The stages of a run, in an order in which they could be done one after the other. Each begins as soon as those that it
/// needs are done, in a thread of its own.
class Stages {
 public:
  using Stage = std::size_t;
  Stage add(std::vector<Stage> needs, std::function<void()> work);

  /// Returns when all are done. After an exception no other stage begins, and that of the first stage in order is thrown
  /// again here.
  void run();

 private:
  struct One {
    std::vector<Stage> needs;
    std::function<void()> work;
  };
  std::vector<One> stages_;
  std::atomic<bool> failed_ = false;
};

}  // namespace bodesmith::project
