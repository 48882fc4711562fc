// MATLAB level 5 files (-v6, -v7), read by libmatio. Vectors of numbers at the top or in one structure, by name:
// frequency f, freq, frequency (Hz) or w, omega, wout (rad/s) with a complex vector, or mag and phase (degrees);
// or t, time, tout with u and y, or a sampling rate fs (a step ts, dt) with u and y. FILE:NAME[,NAME] chooses others.
#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <initializer_list>
#include <memory>
#include <optional>

#include "base/error.hpp"
#include "base/temporary.hpp"
#include "base/text.hpp"
#include "signal/formats/format.hpp"
#include "signal/formats/matio.hpp"
#include "signal/formats/table_meaning.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

using Complex = std::complex<double>;

struct MatVector {
  std::string name;
  std::vector<Complex> values;
  bool complex = false;
  std::string unusable;  ///< why, of what is no vector of numbers: "is sparse"
};

template <class T>
void append_numbers(const void* re, const void* im, std::size_t count, std::vector<Complex>& out) {
  for (std::size_t i = 0; i < count; ++i)
    out.emplace_back(static_cast<double>(static_cast<const T*>(re)[i]),
                     im == nullptr ? 0.0 : static_cast<double>(static_cast<const T*>(im)[i]));
}

bool append_data(const matvar_t& variable, std::size_t count, std::vector<Complex>& out) {
  const void* re = variable.data;
  const void* im = nullptr;
  if (variable.isComplex != 0) {
    const auto* parts = static_cast<const mat_complex_split_t*>(variable.data);
    re = parts->Re;
    im = parts->Im;
    if (im == nullptr) return false;
  }
  if (re == nullptr) return false;
  const auto holds = [&]<class Number>(matio_types type, Number) {
    if (variable.data_type != type) return false;
    append_numbers<Number>(re, im, count, out);
    return true;
  };
  return holds(MAT_T_DOUBLE, double()) || holds(MAT_T_SINGLE, float()) || holds(MAT_T_INT8, std::int8_t()) ||
         holds(MAT_T_UINT8, std::uint8_t()) || holds(MAT_T_INT16, std::int16_t()) ||
         holds(MAT_T_UINT16, std::uint16_t()) || holds(MAT_T_INT32, std::int32_t()) ||
         holds(MAT_T_UINT32, std::uint32_t()) || holds(MAT_T_INT64, std::int64_t()) ||
         holds(MAT_T_UINT64, std::uint64_t());
}

/// What a name may stand for and no vector is; it counts where the name is wanted.
std::string why_unusable(const matvar_t& variable) {
  if (variable.class_type == MAT_C_SPARSE) return "is sparse, expected it full";
  if (variable.class_type == MAT_C_CHAR) return "is text, expected numbers";
  if (variable.class_type == MAT_C_CELL) return "is a cell array, expected numbers";
  const auto longer =
      std::count_if(variable.dims, variable.dims + variable.rank, [](auto d) { return d > 1; });
  if (variable.rank > 2 && longer > 1)
    return fmt::format("has {} dimensions, expected a vector", variable.rank);
  return "";
}

