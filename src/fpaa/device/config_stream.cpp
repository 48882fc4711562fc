#include "fpaa/device/config_stream.hpp"

#include <fmt/format.h>

#include <array>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr std::uint8_t kCheck = 0x2A;
constexpr std::array<std::uint8_t, 4> kDevice = {0xB7, 0x20, 0x01, 0x00};

[[noreturn]] void fail_at(const std::string& file, std::size_t byte, const std::string& message) {
  throw InputError(fmt::format("{}: byte {}: {}", file, byte, message));
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

class Reader {
 public:
  Reader(const Bytes& bytes, const std::string& file) : bytes_(bytes), file_(file) {}
  bool at_end() const { return at_ >= bytes_.size(); }
  std::size_t at() const { return at_; }
  std::uint8_t next(const char* what) {
    if (at_end()) fail_at(file_, at_, fmt::format("the stream ends, expected {}", what));
    return bytes_[at_++];
  }
  void expect(std::uint8_t wanted, const char* what) {
    const std::size_t where = at_;
    const std::uint8_t got = next(what);
    if (got != wanted)
      fail_at(file_, where, fmt::format("is {:02X}, expected {:02X} ({})", got, wanted, what));
  }
  int zeros() {
    int count = 0;
    while (at_ < bytes_.size() && bytes_[at_] == 0) {
      ++at_;
      ++count;
    }
    return count;
  }
  bool has(std::size_t ahead) const { return at_ + ahead < bytes_.size(); }
  std::uint8_t peek(std::size_t ahead = 0) const { return has(ahead) ? bytes_[at_ + ahead] : 0; }

 private:
  const Bytes& bytes_;
  const std::string& file_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<ConfigBlock> blocks_of(const std::map<MemoryPlace, int>& memory) {
  constexpr int kBankBytes = 32;
  std::vector<ConfigBlock> out;
  int next = -1;
  for (const auto& [place, value] : memory) {
    const int address = kBankBytes * place.bank + place.byte;
    if (address != next || out.back().data.size() == 256) out.push_back({place.bank, place.byte, {}});
    out.back().data.push_back(static_cast<std::uint8_t>(value));
    next = address + 1;
  }
  return out;
}

ConfigStream update_of(int address1, const std::map<MemoryPlace, int>& memory) {
  ConfigStream out;
  out.address1 = address1;
  out.control = ConfigStream::kEndExecute;
  out.blocks = blocks_of(memory);
  out.trailing_zeros = 1;  // the dummy byte that the board is sent after the data
  return out;
}

Bytes encode(const ConfigStream& stream) {
  Bytes out(static_cast<std::size_t>(stream.leading_zeros), 0);
  out.push_back(kSynch);
  if (stream.primary) out.insert(out.end(), kDevice.begin(), kDevice.end());
  out.push_back(static_cast<std::uint8_t>(stream.address1));
  out.push_back(static_cast<std::uint8_t>(stream.control));
  for (std::size_t i = 0; i < stream.blocks.size(); ++i) {
    const ConfigBlock& block = stream.blocks[i];
    out.push_back(static_cast<std::uint8_t>(0x80 | (i + 1 < stream.blocks.size() ? 0x40 : 0) | block.byte));
    out.push_back(static_cast<std::uint8_t>(block.bank));
    out.push_back(static_cast<std::uint8_t>(block.data.size() & 0xFF));
    out.insert(out.end(), block.data.begin(), block.data.end());
    out.push_back(kCheck);
  }
  out.insert(out.end(), static_cast<std::size_t>(stream.trailing_zeros), 0);
  return out;
}

ConfigStream decode(const Bytes& bytes, const std::string& file) {
  Reader in(bytes, file);
  ConfigStream out;
  out.leading_zeros = in.zeros();
  in.expect(kSynch, "the synch byte");
  // An update has the head of a block (80 to FF) behind its address and control byte, or ends there.
  if (in.peek() == kDevice[0] || (in.peek(2) != 0 && (in.peek(2) & 0x80) == 0)) {
    out.primary = true;
    for (const std::uint8_t id : kDevice) in.expect(id, "the AN231 device id");
  }
  const std::size_t address_at = in.at();
  out.address1 = in.next("Address1");
  if (out.address1 == 0) fail_at(file, address_at, "Address1 is 0, expected 1 to 255");
  out.control = in.next("the control byte");
  bool another = !in.at_end() && (in.peek() & 0x80) != 0;
  while (another) {
    const std::size_t start = in.at();
    const std::uint8_t head = in.next("a block");
    if ((head & 0x80) == 0) {
      fail_at(file, start, fmt::format("is {:02X}, expected the head of a block (80 to FF)", head));
    }
    if ((head & 0x20) != 0) {
      fail_at(file, start,
              "the block ends with a CRC16, whose polynomial is not publicly known; expected a check byte");
    }
    another = (head & 0x40) != 0;
    ConfigBlock block;
    block.byte = head & 0x1F;
    block.bank = in.next("a bank address");
    const int count = in.next("a byte count");
    for (int i = 0; i < (count == 0 ? 256 : count); ++i) block.data.push_back(in.next("a data byte"));
    in.expect(kCheck, "the check byte of a block");
    out.blocks.push_back(std::move(block));
  }
  out.trailing_zeros = in.zeros();
  if (!in.at_end())
    fail_at(file, in.at(), fmt::format("is {:02X}, expected the end of the stream", in.peek()));
  return out;
}

std::string to_ahf(const Bytes& bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) out += fmt::format("{:02X}\n", byte);
  return out;
}

Bytes from_ahf(std::string_view text, const std::string& file) {
  Bytes out;
  int line = 0;
  for (std::string_view row : split(text, '\n')) {
    ++line;
    row = trim(row);
    if (row.empty()) continue;
    if (row.size() != 2 || hex_digit(row[0]) < 0 || hex_digit(row[1]) < 0) {
      throw InputError(file, line,
                       fmt::format("'{}' at byte {} is not a byte, expected two hexadecimal digits a line",
                                   row.substr(0, 20), out.size()));
    }
    out.push_back(static_cast<std::uint8_t>(16 * hex_digit(row[0]) + hex_digit(row[1])));
  }
  return out;
}

std::string to_packet(const Bytes& bytes, bool as_primary) {
  std::string out(1, kStx);
  out += as_primary ? '0' : '1';
  out += fmt::format("{:04X}", 2 * bytes.size());
  return out + hex_text(bytes) + kEtx;
}

std::string hex_text(std::span<const std::uint8_t> bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) out += fmt::format("{:02X}", byte);
  return out;
}

