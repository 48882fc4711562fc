#include "fpaa/streams/api_code.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "fpaa/streams/c_source.hpp"

namespace bodesmith::fpaa {
namespace {

using TokenKind = CToken::Kind;

class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : file_(file), t_(c_tokens(text, file)) {
    out_.file = file;
  }

  ApiProject run() {
    for (at_ = 0; at_ < t_.size(); ++at_) {
      if (t_[at_].kind != TokenKind::word) continue;
      const std::string_view word = t_[at_].text;
      if (word.ends_with("_PrimaryConfigInfo") && opens_array()) {
        numbers();
        out_.chips.push_back({std::string(word)});
      }
      if (word.ends_with("_Capacitor") && opens_array()) capacitors(word);
      if (word.ends_with("_apiAddress1") && opens_array()) addresses_ = numbers();
    }
    if (out_.cams.empty()) {
      throw InputError(
          fmt::format("{}: has no capacitor tables, expected the ApiCode.c that the vendor's tool generated "
                      "with C code switched on for the CAMs",
                      file_));
    }
    // In the order of the chips' numbers, which is the order of their primary streams.
    for (std::size_t i = 0; i < out_.chips.size() && i < addresses_.size(); ++i)
      out_.chips[i].address1 = addresses_[i];
    split_names();
    return std::move(out_);
  }

 private:
  bool opens_array() {
    line_ = t_[at_].line;
    return fpaa::opens_array(t_, at_);
  }
  const CToken& need(const char* what) {
    if (at_ >= t_.size())
      throw InputError(file_, line_, fmt::format("the table does not end, expected {}", what));
    return t_[at_];
  }

  /// Bytes up to the closing brace.
  std::vector<int> numbers() {
    std::vector<int> out;
    for (; need("}").text != "}"; ++at_) {
      if (t_[at_].kind == TokenKind::comment || t_[at_].text == ",") continue;
      out.push_back(c_integer(t_[at_], 255, file_));
    }
    return out;
  }

  void capacitors(std::string_view word) {
    ApiProject::Cam cam;
    cam.name = std::string(word.substr(0, word.size() - std::string_view("_Capacitor").size()));
    cam.line = line_;
    std::string name;
    for (; need("}").text != "}"; ++at_) {
      if (t_[at_].kind == TokenKind::comment) {
        name = std::string(t_[at_].text);
        continue;
      }
      if (t_[at_].text == ",") continue;
      if (t_[at_].text != "{") {
        throw InputError(file_, t_[at_].line, fmt::format("'{}', expected {{ bank, byte }}", t_[at_].text));
      }
      ++at_;
      const std::vector<int> place = numbers();
      if (place.size() != 2) {
        throw InputError(file_, t_[at_].line,
                         fmt::format("has {} numbers, expected bank and byte", place.size()));
      }
      if (name.empty())
        throw InputError(file_, t_[at_].line, "has no comment with the capacitor's name before it");
      if (place[1] > 31)
        throw InputError(file_, t_[at_].line, fmt::format("byte {}, expected 0 to 31", place[1]));
      cam.capacitors.push_back({name, place[0], place[1]});
      name.clear();
    }
    out_.cams.push_back(std::move(cam));
  }

  /// `an_FPAA1_GainInv1` -> an, FPAA1, GainInv1. The chips' own arrays tell where the parts end.
  void split_names() {
    for (ApiProject::Chip& chip : out_.chips) {
      const std::size_t first = chip.name.find('_');
      const std::size_t last = chip.name.rfind("_PrimaryConfigInfo");
      if (out_.prefix.empty()) out_.prefix = chip.name.substr(0, first);
      chip.name = chip.name.substr(first + 1, last - first - 1);
    }
    for (ApiProject::Cam& cam : out_.cams) {
      const std::string whole = cam.name;
      if (out_.prefix.empty()) out_.prefix = whole.substr(0, whole.find('_'));
      std::string rest = whole.substr(std::min(whole.size(), out_.prefix.size() + 1));
      const ApiProject::Chip* owner = nullptr;
      for (const ApiProject::Chip& chip : out_.chips) {
        if (rest.rfind(chip.name + "_", 0) == 0 &&
            (owner == nullptr || chip.name.size() > owner->name.size())) {
          owner = &chip;
        }
      }
      if (owner == nullptr) {
        // No primary stream in the file: the chip's name ends at the next underscore.
        const std::size_t cut = rest.find('_');
        if (cut == std::string::npos) {
          throw InputError(file_, cam.line,
                           fmt::format("'{}_Capacitor' names no chip, expected prefix_chip_cam", whole));
        }
        cam.chip = rest.substr(0, cut);
        out_.chips.push_back({cam.chip});
        cam.name = rest.substr(cut + 1);
      } else {
        cam.chip = owner->name;
        cam.name = rest.substr(owner->name.size() + 1);
      }
    }
  }

  std::string file_;
  std::vector<CToken> t_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::vector<int> addresses_;
  ApiProject out_;
};

}  // namespace

const ApiProject::Cam* ApiProject::find(const std::string& chip, const std::string& cam) const {
  const auto at = std::ranges::find_if(cams, [&](const Cam& c) { return c.chip == chip && c.name == cam; });
  return at == cams.end() ? nullptr : &*at;
}

ApiProject parse_api_code(std::string_view text, const std::string& file) {
  return Parser(text, file).run();
}

}  // namespace bodesmith::fpaa