/// Numbers of a variable and, for structures, of its fields; a matrix of several columns gives one vector a column.
void collect(const matvar_t* variable, const std::string& prefix, std::vector<MatVector>& out, int depth) {
  if (variable == nullptr || variable->name == nullptr || depth > 3) return;
  const std::string name = prefix + variable->name;
  if (variable->class_type == MAT_C_STRUCT) {
    const unsigned fields = matio().number_of_fields(const_cast<matvar_t*>(variable));
    if (variable->data == nullptr || variable->nbytes < fields * sizeof(matvar_t*)) return;
    for (unsigned i = 0; i < fields; ++i)
      collect(static_cast<matvar_t* const*>(variable->data)[i], name + ".", out, depth + 1);
    return;
  }
  if (const std::string why = why_unusable(*variable); !why.empty()) {
    out.push_back({name, {}, false, why});
    return;
  }
  if (variable->data == nullptr || variable->data_size <= 0) return;
  std::size_t count = 1;
  std::size_t longest = 1;
  for (int i = 0; i < variable->rank; ++i) {
    const std::size_t d = variable->dims[i];
    if (d != 0 && count > (std::size_t{1} << 40) / d) return;
    count *= d;
    longest = std::max(longest, d);
  }
  if (count == 0) return;
  // libmatio keeps the bytes of one part; fewer than the shape says would be read beyond their end.
  if (variable->isComplex == 0 && variable->nbytes < count * static_cast<std::size_t>(variable->data_size))
    return;
  MatVector vector{name, {}, variable->isComplex != 0, {}};
  if (!append_data(*variable, count, vector.values)) return;
  if (count == longest) {
    out.push_back(std::move(vector));
  } else if (variable->rank == 2) {
    const std::size_t rows = variable->dims[0];
    for (std::size_t c = 0; c * rows < count; ++c) {
      const auto begin = vector.values.begin() + static_cast<std::ptrdiff_t>(c * rows);
      out.push_back({fmt::format("{}({})", name, c + 1),
                     {begin, begin + static_cast<std::ptrdiff_t>(rows)},
                     vector.complex,
                     {}});
    }
  }
}

[[noreturn]] void fail_at_mat_byte(const Source& source, std::size_t byte, const std::string& what) {
  throw InputError(source.file, 0, fmt::format("byte {}: {}", byte, what));
}

/// The parts of an uncompressed variable (flags, shape, name, numbers) must lie within it: libmatio believes their
/// lengths. A part of up to four bytes has its length in the upper half of its first word.
template <class Number>
void validate_parts(const Source& source, const Number& number, std::size_t at, std::size_t end) {
  while (at + 8 <= end) {
    const std::size_t word = number(at, 4);
    const std::size_t length = (word >> 16) != 0 ? 0 : number(at + 4, 4);
    if ((word >> 16) > 4 || length > end - at - 8)
      fail_at_mat_byte(source, at,
                       fmt::format("a part of a variable goes beyond the variable's end at byte {}", end));
    at += 8 + (length + 7) / 8 * 8;
  }
}

/// The elements of the top level must fill the file to its end.
void validate_elements(const Source& source) {
  const std::string_view b = source.bytes;
  if (b.size() < 128) fail_at_mat_byte(source, b.size(), "the file ends within its header of 128 bytes");
  const bool little = b.substr(126, 2) == "IM";
  if (!little && b.substr(126, 2) != "MI") fail_at_mat_byte(source, 126, "no byte order, expected IM or MI");
  const auto number = [&](std::size_t at, std::size_t count) {
    std::size_t out = 0;
    for (std::size_t i = 0; i < count; ++i)
      out |= static_cast<std::size_t>(static_cast<unsigned char>(b[at + i]))
             << (8 * (little ? i : count - 1 - i));
    return out;
  };
  const std::size_t version = number(124, 2);
  if (version == 0x0200)
    fail_at_mat_byte(source, 124, "a version 7.3 file (HDF5), expected version 5: save it with -v7");
  if (version != 0x0100)
    fail_at_mat_byte(source, 124, fmt::format("version {:#06x}, expected 0x0100", version));
  std::size_t at = 128;
  while (at < b.size()) {
    if (b.size() - at < 8) fail_at_mat_byte(source, b.size(), "the file ends within the head of a variable");
    const std::size_t type = number(at, 4);
    const std::size_t length = number(at + 4, 4);
    if (type != 14 && type != 15)
      fail_at_mat_byte(source, at,
                       fmt::format("an element of type {}, expected a matrix (14 or compressed 15)", type));
    if (length > b.size() - at - 8)
      fail_at_mat_byte(
          source, b.size(),
          fmt::format("the file ends within a variable of {} bytes that begins at byte {}", length, at));
    if (type == 14) validate_parts(source, number, at + 8, at + 8 + length);
    at += 8 + length;
  }
}

