#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "fit/direct/curve_target.hpp"
#include "fit/direct/root_model.hpp"

namespace bodesmith {

/// Many starts for a fit whose landscape has many valleys, built up order by order: the best fits so far plus
/// a pole and a zero that nearly cancel, at several frequencies; evenly spread roots; random ones (seeded).
/// Each is improved by `improve`, and the best few different ones are kept.
class StartBuilder {
 public:
  struct Settings {
    RadPerSecond low;  ///< roots begin between these
    RadPerSecond high;
    bool real = true;  ///< models grow root by root, otherwise pair by pair
    double log_gain = 0.0;
    int random = 12;  ///< random starts at the order asked for; a quarter of it below
    int kept = 4;
    std::uint64_t seed = 1;
  };
  /// Called from several threads at once.
  using Improve = std::function<SearchResult(const RootModel& model, const Eigen::VectorXd& start)>;

  StartBuilder(Settings settings, Improve improve) : settings_(settings), improve_(std::move(improve)) {}

  /// The best few for a model with these numbers of zeros and poles, best first.
  std::vector<SearchResult> build(int zeros, int poles, RadPerSecond reference);
  int tried() const { return tried_; }

  static RootModel make_model(int zeros, int poles, bool real, RadPerSecond reference);

 private:
  std::vector<SearchResult> try_starts(const RootModel& model, const std::vector<Eigen::VectorXd>& starts);
  /// The best of a smaller model, each with a new zero and pole (or pairs of them) that nearly cancel.
  std::vector<SearchResult> grow(const std::vector<SearchResult>& best, const RootModel& old,
                                 const RootModel& model);
  /// Evenly spread roots, interlaced both ways round.
  std::vector<SearchResult> spread_evenly(const RootModel& model);
  std::vector<SearchResult> scatter(const RootModel& model, int count, std::mt19937_64& random);

  Settings settings_;
  Improve improve_;
  int tried_ = 0;
};

}  // namespace bodesmith
