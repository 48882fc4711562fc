#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/documents/json_fwd.hpp"

namespace bodesmith {

struct EmbeddedTemplate {
  std::string_view name;
  std::string_view text;
};

/// Every file under templates/, put into the library at build time.
const std::vector<EmbeddedTemplate>& embedded_templates();

/// Fills templates/`name` (mustache) with `data`. {{x}} is HTML-escaped when the name says .html or .svg, and
/// verbatim otherwise; {{{x}}} is always verbatim. Numbers are written by number_text(), so give numbers that
/// are for people as strings. Throws std::logic_error for an unknown name or a template that does not parse.
std::string render_template(std::string_view name, const Json& data);

}  // namespace bodesmith
