// Datasets of Qucs and Qucs-S: "<Qucs Dataset 0.0.19>", then "<indep frequency 201>" … "</indep>" and, for each variable,
// "<dep out.v frequency>" … "</dep>", one value a line, complex ones as +1.0e+00-j2.5e-01. Taken are variables over the
// frequency or the time alone (names end so: "acfrequency"); sweeps of a parameter are not.
#include <fmt/format.h>

#include <algorithm>
#include <complex>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/number_table.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

using Complex = std::complex<double>;

struct Vector {
  std::string name;
  std::string over;  ///< the axis of a variable; empty for an axis
  std::vector<Complex> values;
  int line = 0;
};

bool parse_complex(std::string_view text, Complex& value) {
  double re = 0.0;
  double im = 0.0;
  const std::size_t j = text.find('j');
  if (j != std::string_view::npos) {
    if (j == 0 || (text[j - 1] != '+' && text[j - 1] != '-') || !parse_number(text.substr(j + 1), im))
      return false;
    if (text[j - 1] == '-') im = -im;
    text = text.substr(0, j - 1);
  }
  if (!text.empty() && !parse_number(text, re)) return false;
  value = {re, im};
  return true;
}

std::vector<Vector> vectors_of(const Source& source) {
  std::vector<Vector> out;
  bool open = false;
  int number = 0;
  for (const std::string_view whole : split(source.text, '\n')) {
    ++number;
    std::string_view line = trim(whole);
    const auto fail = [&](const std::string& what) { throw InputError(source.file, number, what); };
    if (line.starts_with("</")) {
      open = false;
    } else if (line.starts_with("<indep ") || line.starts_with("<dep ")) {
      if (open || !line.ends_with('>'))
        fail("expected one of <indep NAME COUNT>, <dep NAME AXIS>, </indep>, </dep>");
      line.remove_suffix(1);
      const std::vector<std::string_view> words = formats::split_cells(line, ' ');
      if (words.size() < 3) fail("expected a name and a count or an axis");
      // Of two axes: swept, and none of what is taken.
      const std::string over = words.front() == "<indep" ? ""
                               : words.size() > 3        ? "a sweep"
                                                         : std::string(words[2]);
      out.push_back({std::string(words[1]), over, {}, number});
      open = true;
    } else if (open && !line.empty()) {
      Complex value;
      if (!parse_complex(line, value)) fail(fmt::format("'{}' is not a finite number", line.substr(0, 40)));
      out.back().values.push_back(value);
    }
  }
  if (open) throw InputError(source.file, out.back().line, "begins values without an end");
  return out;
}

const Vector* axis_of(const std::vector<Vector>& all, std::string_view ending) {
  const auto found = std::ranges::find_if(
      all, [&](const Vector& v) { return v.over.empty() && lower_case(v.name).ends_with(ending); });
  return found == all.end() ? nullptr : &*found;
}

class QucsDataset : public Format {
 public:
  std::string_view name() const override { return "Qucs dataset"; }
  bool recognises(const Source& source) const override { return source.text.starts_with("<Qucs Dataset "); }

  Foreign read(const Source& source) const override {
    const std::vector<Vector> all = vectors_of(source);
    const Vector* time = axis_of(all, "time");
    const Vector* axis = axis_of(all, "frequency");
    const bool over_time = time != nullptr && (axis == nullptr || source.wanted == Content::record);
    if (over_time) axis = time;
    if (axis == nullptr) throw InputError(source.file, 0, "has no axis of frequency or time");
    std::vector<double> at;
    for (const Complex& value : axis->values) at.push_back(value.real());
    std::vector<std::string> names;
    std::vector<std::vector<Complex>> values;
    for (const Vector& v : all) {
      if (v.over != axis->name) continue;
      if (v.values.size() != at.size())
        throw InputError(
            source.file, v.line,
            fmt::format("begins {} values over {} of {}", v.values.size(), at.size(), axis->name));
      names.push_back(v.name);
      values.push_back(v.values);
    }
    Words words{std::string(name()), {}};
    Source with = source;
    for (const char* usual : {"out.v", "S[2,1]"}) {
      if (with.choice.empty() && !over_time && find_name(names, usual)) with.choice = usual;
    }
    if (!over_time) {
      std::erase(with.choice, ',');
      for (std::string& each : names) std::erase(each, ',');
      ResponseTrace trace = choose_response(with, names, values);
      words.notes.push_back(trace.name);
      return response_columns(source, std::move(words), std::move(at), std::move(trace), {});
    }
    std::vector<SignalTrace> signals;
    for (std::size_t i = 0; i < names.size(); ++i) {
      signals.push_back({names[i], {}});
      for (const Complex& value : values[i]) signals.back().values.push_back(value.real());
    }
    return record_columns(source, std::move(words), std::move(at), choose_signals(with, std::move(signals)),
                          {}, Steps::made_even);
  }
};

}  // namespace

BODESMITH_ENTRY(Format, qucs_dataset, QucsDataset)

}  // namespace bodesmith::formats
