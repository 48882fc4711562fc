#include "fpaa/device/memory_image.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"

namespace bodesmith::fpaa {
namespace {

/// Zeros that a block of a C array takes in.
constexpr int kZerosInside = 4;
constexpr int kLongestBlock = 256;
/// Dummies of an AHF file.
constexpr int kZerosBefore = 5;
constexpr int kZerosAfter = 1;

struct BankRange {
  int first;
  int bytes;
};
constexpr std::array<BankRange, 5> kWholeBlocks = {
    {{0x00, 32}, {0x01, 32}, {0x02, 256}, {0x0A, 256}, {0x12, 192}}};

ConfigBlock memory_block(const MemoryImage& memory, int from, int count) {
  ConfigBlock out;
  out.bank = from / MemoryImage::kBankBytes;
  out.byte = from % MemoryImage::kBankBytes;
  for (int i = from; i < from + count; ++i) {
    out.data.push_back(memory.at(i / MemoryImage::kBankBytes, i % MemoryImage::kBankBytes));
  }
  return out;
}

}  // namespace

void MemoryImage::lay_over(const ConfigStream& stream, const std::string& file) {
  std::size_t offset = static_cast<std::size_t>(stream.leading_zeros) + (stream.primary ? 7U : 3U);
  for (const ConfigBlock& block : stream.blocks) {
    const std::size_t start = flat(block.bank, block.byte);
    if (start + block.data.size() > kBytes) {
      throw InputError(
          fmt::format("{}: byte {}: the block runs from bank {}, byte {} over {} bytes, expected "
                      "it to end in bank {}",
                      file, offset, block.bank, block.byte, block.data.size(), kBanks - 1));
    }
    std::copy(block.data.begin(), block.data.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(start));
    offset += block.data.size() + 4;
  }
}

std::map<MemoryPlace, int> changed_bytes(const MemoryImage& from, const MemoryImage& to) {
  std::map<MemoryPlace, int> out;
  for (int bank = 0; bank < MemoryImage::kBanks; ++bank) {
    for (int byte = 0; byte < MemoryImage::kBankBytes; ++byte) {
      if (from.at(bank, byte) != to.at(bank, byte)) out[{bank, byte}] = to.at(bank, byte);
    }
  }
  return out;
}

std::vector<ConfigBlock> sparse_blocks(const MemoryImage& memory) {
  const auto value = [&](int i) {
    return memory.at(i / MemoryImage::kBankBytes, i % MemoryImage::kBankBytes);
  };
  const int end = static_cast<int>(MemoryImage::kBytes);
  std::vector<ConfigBlock> out;
  int at = 0;
  while (at < end) {
    if (value(at) == 0) {
      ++at;
      continue;
    }
    int last = at;
    for (int i = at + 1; i < end && i - last <= kZerosInside + 1 && i - at < kLongestBlock; ++i) {
      if (value(i) != 0) last = i;
    }
    out.push_back(memory_block(memory, at, last - at + 1));
    at = last + 1;
  }
  return out;
}

std::vector<ConfigBlock> whole_blocks(const MemoryImage& memory) {
  std::vector<ConfigBlock> out;
  for (const BankRange& range : kWholeBlocks) {
    out.push_back(memory_block(memory, MemoryImage::kBankBytes * range.first, range.bytes));
  }
  return out;
}

ConfigStream primary_stream(const MemoryImage& memory, int address1, StreamForm form) {
  ConfigStream out;
  out.primary = true;
  out.address1 = address1;
  out.control = kPrimaryControl;
  out.blocks = form == StreamForm::sparse ? sparse_blocks(memory) : whole_blocks(memory);
  if (form == StreamForm::whole) {
    out.leading_zeros = kZerosBefore;
    out.trailing_zeros = kZerosAfter;
  }
  return out;
}

bool is_written_by(const ConfigStream& stream, StreamForm form) {
  if (!stream.primary) return false;
  MemoryImage memory;
  memory.lay_over(stream, "");
  ConfigStream again = primary_stream(memory, stream.address1, form);
  again.control = stream.control;
  again.leading_zeros = stream.leading_zeros;
  again.trailing_zeros = stream.trailing_zeros;
  return encode(again) == encode(stream);
}

}  // namespace bodesmith::fpaa
