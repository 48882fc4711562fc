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

/// Two periods of a triangle of 0 to 1 V as the points of a PWL source.
std::string triangle_points(double frequency_hz);

}  // namespace bodesmith::spice
