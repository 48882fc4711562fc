#include "spice/ngspice.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "circuit/text.hpp"
#include "spice/user_deck.hpp"

namespace bodesmith::spice {
namespace {

using circuit::plain_number;

namespace fs = std::filesystem;
using Complex = std::complex<double>;

/// The program's path, or empty.
std::string find_ngspice() {
  if (const char* named = std::getenv("BODESMITH_NGSPICE"); named != nullptr) {
    return ::access(named, X_OK) == 0 ? named : "";
  }
  const char* path = std::getenv("PATH");
  if (path == nullptr) return {};
  for (const std::string_view folder : split(path, ':')) {
    const std::string candidate = std::string(folder) + "/ngspice";
    if (::access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return {};
}

/// A folder of its own, removed at the end.
class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (fs::temp_directory_path() / "bodesmith-spice-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw InputError(
          fmt::format("{}: cannot be made, expected a writable folder for temporary files", name));
    }
    path_ = name;
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Starts `program arguments` in `folder` with its output in out.txt and err.txt; its exit status, or -1
/// after a timeout.
int run_program(const std::string& program, const std::vector<std::string>& arguments, const fs::path& folder,
                double timeout_s) {
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const std::string directory = folder.string();
  const std::string out_name = (folder / "out.txt").string(), err_name = (folder / "err.txt").string();
  const pid_t child = ::fork();
  if (child < 0) throw InputError("ngspice cannot be started: no more processes");
  if (child == 0) {
    const int in = ::open("/dev/null", O_RDONLY);
    const int out = ::open(out_name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err = ::open(err_name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (in < 0 || out < 0 || err < 0 || ::chdir(directory.c_str()) != 0) ::_exit(126);
    ::dup2(in, 0);
    ::dup2(out, 1);
    ::dup2(err, 2);
    ::execv(program.c_str(), argv.data());
    ::_exit(127);
  }
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  for (int wait_us = 200;; wait_us = std::min(wait_us * 2, 20000)) {
    int status = 0;
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (std::chrono::steady_clock::now() > deadline) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return -1;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(wait_us));
  }
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

/// The first line that reads like a complaint.
std::string complaint(const std::string& text) {
  for (const std::string_view line : split(text, '\n')) {
    const std::string small = lower(line);
    if (small.find("error") != std::string::npos || small.find("fatal") != std::string::npos ||
        small.find("unknown") != std::string::npos || small.find("can't find") != std::string::npos) {
      return std::string(trim(line));
    }
  }
  return {};
}

struct Ran {
  std::string out;
  std::string err;
};

Ran run_in(const fs::path& folder, const std::string& deck, const std::string& what, double timeout_s) {
  const std::string program = find_ngspice();
  if (program.empty()) {
    throw InputError(
        fmt::format("{}: needs ngspice, which is not installed (Debian: apt-get install ngspice)", what));
  }
  write_file(folder / "deck.cir", deck);
  const int status = run_program(program, {"-n", "-b", "deck.cir"}, folder, timeout_s);
  Ran ran{read_file(folder / "out.txt"), read_file(folder / "err.txt")};
  if (status == -1) {
    throw InputError(fmt::format("{}: ngspice did not finish within {} s", what, rounded_text(timeout_s)));
  }
  if (status != 0) {
    std::string why = complaint(ran.err);
    if (why.empty()) why = complaint(ran.out);
    throw InputError(fmt::format("{}: ngspice ended with {}{}", what, status, why.empty() ? "" : ": " + why));
  }
  return ran;
}

[[noreturn]] void fail_on_output(const std::string& what, const Ran& ran) {
  std::string why = complaint(ran.err);
  if (why.empty()) why = complaint(ran.out);
  throw InputError(fmt::format("{}: ngspice gave no result{}", what,
                               why.empty() ? ", expected a circuit that it can solve" : ": " + why));
}

std::string pick_subcircuit(const std::vector<Subcircuit>& all, const std::string& wanted,
                            const std::string& file) {
  if (!wanted.empty()) {
    for (const Subcircuit& one : all) {
      if (lower(one.name) != lower(wanted)) continue;
      if (one.pins.size() != 2) {
        throw InputError(
            file, one.line,
            fmt::format("subcircuit {} has {} pins, expected two: in out", one.name, one.pins.size()));
      }
      return one.name;
    }
    throw InputError(fmt::format("{}: has no subcircuit {}", file, wanted));
  }
  std::string found;
  for (const Subcircuit& one : all) {
    if (one.pins.size() != 2) continue;
    if (lower(one.name) == "compensator") return one.name;
    found = one.name;
  }
  if (found.empty())
    throw InputError(fmt::format("{}: has no subcircuit with two pins, expected .subckt NAME in out", file));
  return found;
}

/// Solves at every frequency; `head` is the circuit without analysis.
std::vector<Complex> run_ac(const std::string& head, const std::string& node, const std::string& what,
                            const std::vector<Hertz>& grid, const fs::path& folder) {
  const std::string vector = "v(" + node + ")";
  std::string deck = head + "\n.control\nset numdgt=16\nsave " + vector + "\n";
  for (size_t i = 0; i < grid.size(); i += 400) {
    deck += "foreach f";
    for (size_t k = i; k < std::min(grid.size(), i + 400); ++k)
      deck += fmt::format(" {:.17g}", grid[k].value);
    deck += "\nac lin 1 $f $f\nprint " + vector + "\ndestroy all\nend\n";
  }
  deck += "quit 0\n.endc\n.end\n";
  const Ran ran = run_in(folder, deck, what, 60.0 + 0.5 * static_cast<double>(grid.size()));
  std::vector<Complex> out;
  const std::string begin = lower(vector) + " = ";
  for (const std::string_view line : split(ran.out, '\n')) {
    if (!lower(line).starts_with(begin)) continue;
    const auto numbers = split(line.substr(begin.size()), ',');
    double re = 0.0, im = 0.0;
    if (numbers.size() != 2 || !parse_number(trim(numbers[0]), re) || !parse_number(trim(numbers[1]), im))
      continue;
    out.emplace_back(re, im);
  }
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
  const WorkFolder folder;
  std::string full = deck;
  if (!full.ends_with('\n')) full += '\n';
  full += ".control\nset numdgt=15\nset wr_singlescale\n" + analysis + "\nwrdata result.txt";
  for (const std::string& vector : vectors) full += " " + vector;
  full += "\nquit 0\n.endc\n.end\n";
  const Ran ran = run_in(folder.path(), full, what, 600.0);
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

bool ngspice_available() {
  return !find_ngspice().empty();
}

std::string ngspice_version() {
  const std::string program = find_ngspice();
  if (program.empty()) return {};
  const WorkFolder folder;
  if (run_program(program, {"--version"}, folder.path(), 20.0) != 0) return {};
  const std::string text = read_file(folder.path() / "out.txt");
  const size_t at = text.find("ngspice-");
  if (at == std::string::npos) return {};
  return text.substr(at, text.find_first_of(" \n", at) - at);
}

std::string run_ngspice(const std::string& deck, const std::string& what, double timeout_s) {
  const WorkFolder folder;
  return run_in(folder.path(), deck, what, timeout_s).out;
}

std::vector<Subcircuit> list_subcircuits(const std::string& text, const std::string& file) {
  std::vector<Subcircuit> out;
  int depth = 0, number = 0, opened = 0;
  for (const std::string_view raw : split(text, '\n')) {
    ++number;
    std::vector<std::string> words;
    for (const std::string_view word : split(trim(raw), ' ')) {
      if (!trim(word).empty()) words.emplace_back(trim(word));
    }
    if (words.empty()) continue;
    const std::string first = lower(words[0]);
    if (first == ".subckt") {
      if (words.size() < 2)
        throw InputError(file, number, ".subckt without a name, expected .subckt NAME PINS");
      if (depth++ > 0) continue;
      opened = number;
      Subcircuit one{words[1], {}, number};
      for (size_t i = 2; i < words.size(); ++i) {
        if (lower(words[i]) == "params:" || words[i].find('=') != std::string::npos) break;
        one.pins.push_back(words[i]);
      }
      out.push_back(std::move(one));
    } else if (first == ".ends") {
      if (depth-- == 0) throw InputError(file, number, ".ends without .subckt");
    }
  }
  if (depth > 0) throw InputError(file, opened, ".subckt is not ended, expected .ends");
  return out;
}

std::vector<Complex> run_ac_of_sub(const fs::path& library, const std::vector<Hertz>& grid,
                                   const std::string& subcircuit) {
  const std::string text = read_file(library);
  const std::string name =
      pick_subcircuit(list_subcircuits(text, library.string()), subcircuit, library.string());
  const WorkFolder folder;
  return run_ac(library_head("\"" + fs::absolute(library).string() + "\"", name), "out", library.string(),
                grid, folder.path());
}

std::vector<Complex> run_ac_of_text(const std::string& library, const std::string& name,
                                    const std::vector<Hertz>& grid, const std::string& subcircuit) {
  const std::string top = pick_subcircuit(list_subcircuits(library, name), subcircuit, name);
  const WorkFolder folder;
  write_file(folder.path() / "library.sub", library);
  return run_ac(library_head("library.sub", top), "out", name, grid, folder.path());
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

Transient run_transient(const std::string& deck, const std::vector<std::string>& nodes, double step_s,
                        double stop_s, const std::string& what) {
  const Columns columns = run_columns(
      deck, fmt::format("tran {} {} 0 {}", plain_number(step_s), plain_number(stop_s), plain_number(step_s)),
      voltages(nodes), what);
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

}  // namespace bodesmith::spice
