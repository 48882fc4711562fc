#include "base/provenance.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <stdexcept>

#include "base/files.hpp"

namespace bodesmith {

std::string sha256_hex(std::string_view bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest, &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("SHA-256 is not available in the cryptography library");
  }
  std::string out;
  for (unsigned int i = 0; i < length; ++i) out += fmt::format("{:02x}", digest[i]);
  return out;
}

std::string Provenance::read(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  // A document that says what it is, is read once more by what it is for.
  if (std::ranges::find(inputs, path.string(), &InputFile::path) == inputs.end())
    inputs.push_back({path.string(), sha256_hex(bytes), {}});
  remember_input(path);
  return bytes;
}

}  // namespace bodesmith
