#include "fpaa/streams/stream_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/streams/c_source.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kMostDummies = 16;

FoundStream found(std::string name, FileForm form, Bytes bytes) {
  FoundStream out;
  out.stream = decode(bytes, name);
  out.name = std::move(name);
  out.form = form;
  out.bytes = std::move(bytes);
  return out;
}

/// Zeros, then the synch byte.
bool looks_like_stream(std::string_view bytes) {
  const std::size_t at = bytes.find_first_not_of('\0');
  return at != std::string_view::npos && static_cast<std::uint8_t>(bytes[at]) == kSynch;
}

bool is_text(std::string_view text) {
  return std::ranges::none_of(text, [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u < 0x20 && u != '\n' && u != '\r' && u != '\t' && u != '\f' && u != '\v';
  });
}

/// Plain lists of bytes `NAME[…] = { 0x.., … }` of C source; lists of anything else are passed over.
std::vector<std::pair<std::string, Bytes>> byte_arrays(std::string_view text, const std::string& file) {
  std::vector<CToken> t;
  for (const CToken& token : c_tokens(text, file)) {
    if (token.kind != CToken::Kind::comment) t.push_back(token);
  }
  std::vector<std::pair<std::string, Bytes>> out;
  for (std::size_t i = 0; i < t.size(); ++i) {
    std::size_t k = i;
    if (!opens_array(t, k)) continue;
    Bytes bytes;
    const auto is_number = [&](std::size_t n) {
      return t[n].kind == CToken::Kind::word && is_digit(t[n].text[0]);
    };
    bool plain = true;
    for (; k < t.size() && t[k].text != "}" && plain; ++k) {
      if (t[k].text == ",") continue;
      plain = is_number(k);
      // Only the first value tells whether this list is a stream at all.
      if (plain && bytes.empty() && c_integer(t[k], 0x7FFFFFFF, file) != kSynch && t[k].text != "0x00") {
        plain = false;
      }
      if (plain) bytes.push_back(static_cast<std::uint8_t>(c_integer(t[k], 255, file)));
    }
    if (plain && k >= t.size()) throw InputError(file, t.back().line, "the array does not end, expected }");
    if (plain) out.emplace_back(std::string(t[i].text), std::move(bytes));
  }
  return out;
}

std::vector<FoundStream> streams_of_source(std::string_view text, const std::string& file) {
  std::vector<FoundStream> out;
  for (auto& [name, bytes] : byte_arrays(text, file)) {
    const std::string_view view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    // A list of addresses, and the generated code's templates whose Address1 is filled in later, are none.
    if (!looks_like_stream(view) || bytes.size() < 4 || bytes[view.find_first_not_of('\0') + 1] == 0)
      continue;
    out.push_back(found(fmt::format("{}: {}", file, name), FileForm::c_array, std::move(bytes)));
  }
  if (out.empty()) {
    throw InputError(
        fmt::format("{}: holds no configuration stream, expected AHF, C source with an array that "
                    "begins with 0xD5, board packets or the raw bytes",
                    file));
  }
  return out;
}

}  // namespace

std::string_view to_string(FileForm form) {
  static constexpr const char* kNames[] = {"AHF", "C array", "board packet", "raw bytes"};
  return kNames[static_cast<std::size_t>(form)];
}

std::vector<FoundStream> find_streams(std::string_view content, const std::string& file) {
  if (content.empty()) throw InputError(fmt::format("{}: byte 0: nothing there, expected a stream", file));
  if (content[0] == kStx) {
    std::vector<FoundStream> out;
    for (Packet& packet : from_packets(content, file)) {
      const std::string name = fmt::format("{}: packet {}", file, out.size() + 1);
      out.push_back(found(name, FileForm::packet, std::move(packet.bytes)));
    }
    return out;
  }
  if (is_text(content)) {
    if (content.find('{') != std::string_view::npos) return streams_of_source(content, file);
    return {found(file, FileForm::ahf, from_ahf(content, file))};
  }
  if (!looks_like_stream(content)) {
    const std::size_t at = content.find_first_not_of('\0');
    throw InputError(
        at == std::string_view::npos
            ? fmt::format("{}: byte 0: nothing but zeros, expected a stream", file)
            : fmt::format("{}: byte {}: is {:02X}, expected D5 (the synch byte) after at most {} "
                          "zeros",
                          file, at, static_cast<std::uint8_t>(content[at]), kMostDummies));
  }
  return {found(file, FileForm::raw, Bytes(content.begin(), content.end()))};
}

}  // namespace bodesmith::fpaa
