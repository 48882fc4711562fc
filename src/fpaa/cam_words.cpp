#include "fpaa/cam_words.hpp"

namespace bodesmith::fpaa {

const std::vector<CamWord>& cam_words() {
  static const std::vector<CamWord> all = {
      {"pole_hz", "Pole Frequency", true},
      {"zero_hz", "Zero Frequency", true},
      {"corner_hz", "Corner Frequency", true},
      {"dc_gain", "DC Gain", false},
      {"high_frequency_gain", "High Frequency Gain", false},
      {"gain", "Gain", false},
      {"quality", "Quality Factor", false},
  };
  return all;
}

const CamWord* find_word(std::string_view key) {
  for (const CamWord& word : cam_words()) {
    if (word.key == key) return &word;
  }
  return nullptr;
}

}  // namespace bodesmith::fpaa
