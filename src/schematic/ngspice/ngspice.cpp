#include "schematic/ngspice/ngspice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "schematic/ngspice/user_deck.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::ngspice {
namespace {

using schematic::plain_number;
namespace fs = std::filesystem;

/// The commands that solve at every frequency. An analysis finds the operating point anew, which takes far longer than a
/// frequency does: two neighbours share one, `lin 3`, whose middle nobody reads (`lin 2` stops at its first).
std::string ac_commands(const std::vector<Hertz>& grid, const std::string& vector) {
  std::string out;
  for (size_t i = 0; i < grid.size(); ++i) {
    const bool two = i + 1 < grid.size() && grid[i + 1].value > grid[i].value;
    const Hertz first = grid[i], last = grid[two ? ++i : i];
    out += fmt::format("ac lin {} {:.17g} {:.17g}\nprint {}\ndestroy all\n", two ? 3 : 1, first.value,
                       last.value, vector);
  }
  return out;
}

/// "re,im" or, in a table, "re,<tab>im"; other text is passed over.
void parse_complex(std::string_view text, std::vector<Complex>& to) {
  const auto numbers = split(text, ',');
  double re = 0.0, im = 0.0;
  if (numbers.size() == 2 && parse_number(trim(numbers[0]), re) && parse_number(trim(numbers[1]), im))
    to.emplace_back(re, im);
}

/// What `print` wrote: "v(out) = re,im" of one frequency, rows "index<tab>frequency<tab>re,<tab>im" of more.
std::vector<Complex> printed_values(const std::string& text, const std::string& vector) {
  std::vector<Complex> out;
  const std::string begin = lower_case(vector) + " = ";
  for (const std::string_view line : split(text, '\n')) {
    if (lower_case(line).starts_with(begin)) {
      parse_complex(line.substr(begin.size()), out);
    } else if (line.starts_with("0\t") || line.starts_with("2\t")) {
      const size_t value = line.find('\t', 2);
      if (value != std::string_view::npos) parse_complex(trim(line.substr(value)), out);
    }
  }
  return out;
}

/// Solves at every frequency; `head` is the circuit without analysis.
std::vector<Complex> run_ac(const std::string& head, const std::string& node, const std::string& what,
                            const std::vector<Hertz>& grid, const fs::path& folder) {
  require_no_commands(head, what);
  require_plain_node(node, what);
  const std::string vector = "v(" + node + ")";
  const std::string deck = head + "\n.control\nset numdgt=16\nsave " + vector + "\n" +
                           ac_commands(grid, vector) + "quit 0\n.endc\n.end\n";
  const NgspiceOutput ran = run_ngspice_in(folder, deck, what, 60.0 + 0.5 * static_cast<double>(grid.size()));
  std::vector<Complex> out = printed_values(ran.out, vector);
  if (out.size() != grid.size()) fail_on_output(what, ran);
  return out;
}

std::string library_head(const std::string& include, const std::string& subcircuit) {
  return "response of a subcircuit\n.include " + include + "\nVbodesmith in 0 dc 0 ac 1\nXbodesmith in out " +
         subcircuit;
}

struct Columns {
  std::vector<double> first;
  std::vector<std::vector<double>> rest;
};

/// Runs one analysis and reads back its sweep variable and the nodes' voltages.
Columns run_columns(const std::string& deck, const std::string& analysis,
                    const std::vector<std::string>& vectors, const std::string& what) {
  require_no_commands(deck, what);
  const WorkFolder folder;
  std::string full = deck;
  if (!full.ends_with('\n')) full += '\n';
  full += ".control\nset numdgt=15\nset wr_singlescale\n" + analysis + "\nwrdata result.txt";
  for (const std::string& vector : vectors) full += " " + vector;
  full += "\nquit 0\n.endc\n.end\n";
  const NgspiceOutput ran = run_ngspice_in(folder.path(), full, what, 600.0);
  const fs::path result = folder.path() / "result.txt";
  if (!fs::exists(result)) fail_on_output(what, ran);
  Columns out;
  out.rest.resize(vectors.size());
  const std::string text = read_file(result);
  for (const std::string_view line : split(text, '\n')) {
    std::vector<double> row;
    for (const std::string_view word : split(trim(line), ' ')) {
      double value = 0.0;
      if (!trim(word).empty() && parse_number(trim(word), value)) row.push_back(value);
    }
    if (row.size() != vectors.size() + 1) continue;
    out.first.push_back(row[0]);
    for (size_t i = 0; i < vectors.size(); ++i) out.rest[i].push_back(row[i + 1]);
  }
  if (out.first.empty()) fail_on_output(what, ran);
  return out;
}

std::vector<std::string> voltages(const std::vector<std::string>& nodes) {
  std::vector<std::string> out;
  for (const std::string& node : nodes) out.push_back("v(" + node + ")");
  return out;
}

}  // namespace

