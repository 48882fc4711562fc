#include <fmt/format.h>

#include <string>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/shared_options.hpp"
#include "project/output/as_model.hpp"

namespace bodesmith::cli {

int run_model(const std::vector<std::string>& arguments) {
  CommandLine line(
      "model", "bodesmith model disturbance.json -o stage.toml",
      "What was designed, built or identified as a model of named blocks, for simulate, compensate and\n"
      "diagnose: sections, a cascade, a circuit as its parts make it, a board's CAMs as they run, a stage, a run's folder. Several files\n"
      "are blocks in series, in their order.");
  line.positional("FILE|DIR...", 1, -1);
  line.option<double>("operating-hz",
                      "frequency at which a stage's rate gains are taken (default: the lowest of its table)");
  add_load_option(line);
  line.output("file for the model");
  if (!line.parse(arguments)) return kDone;
  project::ModelRequest asked;
  if (const auto hz = line.maybe_positive("operating-hz")) asked.operating = Hertz{*hz};
  asked.load_stroke = line.maybe_positive("load-stroke");
  Provenance from;
  chain::Chain model;
  for (const std::string& file : line.files()) {
    const chain::Chain one = project::as_model(file, asked, from);
    model.blocks.insert(model.blocks.end(), one.blocks.begin(), one.blocks.end());
  }
  for (const char* option : {"operating-hz", "load-stroke"}) {
    if (!asked.used && line.has(option))
      line.fail(fmt::format("--{} does nothing with what is asked for here", option));
  }
  std::string text;
  Json blocks = Json::array();
  for (const chain::Block& block : model.blocks) {
    if (const auto error = block.validate()) throw DesignError(block.part + ": " + error->text());
    text += fmt::format("  {:<14} {}\n", block.part, block.type_name());
    blocks.push_back({{"name", block.part}, {"type", block.type_name()}});
  }
  write_file(line.output_path(),
             chain::model_text(model, "made by bodesmith model from " + join(line.files(), ", ")));
  Json json = json_header("model_summary", from);
  json["blocks"] = blocks;
  for (const project::ModelRequest::Board& board : asked.boards) {
    text += fmt::format("  within {} % of the board as its switches make it, {} to {} Hz\n",
                        rounded_text(board.worst_percent, 2), rounded_text(board.band.from.value),
                        rounded_text(board.band.to.value));
    json["boards"].push_back({{"band_hz", {board.band.from.value, board.band.to.value}},
                              {"max_complex_percent", board.worst_percent}});
  }
  return print_summary(line, fmt::format("{} blocks in series\n{}", model.blocks.size(), text), json);
}

}  // namespace bodesmith::cli
