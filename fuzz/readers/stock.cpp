#include "circuit/parts/stock.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_stock_bytes(std::string_view bytes) {
  circuit::StockList::parse_csv(bytes, "stock.csv");
}
const Registered stock_reader{"stock", read_stock_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