std::vector<Complex> run_ac_of_sub(const fs::path& library, const std::vector<Hertz>& grid,
                                   const std::string& subcircuit) {
  const std::string text = read_file(library);
  require_plain_netlist(text, library);
  if (library.string().find_first_of("\"\n\r") != std::string::npos)
    throw InputError(fmt::format("{}: has a name that ngspice cannot be told, expected one without quotes",
                                 library.string()));
  const std::string name =
      pick_subcircuit(list_subcircuits(text, library.string()), subcircuit, library.string());
  const WorkFolder folder;
  return run_ac(library_head("\"" + fs::absolute(library).string() + "\"", name), "out", library.string(),
                grid, folder.path());
}

std::vector<Complex> run_ac_of_text(const std::string& library, const std::string& name,
                                    const std::vector<Hertz>& grid, const std::string& subcircuit) {
  require_plain_text(library, name);
  const std::string top = pick_subcircuit(list_subcircuits(library, name), subcircuit, name);
  const WorkFolder folder;
  write_file(folder.path() / "library.sub", library);
  return run_ac(library_head("library.sub", top), "out", name, grid, folder.path());
}

std::vector<Complex> run_ac_of_circuit(const std::string& deck, const std::string& node,
                                       const std::vector<Hertz>& grid, const std::string& what) {
  const WorkFolder folder;
  return run_ac(deck, node, what, grid, folder.path());
}

std::vector<Complex> run_ac_of_deck(const fs::path& path, const std::vector<Hertz>& grid,
                                    const std::string& node) {
  const UserDeck deck = read_user_deck(path, node);
  const WorkFolder folder;
  std::vector<Complex> out = run_ac(deck.text, deck.node, path.string(), grid, folder.path());
  for (Complex& h : out) h /= deck.source;
  return out;
}

DcSweep run_dc(const std::string& deck, const std::string& source, double from, double to, double step,
               const std::vector<std::string>& nodes, const std::string& what) {
  const Columns columns = run_columns(
      deck, fmt::format("dc {} {} {} {}", source, plain_number(from), plain_number(to), plain_number(step)),
      voltages(nodes), what);
  return {columns.first, columns.rest};
}

double Transient::at(std::size_t node, double t, std::size_t& place) const {
  if (time_s[place - 1] > t) place = 1;
  while (place + 1 < time_s.size() && time_s[place] < t) ++place;
  const double before = time_s[place - 1], part = (t - before) / (time_s[place] - before);
  return std::lerp(v[node][place - 1], v[node][place], std::clamp(part, 0.0, 1.0));
}

Transient run_transient(const std::string& deck, const std::vector<std::string>& nodes, double step_s,
                        double stop_s, const std::string& what) {
  const std::vector<std::string> wanted = voltages(nodes);
  // Nothing but what is read back is kept of every step.
  const Columns columns =
      run_columns(deck,
                  fmt::format("save {}\ntran {} {} 0 {}", fmt::join(wanted, " "), plain_number(step_s),
                              plain_number(stop_s), plain_number(step_s)),
                  wanted, what);
  if (columns.first.back() < stop_s * (1.0 - 1e-6)) {
    throw InputError(fmt::format("{}: ngspice stopped at {} s, expected {} s", what,
                                 rounded_text(columns.first.back()), rounded_text(stop_s)));
  }
  return {columns.first, columns.rest};
}

NoiseSpectrum run_noise_of_text(const std::string& library, Band band, int per_decade,
                                const std::string& what) {
  const std::string deck = "noise\n" + library + "Vin in 0 dc 0 ac 1\nXc in out compensator\n";
  const Columns columns = run_columns(deck,
                                      fmt::format("noise v(out) Vin dec {} {} {}\nsetplot noise1", per_decade,
                                                  plain_number(band.from.value), plain_number(band.to.value)),
                                      {"onoise_spectrum"}, what);
  NoiseSpectrum out;
  for (const double f : columns.first) out.grid.push_back(Hertz{f});
  out.v_per_rthz = columns.rest[0];
  return out;
}

}  // namespace bodesmith::ngspice
