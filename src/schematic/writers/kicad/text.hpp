#pragma once

#include <string>
#include <vector>

#include "schematic/writers/kicad/drawing.hpp"

namespace bodesmith::kicad {

/// A box on the first sheet that stands for another one.
struct SheetBox {
  Point at;
  int width = 0, height = 0;
  std::string name, file;
  std::string in, out;  ///< its pins, left and right; none when empty
};

struct Sheet {
  std::string file;
  std::string paper;
  Drawing drawing;
  std::vector<SheetBox> boxes;  ///< of the first sheet only
};

/// Text of every sheet; the first is the root and carries the references of all. Identifiers are hashes of
/// `title` and of what they stand for: the same circuit gives the same bytes.
std::vector<std::string> sheet_texts(const std::vector<Sheet>& sheets, const std::string& title,
                                     const std::string& comment);
std::string symbol_library_text();
std::string symbol_table_text();
/// The root sheet's identifier, for the project file.
std::string root_uuid(const std::string& title);

}  // namespace bodesmith::kicad
