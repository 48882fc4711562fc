#include "project/sweep/sweep.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "project/run.hpp"
#include "project/sweep/variants.hpp"

namespace bodesmith::project {
namespace {
namespace fs = std::filesystem;

using Status = SweptVariant::Status;

constexpr const char* kOutcome = "variant.json";

std::vector<std::string> changed_keys(const std::vector<Variant>& variants) {
  std::vector<std::string> out;
  const auto add = [&out](const std::string& key) {
    if (std::ranges::find(out, key) == out.end()) out.push_back(key);
  };
  for (const Variant& variant : variants) {
    for (const auto& [key, value] : variant.set) add(key);
    for (const auto& [key, value] : variant.removed) add(key);
  }
  return out;
}

Json outcome_json(const Variant& variant, const SweptVariant& outcome, const Provenance& from) {
  Json out = json_header("variant", from);
  out["name"] = variant.name;
  out["changes"] = variant.what();
  out["status"] = to_string(outcome.status);
  if (!outcome.message.empty()) out["message"] = outcome.message;
  out["figures"] = Json::object();
  for (const auto& [key, value] : outcome.figures) out["figures"][key] = value;
  out["timing_s"] = {{"compute", outcome.compute_s}};
  return out;
}

void run_variant(const ProjectSource& source, const Variant& variant, const fs::path& folder) {
  const Stopwatch watch;
  SweptVariant outcome;
  Provenance from = source.from;
  try {
    const Run run = run_project(source, folder);
    from = run.from;
    outcome.status = run.limits_met() ? Status::done : Status::limit_missed;
    outcome.figures = run.figures();
  } catch (const InputError& error) {
    // One design that cannot be made is a result of the sweep, not its end.
    outcome.status = Status::refused;
    outcome.message = error.what();
  }
  outcome.compute_s = watch.seconds();
  write_file(folder / kOutcome, to_text(outcome_json(variant, outcome, from)));
}

/// The outcome that stands in a variant's folder, when it is of these changes and its files are as they were then.
std::optional<SweptVariant> outcome_in(const fs::path& folder, const Variant& variant, bool check_files) {
  const fs::path file = folder / kOutcome;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  const Node node = parse_json(read_file(file), file.string());
  node.expect_schema("variant");
  if (node.at("changes").string() != variant.what()) return std::nullopt;
  if (check_files) {
    const Json now = json_header("variant", {});
    if (node.at("program").string() != now["program"].get<std::string>()) return std::nullopt;
    for (const Node& input : node.at("inputs").items()) {
      const fs::path path = input.at("path").string();
      if (path == variant.at.file()) continue;  // what it says of this variant is compared above
      if (!fs::is_regular_file(path, ignored) || sha256_hex(read_file(path)) != input.at("sha256").string())
        return std::nullopt;
    }
  }
  SweptVariant out;
  out.status = one_of(node.at("status"), Status::done, Status::limit_missed, Status::refused);
  if (node.has("message")) out.message = node.at("message").text();
  for (const auto& [key, value] : node.at("figures").members()) out.figures.emplace_back(key, value.number());
  out.compute_s = node.at("timing_s").at("compute").number();
  return out;
}

/// Whether an earlier sweep finished it; a damaged outcome is none.
bool is_finished(const fs::path& folder, const Variant& variant) {
  try {
    return outcome_in(folder, variant, true).has_value();
  } catch (const InputError&) {
    return false;
  }
}

/// The process's own variants; which of them an earlier sweep had finished.
std::vector<std::uint64_t> run_own(const std::vector<Variant>& variants,
                                   const std::vector<ProjectSource>& sources, const fs::path& folder,
                                   const SweepOptions& options, const Team& team) {
  std::vector<std::uint64_t> kept(variants.size(), 0);
  Progress progress("sweep");
  const auto size = static_cast<std::size_t>(team.size());
  for (auto i = static_cast<std::size_t>(team.rank()); i < variants.size(); i += size) {
    stop_if_interrupted();
    const fs::path place = folder / variants[i].name;
    const auto so_far = [&](double fraction) {
      if (team.leads())
        progress.at((static_cast<double>(i) + fraction) / static_cast<double>(variants.size()));
    };
    const ProgressListener listener(so_far);
    if (options.resume && is_finished(place, variants[i])) {
      kept[i] = 1;
    } else {
      run_variant(sources[i], variants[i], place);
    }
    so_far(1.0);
  }
  return kept;
}

}  // namespace

std::string_view to_string(SweptVariant::Status status) {
  constexpr std::array kWords = {"done", "limit_missed", "refused"};
  return kWords.at(static_cast<std::size_t>(status));
}

bool Sweep::limits_met() const {
  return std::ranges::all_of(variants,
                             [](const SweptVariant& variant) { return variant.status == Status::done; });
}

Sweep run_sweep(const fs::path& project, const fs::path& variants_file, const fs::path& folder,
                const SweepOptions& options, const Team& team) {
  const Stopwatch watch;
  ProjectSource source = ProjectSource::read(project);
  const std::vector<Variant> variants = read_variants(variants_file, source.from);
  std::vector<ProjectSource> sources;
  for (const Variant& variant : variants) {
    sources.push_back(with_variant(source, variant));
    Provenance aside;
    sources.back().project(aside);  // what is wrong in it is said before hours of work
  }
  std::vector<std::uint64_t> kept = run_own(variants, sources, folder, options, team);
  team.sum(kept);  // the leader goes on when all are here
  Sweep out;
  if (!team.leads()) return out;
  out.project = source.document.string_or("name", project.stem().string());
  out.from = source.from;
  out.keys = changed_keys(variants);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    auto outcome = outcome_in(folder / variants[i].name, variants[i], false);
    if (!outcome)
      throw InputError((folder / variants[i].name / kOutcome).string() +
                       " is not there, expected a folder that all processes share");
    outcome->name = variants[i].name;
    outcome->what = variants[i].what();
    outcome->kept = kept[i] != 0;
    for (const std::string& key : out.keys) outcome->values.push_back(variants[i].value_of(key));
    out.variants.push_back(std::move(*outcome));
  }
  out.compute_s = watch.seconds();
  OutputSet files(folder);
  Json json = json_header("sweep", out.from);
  json.update(sweep_json(out));
  files.add("sweep.json", to_text(json));
  files.add("sweep.csv", sweep_csv(out));
  files.commit();
  return out;
}

}  // namespace bodesmith::project
