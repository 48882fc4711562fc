#include "schematic/writers/kicad/text.hpp"

#include <fmt/format.h>

#include <map>

#include "base/documents/json.hpp"
#include "base/provenance.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"

namespace bodesmith::kicad {
namespace {

std::string uuid_of(const std::string& what) {
  const std::string h = sha256_hex(what);
  // Version 4, variant 1: the form that readers check.
  return fmt::format("{}-{}-4{}-a{}-{}", h.substr(0, 8), h.substr(8, 4), h.substr(12, 3), h.substr(15, 3),
                     h.substr(18, 12));
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
    } else {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out + '"';
}

std::string mm(double value) {
  return rounded_text(value, 8);
}
std::string mm(int steps) {
  return mm(steps * kGridMm);
}

std::string symbols_text(const std::string& library) {
  return render_template("spice/kicad_symbols.txt", {{"library", library}});
}

/// Counts the identifiers of one sheet.
class Ids {
 public:
  explicit Ids(std::string root) : root_(std::move(root)) {}
  std::string next() { return uuid_of(fmt::format("{}/{}", root_, ++count_)); }

 private:
  std::string root_;
  int count_ = 0;
};

Json label_json(const Label& label, Ids& ids) {
  return {{"text", quoted(label.net)},
          {"x", mm(label.at.x)},
          {"y", mm(label.at.y)},
          {"angle", label.to_left ? "180" : "0"},
          {"justify", label.to_left ? "right" : "left"},
          {"shape", label.kind == Label::Kind::input ? "input" : "output"},
          {"uuid", ids.next()}};
}

Json symbol_json(const Symbol& symbol, const std::string& reference, const std::string& uuid, Ids& ids) {
  const double x = symbol.at.x * kGridMm, y = symbol.at.y * kGridMm;
  Json fields = Json::array();
  const auto field = [&](const std::string& name, const std::string& value, const double* shift,
                         bool hidden) {
    fields.push_back({{"name", quoted(name)},
                      {"value", quoted(value)},
                      {"id", fields.size()},
                      {"x", mm(x + (shift ? shift[0] : 0.0))},
                      {"y", mm(y + (shift ? shift[1] : 0.0))},
                      // Next to a symbol that lies on its side, 90 degrees are a text that can be read.
                      {"angle", symbol.angle == 90 ? "90" : "0"},
                      {"justify", symbol.text_to_right && shift ? " (justify left)" : ""},
                      {"hidden", hidden}});
  };
  field("Reference", reference, symbol.reference_mm, reference.starts_with('#'));
  field("Value", symbol.value, symbol.value_mm, symbol.value_hidden);
  field("Footprint", symbol.footprint, nullptr, true);
  field("Datasheet", "", nullptr, true);
  for (const Field& one : symbol.fields) field(one.name, one.value, nullptr, true);
  Json pins = Json::array();
  for (const std::string& number : symbol.pins) pins.push_back({{"number", number}, {"uuid", ids.next()}});
  return {{"kind", symbol.kind},
          {"x", mm(x)},
          {"y", mm(y)},
          {"angle", std::to_string(symbol.angle)},
          {"mirrored", symbol.mirrored},
          {"unit", symbol.unit},
          {"uuid", uuid},
          {"fields", fields},
          {"pins", pins}};
}

Json box_json(const SheetBox& box, const std::string& uuid, Ids& ids) {
  const int middle = box.at.y + box.height / 2;
  const auto pin = [&](const std::string& name, bool input) -> Json {
    return {{"name", quoted(name)},
            {"shape", input ? "input" : "output"},
            {"x", mm(input ? box.at.x : box.at.x + box.width)},
            {"y", mm(middle)},
            {"angle", input ? "180" : "0"},
            {"justify", input ? "left" : "right"},
            {"uuid", ids.next()}};
  };
  return {{"x", mm(box.at.x)},
          {"y", mm(box.at.y)},
          {"width", mm(box.width)},
          {"height", mm(box.height)},
          {"uuid", uuid},
          {"name", quoted(box.name)},
          {"name_y", mm(box.at.y * kGridMm - 0.7)},
          {"file", quoted(box.file)},
          {"file_y", mm((box.at.y + box.height) * kGridMm + 0.7)},
          {"pins", box.in.empty() ? Json::array() : Json::array({pin(box.in, true), pin(box.out, false)})}};
}

}  // namespace

std::string root_uuid(const std::string& title) {
  return uuid_of(title + "/0");
}

std::string symbol_table_text() {
  return "(sym_lib_table\n  (lib (name \"bodesmith\")(type \"KiCad\")(uri \"${KIPRJMOD}/bodesmith.kicad_sym\")"
         "(options \"\")(descr \"symbols of bodesmith's schematics\"))\n)\n";
}

std::string symbol_library_text() {
  return fmt::format("(kicad_symbol_lib (version 20211014) (generator bodesmith)\n{})\n", symbols_text(""));
}

std::vector<std::string> sheet_texts(const std::vector<Sheet>& sheets, const std::string& title,
                                     const std::string& comment) {
  Json pages = Json::array({{{"path", "/"}, {"page", "1"}}});
  Json instances = Json::array();
  std::map<std::string, int> supplies;
  std::vector<Json> all;
  for (size_t n = 0; n < sheets.size(); ++n) {
    const Sheet& sheet = sheets[n];
    Ids ids(fmt::format("{}/{}", title, n));
    const auto box_uuid = [&](size_t i) { return uuid_of(fmt::format("{}/box {}", title, i)); };
    const std::string path = n == 0 ? "/" : "/" + box_uuid(n - 1) + "/";
    Json data = {{"uuid", n == 0 ? root_uuid(title) : uuid_of(fmt::format("{}/sheet {}", title, n))},
                 {"paper", sheet.paper},
                 {"title", quoted(title)},
                 {"comment", quoted(comment)},
                 {"symbols", symbols_text("bodesmith:")}};
    for (const char* list : {"junctions", "wires", "texts", "labels", "ports", "parts", "sheets"})
      data[list] = Json::array();
    const Joined joined = join_wires(sheet.drawing);
    for (const Point at : joined.junctions)
      data["junctions"].push_back({{"x", mm(at.x)}, {"y", mm(at.y)}, {"uuid", ids.next()}});
    for (const Wire& wire : joined.wires) {
      data["wires"].push_back({{"x1", mm(wire.a.x)},
                               {"y1", mm(wire.a.y)},
                               {"x2", mm(wire.b.x)},
                               {"y2", mm(wire.b.y)},
                               {"uuid", ids.next()}});
    }
    for (const Text& text : sheet.drawing.texts)
      data["texts"].push_back(
          {{"text", quoted(text.text)}, {"x", mm(text.at.x)}, {"y", mm(text.at.y)}, {"uuid", ids.next()}});
    for (const Label& label : sheet.drawing.labels)
      data[label.kind == Label::Kind::local ? "labels" : "ports"].push_back(label_json(label, ids));
    for (const Symbol& symbol : sheet.drawing.symbols) {
      const std::string uuid = ids.next();
      const char* const kind = symbol.kind == "PWR_FLAG" ? "#FLG" : "#PWR";
      const std::string reference =
          symbol.reference.empty() ? fmt::format("{}{:03}", kind, ++supplies[kind]) : symbol.reference;
      data["parts"].push_back(symbol_json(symbol, reference, uuid, ids));
      instances.push_back({{"path", path + uuid},
                           {"reference", quoted(reference)},
                           {"unit", symbol.unit},
                           {"value", quoted(symbol.value)},
                           {"footprint", quoted(symbol.footprint)}});
    }
    for (size_t i = 0; i < sheet.boxes.size(); ++i) {
      data["sheets"].push_back(box_json(sheet.boxes[i], box_uuid(i), ids));
      pages.push_back({{"path", "/" + box_uuid(i)}, {"page", std::to_string(i + 2)}});
    }
    data["root"] = false;
    all.push_back(std::move(data));
  }
  all[0]["root"] = true;
  all[0]["pages"] = pages;
  all[0]["instances"] = instances;
  std::vector<std::string> out;
  for (const Json& data : all) out.push_back(render_template("spice/kicad_sheet.kicad_sch", data));
  return out;
}

}  // namespace bodesmith::kicad
