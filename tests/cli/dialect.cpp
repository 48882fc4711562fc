#include "dialect.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "base/files.hpp"

namespace bodesmith {
namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// 1, 1.5, -2e-9: digits and an exponent, nothing behind it.
bool plain_number(const std::string& text) {
  size_t i = 0;
  const auto digits = [&] {
    const size_t from = i;
    while (i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0) ++i;
    return i - from;
  };
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
  size_t count = digits();
  if (i < text.size() && text[i] == '.') {
    ++i;
    count += digits();
  }
  if (count == 0) return false;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
    if (digits() == 0) return false;
  }
  return i == text.size();
}

/// Expressions: sums of products of numbers, v(node), known names, min, max, tanh, mc, parentheses; ?:
/// outside.
class ExpressionReader {
 public:
  ExpressionReader(std::string text, const std::set<std::string>& names, bool mc)
      : text_(std::move(text)), names_(names), mc_(mc) {}
  std::string error_text() {
    ternary();
    skip();
    if (problem_.empty() && at_ != text_.size()) problem_ = "unexpected '" + text_.substr(at_) + "'";
    return problem_;
  }
  const std::set<std::string>& nodes() const { return nodes_; }

 private:
  void skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    skip();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void want(char c) {
    if (!take(c) && problem_.empty())
      problem_ = std::string("expected '") + c + "' before '" + text_.substr(at_) + "'";
  }
  void ternary() {
    sum();
    skip();
    if (at_ < text_.size() && (text_[at_] == '<' || text_[at_] == '>')) {
      ++at_;
      sum();
    }
    if (take('?')) {
      ternary();
      want(':');
      ternary();
    }
  }
  void sum() {
    product();
    while (problem_.empty() && (take('+') || take('-'))) product();
  }
  void product() {
    factor();
    while (problem_.empty()) {
      if (take('*')) {
        if (at_ < text_.size() && text_[at_] == '*') problem_ = "'**' means |x| to a power in ngspice";
      } else if (!take('/')) {
        break;
      }
      factor();
    }
  }
  void factor() {
    skip();
    if (!problem_.empty()) return;
    if (take('-') || take('+')) return factor();
    if (take('(')) {
      ternary();
      want(')');
      return;
    }
    size_t end = at_;
    const auto word = [&](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
    };
    while (end < text_.size() &&
           (word(text_[end]) ||
            ((text_[end] == '-' || text_[end] == '+') && end > at_ && std::tolower(text_[end - 1]) == 'e' &&
             std::isdigit(static_cast<unsigned char>(text_[at_])) != 0)))
      ++end;
    const std::string token = text_.substr(at_, end - at_);
    at_ = end;
    if (token.empty()) {
      problem_ = "expected a value before '" + text_.substr(at_) + "'";
    } else if (std::isdigit(static_cast<unsigned char>(token[0])) != 0 || token[0] == '.') {
      if (!plain_number(token)) problem_ = "'" + token + "' is not a plain number";
    } else if (lower(token) == "v") {
      want('(');
      size_t close = text_.find(')', at_);
      if (close == std::string::npos) close = text_.size();
      const std::string node = text_.substr(at_, close - at_);
      if (node.empty() || !std::all_of(node.begin(), node.end(), word))
        problem_ = "v(" + node + ") is not one node";
      nodes_.insert(lower(node));
      at_ = close;
      want(')');
    } else if (const std::map<std::string, int> functions = {{"min", 2}, {"max", 2}, {"tanh", 1}, {"mc", 2}};
               functions.contains(lower(token)) && (lower(token) != "mc" || mc_)) {
      want('(');
      ternary();
      for (int i = 1; i < functions.at(lower(token)); ++i) {
        want(',');
        ternary();
      }
      want(')');
    } else if (!names_.contains(lower(token))) {
      problem_ = "'" + token + "' is not among what all simulators read alike";
    }
  }

  std::string text_;
  const std::set<std::string>& names_;
  bool mc_;
  size_t at_ = 0;
  std::string problem_;
  std::set<std::string> nodes_;
};

class DeckReader {
 public:
  explicit DeckReader(Dialect dialect, bool every) : dialect_(dialect), every_(every) {}

