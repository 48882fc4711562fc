#pragma once

#include <string_view>
#include <vector>

namespace bodesmith::fpaa {

/// The words of the CAM dialogs (and the HTML report) for a key of plan.json's parameters.
struct CamWord {
  std::string_view key;
  std::string_view words;
  bool frequency = false;  ///< shown in kHz
};
const std::vector<CamWord>& cam_words();
const CamWord* find_word(std::string_view key);

}  // namespace bodesmith::fpaa