std::vector<Packet> from_packets(std::string_view text, const std::string& file) {
  std::vector<Packet> out;
  std::size_t at = 0;
  const auto next = [&](const char* what) {
    if (at >= text.size()) fail_at(file, at, fmt::format("the packet ends, expected {}", what));
    return text[at++];
  };
  const auto hex = [&](const char* what) {
    const std::size_t where = at;
    const int digit = hex_digit(next(what));
    if (digit < 0) fail_at(file, where, fmt::format("is not a hexadecimal digit, expected {}", what));
    return digit;
  };
  if (text.empty()) fail_at(file, 0, "nothing there, expected a packet");
  while (at < text.size()) {
    if (next("STX") != kStx) fail_at(file, at - 1, "is not STX (02), expected the start of a packet");
    const char kind = next("'0' or '1'");
    if (kind != '0' && kind != '1') fail_at(file, at - 1, "expected '0' (primary) or '1' (update)");
    int length = 0;
    for (int i = 0; i < 4; ++i) length = 16 * length + hex("the length");
    if (length % 2 != 0)
      fail_at(file, at - 4, fmt::format("the length {} is odd, expected two digits a byte", length));
    Packet packet;
    packet.primary = kind == '0';
    for (int i = 0; i < length / 2; ++i) {
      const int high = hex("a byte");
      packet.bytes.push_back(static_cast<std::uint8_t>(16 * high + hex("a byte")));
    }
    if (next("ETX") != kEtx)
      fail_at(file, at - 1, "is not ETX (03): the packet is longer than its length says");
    out.push_back(std::move(packet));
  }
  return out;
}

}  // namespace bodesmith::fpaa