  void read(const std::filesystem::path& path, bool top) {
    if (!std::filesystem::exists(path)) {
      errors.push_back(path.filename().string() + " is not there");
      return;
    }
    std::istringstream text(read_file(path));
    std::string raw;
    int number = 0;
    bool ended = false;
    while (std::getline(text, raw)) {
      ++number;
      where_ = path.filename().string() + ":" + std::to_string(number);
      if (raw.size() > 2000) report("a line of more than 2000 characters");
      if (raw.find('\r') != std::string::npos || raw.find('\t') != std::string::npos)
        report("tab or carriage return");
      for (const char c : raw) {
        if ((static_cast<unsigned char>(c) & 0x80U) != 0) {
          report("a character that is not ASCII");
          break;
        }
      }
      if (top && number == 1) {
        if (raw.empty() || raw[0] == '.') report("the first line is not a title");
        continue;
      }
      if (raw.empty() || raw[0] == '*') continue;
      if (ended) report("something behind .end");
      const std::string line = lower(raw);
      if (control_) {
        if (line == ".endc") control_ = false;
        continue;
      }
      if (line == ".end") {
        ended = true;
        if (!top) report(".end in a library");
      } else if (line[0] == '.') {
        command(line, raw, path, top);
      } else {
        element(line);
      }
    }
    if (top) {
      if (!ended) errors.push_back("no .end");
      if (control_) errors.push_back("no .endc");
      if (analyses_ != 1) errors.push_back(std::to_string(analyses_) + " analyses, expected one");
    }
    if (!inside_.empty()) errors.push_back(".subckt " + inside_ + " is not closed");
  }

  void finish() {
    for (const auto& [where, name, pins] : calls_) {
      if (!pins_.contains(name)) {
        errors.push_back(where + ": " + name + " is not defined");
      } else if (pins_.at(name) != pins) {
        errors.push_back(where + ": " + name + " has " + std::to_string(pins_.at(name)) + " pins");
      }
    }
    for (const auto& [where, model] : models_used_) {
      if (!models_.contains(model)) errors.push_back(where + ": no .model " + model);
    }
    // A node that only one thing touches floats; controlling voltages do not hold a node.
    for (const auto& [scope, nodes] : touched_) {
      for (const auto& [node, count] : nodes) {
        if (node != "0" && count < 2)
          errors.push_back(scope + ": node " + node + " is connected to one element only");
      }
    }
    for (const auto& [scope, nodes] : read_) {
      for (const std::string& node : nodes) {
        if (node != "0" && !touched_[scope].contains(node))
          errors.push_back(scope + ": v(" + node + ") of no node");
      }
    }
  }

  std::vector<std::string> errors;

 private:
  void report(const std::string& what) { errors.push_back(where_ + ": " + what); }

  static std::vector<std::string> words_of(const std::string& line) {
    std::istringstream words(line);
    std::vector<std::string> out;
    for (std::string word; words >> word;) out.push_back(word);
    return out;
  }

  bool only(Dialect dialect, const std::string& what) {
    if (!every_ && dialect_ == dialect) return true;
    report(what + " is not portable here");
    return false;
  }

  void command(const std::string& line, const std::string& raw, const std::filesystem::path& path, bool top) {
    const std::vector<std::string> words = words_of(line);
    const std::string& name = words[0];
    if (name == ".subckt") {
      if (!inside_.empty()) report("a .subckt inside another");
      if (words.size() < 3) report("a .subckt without pins");
      inside_ = words.size() > 1 ? words[1] : "?";
      if (pins_.contains(inside_)) report(inside_ + " is defined twice");
      pins_[inside_] = static_cast<int>(words.size()) - 2;
      for (size_t i = 2; i < words.size(); ++i) touched_[inside_][words[i]] += 2;  // held from outside
      names_.clear();
    } else if (name == ".ends") {
      if (words.size() != 2 || words[1] != inside_) report(".ends does not name its .subckt");
      inside_.clear();
      names_.clear();
    } else if (name == ".model") {
      if (words.size() < 3 || words[2].substr(0, 2) != "d(") report("a .model that is not a diode");
      models_.insert(words.at(1));
    } else if (!top) {
      report(name + " in a library");
    } else if (name == ".include") {
      std::string file = words_of(raw).at(1);
      if (file.size() > 1 && file[0] == '"') file = file.substr(1, file.size() - 2);
      const std::string here = where_;
      read(path.parent_path() / file, false);
      where_ = here;
    } else if (name == ".ac") {
      ++analyses_;
      if (words.size() != 5 || words[1] != "dec" || !plain_number(words[2]) || !plain_number(words[3]) ||
          !plain_number(words[4]))
        report(".ac is not 'dec points from to'");
    } else if (name == ".control") {
      if (only(Dialect::ngspice, name)) control_ = true;
      ++analyses_;
    } else if (name == ".param" || name == ".step" || name == ".save") {
      if (!only(Dialect::ltspice, name)) return;
      if (name == ".param") {
        for (size_t i = 1; i < words.size(); ++i) {
          const size_t equals = words[i].find('=');
          if (equals == std::string::npos || !plain_number(words[i].substr(equals + 1)))
            report("'" + words[i] + "' is not name=number");
          else
            parameters_.insert(words[i].substr(0, equals));
        }
      } else if (name == ".step" && (words.size() != 6 || words[1] != "param")) {
        report(".step is not 'param name from to step'");
      }
    } else if (name == ".print") {
      if (!only(Dialect::xyce, name)) return;
      if (words.size() < 5 || words[1] != "ac" || words[2] != "format=csv" ||
          words[3].substr(0, 5) != "file=")
        report(".print is not 'ac format=csv file=… outputs'");
    } else {
      report(name + " is not known");
    }
  }

