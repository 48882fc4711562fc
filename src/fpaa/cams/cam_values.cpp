#include "fpaa/cams/cam_values.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith::fpaa {

std::optional<double> CamValues::Entry::number() const {
  if (const double* number = std::get_if<double>(&value)) return *number;
  return std::nullopt;
}

void CamValues::set(std::string key, std::variant<double, std::string> value) {
  for (Entry& entry : entries_) {
    if (entry.key != key) continue;
    entry.value = std::move(value);
    return;
  }
  entries_.push_back({std::move(key), std::move(value)});
}

std::optional<double> CamValues::number(std::string_view key) const {
  const Entry* entry = find(key);
  return entry == nullptr ? std::nullopt : entry->number();
}

double CamValues::required_number(std::string_view key) const {
  if (const auto value = number(key)) return *value;
  throw InputError(fmt::format("a CAM has no number '{}' among its parameters", key));
}

std::string_view CamValues::text(std::string_view key) const {
  const Entry* entry = find(key);
  const std::string* text = entry == nullptr ? nullptr : std::get_if<std::string>(&entry->value);
  return text == nullptr ? std::string_view{} : std::string_view(*text);
}

Json CamValues::to_json() const {
  Json out = Json::object();
  for (const Entry& entry : entries_) {
    std::visit([&](const auto& value) { out[entry.key] = value; }, entry.value);
  }
  return out;
}

CamValues CamValues::from_node(const Node& node) {
  CamValues out;
  for (const auto& [key, value] : node.members()) {
    if (value.kind() == Node::Kind::string) {
      out.set(key, value.string());
    } else {
      out.set(key, value.number());
    }
  }
  return out;
}

const CamValues::Entry* CamValues::find(std::string_view key) const {
  const auto at = std::ranges::find(entries_, key, &Entry::key);
  return at == entries_.end() ? nullptr : &*at;
}

}  // namespace bodesmith::fpaa
