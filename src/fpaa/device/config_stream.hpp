#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith::fpaa {

using Bytes = std::vector<std::uint8_t>;

/// A byte of a chip's configuration memory: banks of 32 bytes.
struct MemoryPlace {
  int bank = 0;
  int byte = 0;
  friend auto operator<=>(const MemoryPlace&, const MemoryPlace&) = default;
};

/// Consecutive bytes of the configuration memory (banks of 32 bytes; a block may run on into the next bank).
struct ConfigBlock {
  int bank = 0;
  int byte = 0;
  Bytes data;
  friend bool operator==(const ConfigBlock&, const ConfigBlock&) = default;
};

/// A configuration stream of the AN231 ("Apex") as the vendor's generated code writes it:
///   primary: dummies 00, D5, device id B7 20 01 00, Address1, control, blocks, trailing 00s
///   update:  [dummies 00,] D5, Address1, control, blocks, trailing 00s
/// A block: 80 | 40 if another follows | 20 if a CRC16 follows instead of the check byte | byte address;
/// bank; count (00 = 256); data; 2A. The polynomial of the CRC is not publicly known: streams with it are
/// refused.
struct ConfigStream {
  bool primary = false;
  int leading_zeros = 0;
  int address1 = 1;
  int control = 0;
  std::vector<ConfigBlock> blocks;
  int trailing_zeros = 0;

  static constexpr int kEndExecute = 0x80;
  static constexpr int kPullups = 0x40;
  static constexpr int kUpdateClocks = 0x01;
};

/// These bytes as blocks of neighbours, at most 256 long.
std::vector<ConfigBlock> blocks_of(const std::map<MemoryPlace, int>& memory);
/// An update that sets these bytes, as a host sends it.
ConfigStream update_of(int address1, const std::map<MemoryPlace, int>& memory);

Bytes encode(const ConfigStream& stream);
/// The inverse, byte for byte: encode(decode(x)) == x. Throws InputError `FILE: byte N: …` (N counts from 0).
ConfigStream decode(const Bytes& bytes, const std::string& file);

/// AHF: one two-digit hexadecimal byte a line.
std::string to_ahf(const Bytes& bytes);
Bytes from_ahf(std::string_view text, const std::string& file);

/// The first byte of a stream that is no zero.
inline constexpr std::uint8_t kSynch = 0xD5;
/// Around packets and answers on the serial line.
inline constexpr char kStx = 0x02;
inline constexpr char kEtx = 0x03;

/// The board's serial packet: STX, '0' primary or '1' update, four hex digits = number of hex characters, the
/// bytes as hex text, ETX.
std::string to_packet(const Bytes& bytes, bool as_primary);
/// Two hexadecimal digits a byte.
std::string hex_text(std::span<const std::uint8_t> bytes);

struct Packet {
  bool primary = false;
  Bytes bytes;
};
/// One or more packets in a row.
std::vector<Packet> from_packets(std::string_view text, const std::string& file);

}  // namespace bodesmith::fpaa
