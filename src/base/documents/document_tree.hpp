#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/documents/document.hpp"

namespace bodesmith {

/// The shared tree behind Node. Only the parsers and document_node.cpp see it.
struct Node::Data {
  Kind kind = Kind::null;
  int line = 0;
  std::shared_ptr<const std::string> file;
  bool boolean = false;
  double number = 0.0;
  std::string string;
  std::vector<std::shared_ptr<const Data>> items;
  std::vector<std::pair<std::string, std::shared_ptr<const Data>>> members;
};

/// InputError that names the encoding where these bytes are UTF-16 or UTF-32, which JSON and TOML files here are not.
void require_utf8(std::string_view text, const std::string& file);

}  // namespace bodesmith
