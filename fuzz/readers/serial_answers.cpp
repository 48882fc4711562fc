#include "fpaa/streams/board_link.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

/// A board that answers with these bytes, whatever it is asked, each when an answer is waited for (time-out 0 here) and
/// nothing when the line is emptied.
class RecordedPort final : public fpaa::SerialPort {
 public:
  explicit RecordedPort(std::string_view bytes) : bytes_(bytes) {}
  void write(std::string_view) override {}
  std::optional<std::uint8_t> read(double seconds) override {
    if (seconds > 0.0 || at_ == bytes_.size()) return std::nullopt;
    return static_cast<std::uint8_t>(bytes_[at_++]);
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

void read_serial_bytes(std::string_view bytes) {
  RecordedPort port(bytes);
  fpaa::send_packets(port,
                     {"\x02"
                      "0"
                      "0002"
                      "D5"
                      "\x03"},
                     1, {0.0, 2});
}
const Registered serial_reader{"serial_answers", read_serial_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
