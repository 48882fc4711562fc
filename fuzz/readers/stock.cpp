#include "synthesis/parts/stock.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_stock_bytes(std::string_view bytes) {
  const auto stock = synthesis::StockList::parse_csv(bytes, "stock.csv");
  if (stock.resistors) require_finite(stock.resistors->nearest(1e3));
  if (stock.capacitors) require_finite(stock.capacitors->nearest(1e-9));
}
const Registered stock_reader{"stock", read_stock_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
