#include "measured/measured.hpp"

#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "project/run.hpp"
#include "report/plot.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::measured {
namespace {
namespace fs = std::filesystem;

/// Whether the folder holds a finished run; throws for one of another project file: it was not built from this one.
bool holds_run_of(const project::ProjectSource& source, const fs::path& folder) {
  const fs::path file = folder / "run.json";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;
  const Node run = parse_json(read_file(file), file.string());
  run.expect_schema("run");
  for (const Node& input : run.at("inputs").items()) {
    if (input.at("sha256").string() == source.from.inputs.front().sha256) return true;
  }
  throw InputError(file.string(), 0,
                   fmt::format("is of another project than {} as it stands now, expected the folder that the "
                               "hardware was built from, or a new one",
                               source.file.string()));
}

bool is_response(const fs::path& data) {
  Provenance aside;
  return Csv::read(data, aside).has(column::frequency_hz);
}

}  // namespace

Json Measured::json() const {
  Json out;
  out["measured"] = file;
  out["of"] = of;
  out["gap_percent"] = {{"before", gap_percent}, {"with_what_was_found", left_percent}};
  out["noise_percent"] = noise_percent > 0.0 ? Json(noise_percent) : Json(nullptr);
  out["verdict"] = verdict;
  out["found"] = found;
  out["tied"] = tied;
  out["advice"] = advice;
  out["next"] = nullptr;
  if (wrong()) {
    out["next"] = {{"folder", "next"}, {"what", next}};
    if (!next_name.empty())
      out["next"][next_name] = {{"before", before_percent}, {"predicted", after_percent}};
  }
  out["files"] = Json::array();
  for (const fs::path& path : files) out["files"].push_back(path.string());
  out["timing_s"] = {{"compute", compute_s}};
  return out;
}

std::string Measured::summary(const fs::path& folder) const {
  std::string out = fmt::format("measured   {}, of {}: {} % rms from its prediction", file, of,
                                rounded_text(gap_percent, 3));
  out += noise_percent > 0.0 ? fmt::format(" (noise {} %)\n", rounded_text(noise_percent, 2)) : "\n";
  if (!wrong())
    out += verdict == "unexplained" || verdict == "partly_explained"
               ? "found      something is wrong, and it has no name here\n"
               : "found      nothing is wrong\n";
  for (const std::string& one : found) out += "found      " + one + "\n";
  if (wrong()) out += fmt::format("left       {} % rms with that\n", rounded_text(left_percent, 3));
  for (const std::string& one : next) out += "next       " + one + "\n";
  if (!advice.empty()) out += "advice     " + advice + "\n";
  out += fmt::format("look at    {}\n", (folder / "measured" / "report.html").string());
  if (wrong()) out += fmt::format("           {}\n", (folder / "next" / "gap.svg").string());
  return out;
}

std::string GapPicture::svg() const {
  using report::Series;
  const auto plot = [&](const std::string& title, const Series& first, const Series& second) {
    report::Plot out;
    out.title = title;
    out.x = {x_label, logarithmic};
    out.y = {"%"};
    out.series = {first, second};
    return out;
  };
  std::vector<report::Plot> all = {
      plot("Measured less predicted", {"as it was designed", x, gap}, {"with what was found", x, left})};
  if (!before.empty()) all.push_back(plot(what, {"measured", x, before}, {"predicted of next/", x, after}));
  return report::stack_svg(all);
}

Measured run_measured(const project::ProjectSource& source, const fs::path& data, const fs::path& folder,
                      const gap::SearchOptions& options) {
  const bool response = is_response(data);  // bad data is said before a long run
  if (!holds_run_of(source, folder)) project::run_project(source, folder);
  const Stopwatch watch;
  OutputSet measured, next;
  Measured out = response ? measured_response(data, folder, options, measured, next)
                          : measured_record(source, data, folder, options, measured, next);
  out.file = data.string();
  out.compute_s = watch.seconds();
  OutputSet all(folder);
  all.include("measured", measured);
  all.include("next", next);
  out.files = all.paths();
  out.files.emplace_back("measured/measured.json");
  Json json = json_header("measured", out.from);
  json.update(out.json());
  all.add("measured/measured.json", to_text(json));
  all.commit();
  return out;
}

}  // namespace bodesmith::measured
