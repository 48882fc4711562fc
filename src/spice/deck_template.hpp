#pragma once

#include <string>
#include <vector>

#include "spice/dialect.hpp"

namespace bodesmith::spice {

/// A list of lines that a template repeats: {{#name}}{{line}}{{/name}}.
struct TemplateLines {
  std::string name;
  std::vector<std::string> lines;
};

/// The deck `file` from templates/spice/FILE, with the request's title, band, triangle and tolerances.
Deck deck_from_template(const std::string& file, const DeckRequest& request,
                        const std::vector<TemplateLines>& lists = {});

}  // namespace bodesmith::spice
