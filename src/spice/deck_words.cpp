#include "spice/deck_words.hpp"

#include <algorithm>
#include <cctype>

namespace bodesmith::spice {

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

}  // namespace bodesmith::spice
