#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <numbers>
#include <string>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/load_option.hpp"
#include "cli/plan_blocks.hpp"

namespace bodesmith::cli {
namespace {
namespace fs = std::filesystem;

using chain::Block;
using chain::chain_of;
using chain::make_block;
using chain::stage_block;

std::vector<Block> from_sections(const Node& node, const CommandLine&) {
  return chain_of(Sections::from_node(node), "Section").blocks;
}

std::vector<Block> from_cascade(const Node& node, const CommandLine&) {
  return chain_of(Cascade::from_node(node)).blocks;
}

/// The stages with the parts they have.
std::vector<Block> from_circuit(const Node& node, const CommandLine&) {
  std::vector<Block> out;
  int number = 1;
  for (const Node& stage : node.at("stages").items()) {
    const Node made = stage.at("realised");
    Sections one;
    Section section;
    section.gain = made.at("gain").number();
    const auto roots = [&](const char* key) {
      std::vector<std::complex<double>> list;
      for (const Node& root : made.at(key).items()) {
        const std::vector<double> parts = root.numbers();
        if (parts.size() != 2) root.fail("is no root, expected [real, imaginary]");
        list.emplace_back(parts[0], parts[1]);
      }
      return list;
    };
    section.zeros = roots("zeros_rad_s");
    section.poles = roots("poles_rad_s");
    if (section.poles.empty() || section.poles.size() > 2)
      stage.fail(
          fmt::format("has {} poles, expected one or two: a ladder is no block", section.poles.size()));
    one.sections = {section};
    const std::string name = fmt::format("Stage{}", number);
    for (Block block : chain_of(one, name).blocks) {
      // Its one section is the stage: "Stage3" instead of "Stage31".
      if (block.part.starts_with(name + "1")) block.part.erase(name.size(), 1);
      out.push_back(std::move(block));
    }
    ++number;
  }
  return out;
}

Block lag_block(const std::string& kind, double seconds) {
  Block out = kind == "delay"
                  ? make_block("delay").set("delay_s", seconds)
                  : make_block("lowpass").set("corner_hz", 1.0 / (2.0 * std::numbers::pi * seconds));
  out.part = kind == "pole in front of the stage" ? "amplifier" : kind == "delay" ? "delay" : "sensor";
  return out;
}

Block scale_block(const char* name, double gain, double offset) {
  Block out = make_block("gain").set("gain", gain).set("offset", offset);
  out.part = name;
  return out;
}

/// The stage; with what identify found of its drive, output and lag where the file says so.
std::vector<Block> from_disturbance(const Node& node, const CommandLine& line) {
  const Disturbance disturbance = under_load(line, Disturbance::from_node(node));
  const double base = disturbance.rate.frequency.empty() ? 0.0 : disturbance.rate.frequency.front().value;
  const Block stage = stage_block(disturbance, Hertz{line.maybe_positive("operating-hz").value_or(base)});
  if (!node.has("identified")) return {stage};
  const Node found = node.at("identified");
  const double low = found.at("input").at("low").number();
  const double high = found.at("input").at("high").number();
  if (!(high > low)) found.at("input").at("high").fail("is not above low");
  // Under a load the same drive makes a shorter stroke.
  const double left = line.maybe_positive("load-stroke").value_or(1.0);
  std::vector<Block> out = {scale_block("drive", 1.0 / (high - low), -low / (high - low)), stage,
                            scale_block("output", left * found.at("output").at("stroke").number(),
                                        found.at("output").at("offset").number())};
  const std::string kind = found.at("lag").at("kind").string();
  const double seconds = found.at("lag").at("lag_s").number();
  if (seconds > 0.0) {
    // The drive's scale has no offset behind a lag: in front of the stage it stands behind the scale.
    const Block lag = lag_block(kind, seconds);
    out.insert(lag.part == "amplifier" ? out.begin() + 1 : out.end(), lag);
  }
  return out;
}

std::vector<Block> from_plan(const Node& node, const CommandLine&) {
  return plan_blocks(node);
}

using Reader = std::vector<Block> (*)(const Node&, const CommandLine&);

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all = {{"bodesmith.sections/1", from_sections},
                                                    {"bodesmith.cascade/1", from_cascade},
                                                    {"bodesmith.circuit/1", from_circuit},
                                                    {"bodesmith.fpaa_plan/1", from_plan},
                                                    {"bodesmith.disturbance/1", from_disturbance}};
  return all;
}

/// A file, or of a folder that `run` wrote its model.toml.
chain::Chain made_of(const std::string& given, const CommandLine& line, Provenance& from) {
  const fs::path path = given;
  if (fs::is_directory(path)) {
    if (!fs::exists(path / "model.toml"))
      throw InputError(given, 0, "has no model.toml, expected a folder that bodesmith run wrote");
    return chain::read_model(path / "model.toml", from);
  }
  const Node node = read_document(path, from);
  const std::string schema = node.at("schema").string();
  if (schema == "bodesmith.model/1") return chain::model_from_node(node);
  const auto reader = readers().find(schema);
  if (reader == readers().end())
    node.at("schema").fail(fmt::format(
        "is '{}', expected bodesmith.sections/1, cascade/1, circuit/1, fpaa_plan/1, disturbance/1 or model/1, or a run's "
        "folder",
        schema));
  chain::Chain out;
  out.blocks = reader->second(node, line);
  return out;
}

}  // namespace

int run_model(const std::vector<std::string>& arguments) {
  CommandLine line(
      "model", "bodesmith model disturbance.json -o stage.toml",
      "What was designed, built or identified as a model of named blocks, for simulate, compensate and\n"
      "diagnose: sections, a cascade, a circuit as its parts make it, a board's CAMs, a stage, a run's folder. Several files\n"
      "are blocks in series, in their order.");
  line.positional("FILE|DIR...", 1, -1);
  line.option<double>("operating-hz",
                      "frequency at which a stage's rate gains are taken (default: the lowest of its table)");
  add_load_option(line);
  line.output("file for the model");
  if (!line.parse(arguments)) return kDone;
  Provenance from;
  chain::Chain model;
  for (const std::string& file : line.files()) {
    chain::Chain one = made_of(file, line, from);
    model.blocks.insert(model.blocks.end(), one.blocks.begin(), one.blocks.end());
  }
  std::string text;
  Json blocks = Json::array();
  for (const Block& block : model.blocks) {
    if (const auto error = block.validate()) throw DesignError(block.part + ": " + error->text());
    text += fmt::format("  {:<14} {}\n", block.part, block.type_name());
    blocks.push_back({{"name", block.part}, {"type", block.type_name()}});
  }
  write_file(line.output_path(),
             chain::model_text(model, "made by bodesmith model from " + join(line.files(), ", ")));
  Json json = json_header("model_summary", from);
  json["blocks"] = blocks;
  return print_summary(line, fmt::format("{} blocks in series\n{}", model.blocks.size(), text), json);
}

}  // namespace bodesmith::cli