/// A damaged shape would have libmatio read gigabytes of nothing: a number takes at least a byte, compressed a
/// thousandth of one.
void validate_shape(const Source& source, const matvar_t& variable, int depth) {
  constexpr std::size_t kMostNumbersPerByte = 1100;
  const std::size_t most = kMostNumbersPerByte * source.bytes.size();
  std::size_t count = 1;
  for (int i = 0; i < variable.rank; ++i) {
    const std::size_t d = variable.dims[i];
    if (d != 0 && count > most / d)
      throw InputError(source.file, 0,
                       fmt::format("holds a variable '{}' of more values than the file has room for",
                                   variable.name != nullptr ? variable.name : ""));
    count *= d;
  }
  if (variable.class_type != MAT_C_STRUCT || variable.data == nullptr || depth > 3) return;
  const unsigned fields = matio().number_of_fields(const_cast<matvar_t*>(&variable));
  if (variable.nbytes < fields * count * sizeof(matvar_t*)) return;
  for (std::size_t i = 0; i < fields * count; ++i) {
    const matvar_t* field = static_cast<matvar_t* const*>(variable.data)[i];
    if (field != nullptr) validate_shape(source, *field, depth + 1);
  }
}

std::vector<MatVector> read_vectors(const Source& source) {
  validate_elements(source);
  const MemoryFile copy(source.bytes);
  matio().log("bodesmith", [](int, char*) {});
  const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(matio().open(copy.path().c_str(), MAT_ACC_RDONLY),
                                                    matio().close);
  if (mat == nullptr) throw InputError(source.file, 0, "is not a MATLAB file that can be opened");
  std::vector<MatVector> out;
  while (true) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(matio().read_next_info(mat.get()),
                                                                  matio().free);
    if (variable == nullptr) break;
    validate_shape(source, *variable, 0);
    if (matio().read_data(mat.get(), variable.get()) != 0)
      throw InputError(
          source.file, 0,
          fmt::format("holds a variable '{}' that is damaged", variable->name ? variable->name : ""));
    collect(variable.get(), "", out, 0);
  }
  if (std::ranges::all_of(out, [](const MatVector& v) { return !v.unusable.empty(); })) {
    throw InputError(source.file, 0,
                     out.empty()
                         ? std::string("holds no vectors of numbers")
                         : fmt::format("holds no vectors of numbers: '{}' {}", out[0].name, out[0].unusable));
  }
  return out;
}

std::string last_part(const std::string& name) {
  return lower_case(name.substr(name.rfind('.') == std::string::npos ? 0 : name.rfind('.') + 1));
}

class MatRoles {
 public:
  MatRoles(const Source& source, const std::vector<MatVector>& vectors)
      : source_(source), vectors_(vectors) {}

  /// The first vector called so, of `length` values where that is not 0; InputError where there are only others.
  const MatVector* named(std::initializer_list<std::string_view> names, std::size_t length = 0) const {
    const MatVector* other = nullptr;
    for (const std::string_view name : names) {
      for (const MatVector& v : vectors_) {
        if (last_part(v.name) != name) continue;
        require_usable(v);
        if (length == 0 ? v.values.size() > 1 : v.values.size() == length) return &v;
        if (v.values.size() > 1) other = &v;
      }
    }
    if (other != nullptr)
      throw InputError(source_.file, 0,
                       fmt::format("'{}' has {} values, expected {} as of its axis", other->name,
                                   other->values.size(), length));
    return nullptr;
  }
  std::optional<double> scalar(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      for (const MatVector& v : vectors_) {
        if (v.values.size() == 1 && last_part(v.name) == name && v.values[0].real() > 0.0)
          return v.values[0].real();
      }
    }
    return std::nullopt;
  }
  const MatVector& chosen(std::string_view name) const {
    std::vector<std::string> names;
    for (const MatVector& v : vectors_) names.push_back(v.name);
    const MatVector& out = vectors_[require_name(source_, names, name)];
    require_usable(out);
    return out;
  }
  /// InputError where it is complex.
  std::vector<double> reals(const MatVector& vector) const {
    std::vector<double> out;
    for (const Complex& v : vector.values) {
      if (v.imag() != 0.0)
        throw InputError(source_.file, 0, fmt::format("'{}' is complex, expected real numbers", vector.name));
      out.push_back(v.real());
    }
    return out;
  }
  /// The only complex vector of a length.
  const MatVector* only_complex(std::size_t length) const {
    const MatVector* found = nullptr;
    for (const MatVector& v : vectors_) {
      if (!v.complex || v.values.size() != length) continue;
      if (found != nullptr) return nullptr;
      found = &v;
    }
    return found;
  }
  std::string names() const {
    std::vector<std::string> all;
    for (const MatVector& v : vectors_) all.push_back(fmt::format("{} ({})", v.name, v.values.size()));
    return join(all, ", ");
  }

 private:
  void require_usable(const MatVector& vector) const {
    if (!vector.unusable.empty())
      throw InputError(source_.file, 0, fmt::format("'{}' {}", vector.name, vector.unusable));
  }

  const Source& source_;
  const std::vector<MatVector>& vectors_;
};

