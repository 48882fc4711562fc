#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "fpaa/device/config_stream.hpp"

namespace bodesmith::fpaa {

/// Configuration memory of one AN231: 24 banks of 32 bytes. Banks 0 and 1 belong to the chip, 2 to its I/O
/// cells, 2c+1 and 2c+2 to CAB c (1 to 4), 16 to 23 to the look-up table. A chip that comes from reset is
/// all zero (vendor streams leave zeros out).
class MemoryImage {
 public:
  static constexpr int kBanks = 24;
  static constexpr int kBankBytes = 32;
  static constexpr std::size_t kBytes = static_cast<std::size_t>(kBanks * kBankBytes);

  std::uint8_t at(int bank, int byte) const { return bytes_.at(flat(bank, byte)); }
  void set(int bank, int byte, int value) { bytes_.at(flat(bank, byte)) = static_cast<std::uint8_t>(value); }

  /// Writes the blocks of a stream over what is there. Throws InputError `FILE: byte N: …` (N counts the bytes
  /// of the stream) for a block beyond the last bank.
  void lay_over(const ConfigStream& stream, const std::string& file);

  friend bool operator==(const MemoryImage&, const MemoryImage&) = default;

 private:
  static std::size_t flat(int bank, int byte) { return static_cast<std::size_t>(kBankBytes * bank + byte); }
  std::array<std::uint8_t, kBytes> bytes_{};
};

/// The bytes that differ, and what the second image has there.
std::map<MemoryPlace, int> changed_bytes(const MemoryImage& from, const MemoryImage& to);

/// Which bytes a primary stream writes.
enum class StreamForm {
  sparse,  ///< the vendor's C arrays: only what is not zero, no dummies
  whole,   ///< the vendor's AHF files: all banks in five blocks, five zeros before and one after
};

/// The blocks of the vendor's C arrays: a block starts and ends with a byte that is not zero, takes in runs of
/// up to four zeros and is at most 256 bytes long.
std::vector<ConfigBlock> sparse_blocks(const MemoryImage& memory);
/// The five blocks of the vendor's AHF files.
std::vector<ConfigBlock> whole_blocks(const MemoryImage& memory);

/// The control byte of every public primary: EndExecute, Pullups, UpdateClocks.
inline constexpr int kPrimaryControl =
    ConfigStream::kEndExecute | ConfigStream::kPullups | ConfigStream::kUpdateClocks;

ConfigStream primary_stream(const MemoryImage& memory, int address1, StreamForm form);

/// The form whose block rule writes a stream again byte for byte, if one of them does.
bool is_written_by(const ConfigStream& stream, StreamForm form);

}  // namespace bodesmith::fpaa
