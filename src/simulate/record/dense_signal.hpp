#pragma once

#include <cstddef>
#include <vector>

#include "signal/time_record.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {

/// A signal known at every time of [begin, end]: pieces of polynomials (degree 1 or 4 at Gauss-Lobatto
/// points), and the times where it, or a derivative of it, jumps. Before its begin it has the value `before`.
class DenseSignal {
 public:
  struct Piece {
    double begin = 0.0;
    double end = 0.0;
    std::size_t degree = 1;
    double nodes[kMaxDegree + 1] = {};
  };

  /// Straight lines between samples; neighbouring samples on one line become one piece.
  static DenseSignal from_record(const TimeRecord& record);
  /// How many pieces that makes, or most + 1 when there are more.
  static std::size_t count_lines(const TimeRecord& record, std::size_t most);

  void append(const Piece& piece) { pieces_.push_back(piece); }
  /// Marks a time at which solvers must start again.
  void corner(double t) { corners_.push_back(t); }

  double before = 0.0;

  double begin() const { return pieces_.front().begin; }
  double end() const { return pieces_.back().end; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  const std::vector<double>& corners() const { return corners_; }
  bool empty() const { return pieces_.empty(); }

  /// Reads with a moving finger: cheap when t moves little. At a common point of two pieces the later one
  /// counts, unless `from_left`.
  class Reader {
   public:
    explicit Reader(const DenseSignal& signal) : signal_(&signal) {}
    double value(double t, bool from_left = false);
    double slope(double t, bool from_left = false);

   private:
    const Piece& find(double t, bool from_left);
    const DenseSignal* signal_;
    std::size_t at_ = 0;
  };

 private:
  std::vector<Piece> pieces_;
  std::vector<double> corners_;
};

}  // namespace bodesmith::simulate