/// FILE:F,H or FILE:F,MAGNITUDE,PHASE, FILE:U,Y or FILE:T,U,Y: variables of any name.
std::vector<const MatVector*> chosen_vectors(const Source& source, const MatRoles& roles) {
  std::vector<const MatVector*> out;
  if (is_scale_word(source.choice)) return out;
  for (Choice rest = split_choice(source.choice);; rest = split_choice(rest.second)) {
    if (rest.between == '/')
      throw InputError(source.file, 0,
                       fmt::format("'{}' is a quotient, expected NAME or NAME,NAME", source.choice));
    if (!rest.first.empty()) out.push_back(&roles.chosen(rest.first));
    if (rest.between == 0) return out;
  }
}

bool begins_like_angular(const std::string& name) {
  const std::string last = last_part(name);
  return last == "w" || last == "wout" || last.starts_with("omega") || last.ends_with("rad_s");
}

std::optional<Foreign> matlab_response(const Source& source, const MatRoles& roles) {
  const std::vector<const MatVector*> chosen = chosen_vectors(source, roles);
  const MatVector* f = chosen.size() > 1 ? chosen[0] : nullptr;
  if (f == nullptr)
    f = roles.named({"frequency_hz", "freq_hz", "f_hz", "frequency", "freq", "f", "fhz", "hz"});
  if (f == nullptr) f = roles.named({"omega", "w", "wout", "omega_rad_s", "w_rad_s"});
  if (f == nullptr) return std::nullopt;
  Heading axis;
  axis.unit = "Hz";
  if (begins_like_angular(f->name)) {
    axis.quantity = Quantity::angular_frequency;
    axis.unit = "rad/s";
  }
  const std::size_t length = f->values.size();
  Words words{"MATLAB 5 file", {"frequency " + f->name}};
  std::vector<double> frequency = hertz(axis, roles.reals(*f), words);
  ResponseTrace trace;
  const MatVector* h = chosen.empty() ? roles.only_complex(length) : chosen[chosen.size() > 1 ? 1 : 0];
  const auto require_length = [&](const MatVector& vector) {
    if (vector.values.size() != length)
      throw InputError(
          source.file, 0,
          fmt::format("'{}' has {} values, {} has {}", vector.name, vector.values.size(), f->name, length));
  };
  if (h != nullptr) require_length(*h);
  if (h != nullptr && h->complex) {
    trace = to_trace(h->name, h->values);
    words.notes.push_back("response " + h->name);
  } else {
    const MatVector* db = roles.named({"magnitude_db", "mag_db", "magdb", "gain_db"}, length);
    const MatVector* linear = roles.named({"mag", "magnitude", "gain"}, length);
    if (h == nullptr) h = db != nullptr ? db : linear;
    if (h == nullptr) return std::nullopt;
    const MagnitudeScale scale = h == db       ? MagnitudeScale::decibel
                                 : h == linear ? MagnitudeScale::linear
                                               : MagnitudeScale::unknown;
    words.notes.push_back("magnitude " + h->name);
    trace.name = h->name;
    trace.magnitude_db = decibels(source, scale, roles.reals(*h), words);
    const MatVector* phase =
        chosen.size() > 2 ? chosen[2] : roles.named({"phase_deg", "phase_rad", "phase"}, length);
    if (phase != nullptr) {
      require_length(*phase);
      Source said = source;
      said.choice = phase->name.ends_with("rad") ? "rad" : phase->name.ends_with("deg") ? "deg" : "";
      trace.phase_deg = degrees_of(said, fmt::format("'{}'", phase->name), roles.reals(*phase),
                                   "call it phase_deg or phase_rad", words);
      words.notes.push_back("phase " + phase->name);
    }
  }
  return response_columns(source, std::move(words), std::move(frequency), std::move(trace), {});
}

