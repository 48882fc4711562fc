// WAV (RIFF WAVE, little-endian): chunks of a four-letter name, a length and that many bytes, padded to even. "fmt "
// holds the code (1 whole numbers, 3 floating point, 65534 extensible: the code again in its first two bytes of
// sub-format), channels, rate and bits; "data" the samples, channel by channel. Full scale is 1.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

#include "base/error.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

std::uint32_t little(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < count; ++i)
    out |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return out;
}

struct WaveShape {
  unsigned code = 0;
  unsigned channels = 0;
  std::uint32_t rate_hz = 0;
  unsigned bits = 0;
};

[[noreturn]] void fail_at_byte(const Source& source, std::size_t byte, const std::string& what) {
  throw InputError(source.file, 0, fmt::format("byte {}: {}", byte, what));
}

WaveShape read_shape(const Source& source, std::size_t at, std::size_t length) {
  if (length < 16)
    fail_at_byte(source, at, fmt::format("the format chunk has {} bytes, expected at least 16", length));
  WaveShape shape;
  shape.code = little(source.bytes, at, 2);
  shape.channels = little(source.bytes, at + 2, 2);
  shape.rate_hz = little(source.bytes, at + 4, 4);
  shape.bits = little(source.bytes, at + 14, 2);
  if (shape.code == 0xFFFE) {
    if (length < 26) fail_at_byte(source, at, "the extensible format chunk ends early");
    shape.code = little(source.bytes, at + 24, 2);
  }
  const bool whole =
      shape.code == 1 && (shape.bits == 8 || shape.bits == 16 || shape.bits == 24 || shape.bits == 32);
  const bool floating = shape.code == 3 && (shape.bits == 32 || shape.bits == 64);
  if (!whole && !floating)
    fail_at_byte(
        source, at,
        fmt::format(
            "code {} of {} bits, expected 8 to 32 bits of whole numbers or 32 or 64 of floating point",
            shape.code, shape.bits));
  if (shape.channels == 0 || shape.rate_hz == 0) fail_at_byte(source, at, "no channels or no sampling rate");
  return shape;
}

double sample_at(const Source& source, const WaveShape& shape, std::size_t at) {
  const std::string_view b = source.bytes;
  if (shape.code == 3 && shape.bits == 32) return std::bit_cast<float>(little(b, at, 4));
  if (shape.code == 3) {
    const std::uint64_t low = little(b, at, 4);
    const std::uint64_t high = little(b, at + 4, 4);
    return std::bit_cast<double>(low | (high << 32));
  }
  if (shape.bits == 8) return (static_cast<double>(little(b, at, 1)) - 128.0) / 128.0;
  const unsigned count = shape.bits / 8;
  // The sign bit to the top, then an arithmetic shift back.
  const auto raw = static_cast<std::int32_t>(little(b, at, count) << (32 - shape.bits));
  return static_cast<double>(raw) / 2147483648.0;
}

class WaveAudio : public Format {
 public:
  std::string_view name() const override { return "WAV"; }
  bool recognises(const Source& source) const override {
    const std::string_view kind = source.bytes.substr(std::min<std::size_t>(8, source.bytes.size()), 4);
    return source.bytes.starts_with("RIFF") && (kind == "WAVE" || source.bytes.size() < 12);
  }

  Foreign read(const Source& source) const override {
    std::optional<WaveShape> shape;
    std::size_t at = 12;
    while (true) {
      if (at + 8 > source.bytes.size())
        fail_at_byte(source, source.bytes.size(), "the file ends without a data chunk");
      const std::string_view id = source.bytes.substr(at, 4);
      const std::size_t length = little(source.bytes, at + 4, 4);
      at += 8;
      if (length > source.bytes.size() - at)
        fail_at_byte(
            source, source.bytes.size(),
            fmt::format("the file ends within a chunk of {} bytes that begins at byte {}", length, at));
      if (id == "fmt ") shape = read_shape(source, at, length);
      if (id == "data") break;
      at += length + (length & 1U);
    }
    if (!shape) fail_at_byte(source, at, "the samples come before their format");
    return read_samples(source, *shape, at, little(source.bytes, at - 4, 4));
  }

 private:
  static Foreign read_samples(const Source& source, const WaveShape& shape, std::size_t at,
                              std::size_t length) {
    const std::size_t frame = shape.channels * shape.bits / 8;
    const std::size_t count = length / frame;
    if (count * frame != length)
      fail_at_byte(source, at, fmt::format("{} bytes of samples, expected a multiple of {}", length, frame));
    if (count < 2) fail_at_byte(source, at, "fewer than two samples");
    std::vector<double> time(count);
    for (std::size_t i = 0; i < count; ++i) time[i] = static_cast<double>(i) / shape.rate_hz;
    std::vector<SignalTrace> signals(shape.channels);
    for (unsigned c = 0; c < shape.channels; ++c) {
      signals[c].name = fmt::format("channel {}", c + 1);
      signals[c].values.resize(count);
      for (std::size_t i = 0; i < count; ++i)
        signals[c].values[i] = sample_at(source, shape, at + i * frame + c * shape.bits / 8);
    }
    const Words words{"WAV", {fmt::format("{} Hz, {} bits, full scale is 1", shape.rate_hz, shape.bits)}};
    return record_columns(source, words, std::move(time), choose_signals(source, std::move(signals)), {},
                          Steps::as_they_are);
  }
};

}  // namespace

BODESMITH_ENTRY(Format, wave_audio, WaveAudio)

}  // namespace bodesmith::formats