  void element(const std::string& line) {
    const std::string scope = inside_.empty() ? "deck" : inside_;
    std::vector<std::string> words = words_of(line);
    if (!names_.insert(words[0]).second) report(words[0] + " is there twice");
    const auto touch = [&](size_t from, size_t to) {
      for (size_t i = from; i < to && i < words.size(); ++i) ++touched_[scope][words[i]];
    };
    switch (line[0]) {
      case 'r':
      case 'c': {
        if (words.size() != 4) {
          report("not 'name node node value'");
          return;
        }
        touch(1, 3);
        // A resistor to ground holds its node by itself (and is a source of thermal noise).
        if (line[0] == 'r' && words[2] == "0") ++touched_[scope][words[1]];
        if (words[3][0] == '{') {
          if (words[3].back() != '}') report("an open brace");
          expression(words[3].substr(1, words[3].size() - 2), scope);
        } else if (!plain_number(words[3]) || words[3][0] == '-') {
          report("'" + words[3] + "' is not a plain positive number");
        }
        break;
      }
      case 'e':
      case 'g': {
        const size_t open = line.find("value={");
        if (words.size() < 4 || words[3].substr(0, 7) != "value={" || line.back() != '}') {
          report("not 'name node node VALUE={…}'");
          return;
        }
        touch(1, 3);
        expression(line.substr(open + 7, line.size() - open - 8), scope);
        break;
      }
      case 'x':
        if (words.size() < 3) {
          report("not 'name nodes subcircuit'");
          return;
        }
        touch(1, words.size() - 1);
        calls_.push_back({where_, words.back(), static_cast<int>(words.size()) - 2});
        break;
      case 'd':
        if (words.size() != 4) report("not 'name node node model'");
        touch(1, 3);
        models_used_.emplace_back(where_, words.back());
        break;
      case 'v':
        touch(1, 3);
        source(line, words);
        break;
      default:
        report("an element '" + words[0] + "' that is not among the portable ones");
    }
  }

  void source(const std::string& line, const std::vector<std::string>& words) {
    const size_t pwl = line.find("pwl(");
    if (pwl != std::string::npos) {
      const size_t close = line.find(')', pwl);
      if (close != line.size() - 1) {
        report("something behind PWL(…)");
        return;
      }
      const std::vector<std::string> points = words_of(line.substr(pwl + 4, close - pwl - 4));
      if (points.size() % 2 != 0) report("PWL with an odd number of values");
      double last = -1.0;
      for (size_t i = 0; i < points.size(); ++i) {
        if (!plain_number(points[i])) report("'" + points[i] + "' in PWL");
        if (i % 2 == 0) {
          if (std::stod(points[i]) <= last) report("PWL goes back in time");
          last = std::stod(points[i]);
        }
      }
      return;
    }
    for (size_t i = 3; i + 1 < words.size(); i += 2) {
      if ((words[i] != "dc" && words[i] != "ac") || !plain_number(words[i + 1]))
        report("not dc or ac with a number");
    }
    if (words.size() % 2 == 0) report("not dc or ac with a number");
  }

  void expression(const std::string& text, const std::string& scope) {
    ExpressionReader reader(text, parameters_, !every_ && dialect_ == Dialect::ltspice);
    const std::string problem = reader.error_text();
    if (!problem.empty()) report(problem);
    read_[scope].insert(reader.nodes().begin(), reader.nodes().end());
  }

  struct Call {
    std::string where, name;
    int pins;
  };
  Dialect dialect_;
  bool every_;
  std::string where_, inside_;
  bool control_ = false;
  int analyses_ = 0;
  std::set<std::string> names_, models_;
  std::set<std::string> parameters_ = {"resistor_tolerance", "capacitor_tolerance"};
  std::map<std::string, int> pins_;
  std::vector<Call> calls_;
  std::vector<std::pair<std::string, std::string>> models_used_;
  std::map<std::string, std::map<std::string, int>> touched_;
  std::map<std::string, std::set<std::string>> read_;
};

}  // namespace

std::vector<std::string> dialect_errors(const std::filesystem::path& deck, Dialect dialect) {
  DeckReader reader(dialect, false);
  reader.read(deck, true);
  reader.finish();
  return reader.errors;
}

std::vector<std::string> library_errors(const std::filesystem::path& library) {
  DeckReader reader(Dialect::ngspice, true);
  reader.read(library, false);
  reader.finish();
  return reader.errors;
}

}  // namespace bodesmith