/// Times of a record of `length` samples: a vector, the user's or the file's own rate or step; empty where there is none.
std::vector<double> matlab_times(const Source& source, const MatRoles& roles, const MatVector* t,
                                 std::size_t length, Words& words) {
  if (t != nullptr) {
    words.notes.push_back("time " + t->name);
    return roles.reals(*t);
  }
  if (source.sample_hz) return sampled_times(*source.sample_hz, length, words);
  std::vector<double> out;
  const auto rate = roles.scalar({"fs", "fs_hz", "sample_rate", "samplerate", "rate"});
  const auto step = rate ? std::optional(1.0 / *rate) : roles.scalar({"ts", "dt", "step_s", "h"});
  if (!step) return out;
  for (std::size_t i = 0; i < length; ++i) out.push_back(static_cast<double>(i) * *step);
  words.notes.push_back(fmt::format("steps of {}", engineering_text(*step, "s", 6)));
  return out;
}

std::optional<Foreign> matlab_record(const Source& source, const MatRoles& roles) {
  std::vector<const MatVector*> chosen = chosen_vectors(source, roles);
  const MatVector* t = nullptr;
  if (chosen.size() > 2) {
    t = chosen.front();
    chosen.erase(chosen.begin());
  } else {
    t = roles.named({"time_s", "t_s", "time", "t", "tout"});
  }
  if (chosen.empty()) {
    const std::size_t length = t == nullptr ? 0 : t->values.size();
    if (const MatVector* u = roles.named({"u", "input", "in", "x", "vin", "r"}, length)) chosen.push_back(u);
    const std::size_t as_long = chosen.empty() ? length : chosen[0]->values.size();
    if (const MatVector* y = roles.named({"y", "output", "out", "vout"}, as_long)) chosen.push_back(y);
  }
  if (chosen.empty()) return std::nullopt;
  Words words{"MATLAB 5 file", {}};
  std::vector<double> time = matlab_times(source, roles, t, chosen[0]->values.size(), words);
  if (time.empty()) return std::nullopt;
  std::vector<SignalTrace> signals;
  for (const MatVector* v : chosen) {
    if (v->values.size() != time.size())
      throw InputError(
          source.file, 0,
          fmt::format("'{}' has {} values for {} times", v->name, v->values.size(), time.size()));
    signals.push_back({v->name, roles.reals(*v)});
  }
  return record_columns(source, std::move(words), std::move(time), std::move(signals), {},
                        Steps::as_they_are);
}

class MatlabFile : public Format {
 public:
  std::string_view name() const override { return "MATLAB 5 file"; }
  bool recognises(const Source& source) const override {
    if (source.bytes.starts_with("MATLAB 5.0 MAT-file") || source.bytes.starts_with("MATLAB 7.3 MAT-file"))
      return true;
    if (source.bytes.size() < 136) return false;
    const std::string_view mark = source.bytes.substr(124, 4);
    return mark == std::string_view("\x00\x01IM", 4) || mark == std::string_view("\x01\x00MI", 4);
  }
  Foreign read(const Source& source) const override {
    const std::vector<MatVector> vectors = read_vectors(source);
    const MatRoles roles(source, vectors);
    if (source.wanted != Content::record) {
      if (auto out = matlab_response(source, roles)) return std::move(*out);
    }
    if (auto out = matlab_record(source, roles)) return std::move(*out);
    if (auto out = matlab_response(source, roles)) return std::move(*out);
    throw InputError(
        source.file, 0,
        fmt::format("holds {}; expected f or w with a complex vector or mag and phase, or t (or fs) with u "
                    "and y; FILE:NAME or FILE:NAME,NAME chooses",
                    roles.names()));
  }
};

}  // namespace

BODESMITH_ENTRY(Format, matlab_file, MatlabFile)

}  // namespace bodesmith::formats
