#include "base/text_template.hpp"

#include <kainjow/mustache.hpp>
#include <stdexcept>

#include "base/documents/json.hpp"
#include "base/text.hpp"

namespace bodesmith {
namespace {

namespace km = kainjow::mustache;

km::data to_data(const Json& value) {
  if (value.is_object()) {
    km::data out = km::data::type::object;
    for (const auto& [key, item] : value.items()) out.set(key, to_data(item));
    return out;
  }
  if (value.is_array()) {
    km::data out = km::data::type::list;
    for (const auto& item : value) out.push_back(to_data(item));
    return out;
  }
  if (value.is_boolean()) return km::data(value.get<bool>());
  if (value.is_null()) return km::data(false);
  if (value.is_string()) return km::data(value.get<std::string>());
  if (value.is_number_float()) return km::data(number_text(value.get<double>()));
  return km::data(value.dump());
}

}  // namespace

std::string render_template(std::string_view name, const Json& data) {
  for (const EmbeddedTemplate& entry : embedded_templates()) {
    if (entry.name != name) continue;
    km::mustache engine{std::string(entry.text)};
    if (!engine.is_valid()) {
      throw std::logic_error("templates/" + std::string(name) + ": " + engine.error_message());
    }
    const bool html =
        name.find(".html") != std::string_view::npos || name.find(".svg") != std::string_view::npos;
    if (!html) engine.set_custom_escape([](const std::string& text) { return text; });
    return engine.render(to_data(data));
  }
  throw std::logic_error("no template named " + std::string(name));
}

}  // namespace bodesmith
