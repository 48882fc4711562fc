#include "faults/board.hpp"

#include <algorithm>

namespace bodesmith::faults {

namespace {

constexpr double kInstrumentFloor = 3e-5;
constexpr double kCrosstalk = 1e-3;

}  // namespace

void Board::set_good(const Eigen::VectorXcd& good) {
  good_ = good;
  for (Eigen::Index k = 0; k < good.size(); ++k)
    floors_.push_back(std::max(kInstrumentFloor, kCrosstalk * std::abs(good(k))));
}

std::unique_ptr<Board> Board::with_parts(const Eigen::VectorXd&) const {
  return nullptr;
}

namespace {

class JoinedChanges : public ChangedBoard {
 public:
  JoinedChanges(const Board& board, const Effect& first) : board_(board), first_(first) {}
  Eigen::VectorXcd response(const Effect& further) const override {
    return board_.response(joined(first_, further));
  }

 private:
  const Board& board_;
  Effect first_;
};

}  // namespace

std::unique_ptr<ChangedBoard> Board::changed_by(const Effect& effect) const {
  return std::make_unique<JoinedChanges>(*this, effect);
}

Eigen::VectorXcd Board::at_node(const std::string&, const Effect& effect) const {
  return response(effect);
}

Effect Board::in_parallel(std::size_t, double) const {
  return {};
}

std::vector<Fault> Board::faults() const {
  std::vector<Fault> out;
  for (const FaultKind* kind : fault_kind_registry().all()) {
    for (Fault& fault : faults_of(*kind)) {
      fault.kind = kind;
      out.push_back(std::move(fault));
    }
  }
  return out;
}

Effect joined(const Effect& a, const Effect& b) {
  Effect out = a;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(out.stamps, b.stamps);
  append(out.spread, b.spread);
  append(out.units, b.units);
  append(out.clocks, b.clocks);
  out.model_error = std::max(a.model_error, b.model_error);
  return out;
}

}  // namespace bodesmith::faults
