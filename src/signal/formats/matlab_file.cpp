// MATLAB level 5 files (-v6, -v7), read by libmatio. Vectors of numbers at the top or in one structure, by name:
// frequency f, freq, frequency (Hz) or w, omega, wout (rad/s) with a complex vector, or mag and phase (degrees);
// or t, time, tout with u and y, or a sampling rate fs (a step ts, dt) with u and y. FILE:NAME[,NAME] chooses others.
#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <initializer_list>
#include <memory>
#include <numbers>
#include <optional>

#include "base/error.hpp"
#include "base/letters.hpp"
#include "base/memory_file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "signal/formats/all_formats.hpp"
#include "signal/formats/table_meaning.hpp"
#include "signal/formats/traces.hpp"

namespace bodesmith::formats {
namespace {

using Complex = std::complex<double>;

struct MatVector {
  std::string name;
  std::vector<Complex> values;
  bool complex = false;
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
  switch (variable.data_type) {
    case MAT_T_DOUBLE:
      append_numbers<double>(re, im, count, out);
      return true;
    case MAT_T_SINGLE:
      append_numbers<float>(re, im, count, out);
      return true;
    case MAT_T_INT8:
      append_numbers<std::int8_t>(re, im, count, out);
      return true;
    case MAT_T_UINT8:
      append_numbers<std::uint8_t>(re, im, count, out);
      return true;
    case MAT_T_INT16:
      append_numbers<std::int16_t>(re, im, count, out);
      return true;
    case MAT_T_UINT16:
      append_numbers<std::uint16_t>(re, im, count, out);
      return true;
    case MAT_T_INT32:
      append_numbers<std::int32_t>(re, im, count, out);
      return true;
    case MAT_T_UINT32:
      append_numbers<std::uint32_t>(re, im, count, out);
      return true;
    case MAT_T_INT64:
      append_numbers<std::int64_t>(re, im, count, out);
      return true;
    case MAT_T_UINT64:
      append_numbers<std::uint64_t>(re, im, count, out);
      return true;
    default:
      return false;
  }
}

/// Numbers of a variable and, for structures, of its fields; a matrix of several columns gives one vector a column.
void collect(const matvar_t* variable, const std::string& prefix, std::vector<MatVector>& out, int depth) {
  if (variable == nullptr || variable->name == nullptr || depth > 3) return;
  const std::string name = prefix + variable->name;
  if (variable->class_type == MAT_C_STRUCT) {
    const unsigned fields = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(variable));
    if (variable->data == nullptr || variable->nbytes < fields * sizeof(matvar_t*)) return;
    for (unsigned i = 0; i < fields; ++i)
      collect(static_cast<matvar_t* const*>(variable->data)[i], name + ".", out, depth + 1);
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
  MatVector vector{name, {}, variable->isComplex != 0};
  if (!append_data(*variable, count, vector.values)) return;
  if (count == longest) {
    out.push_back(std::move(vector));
  } else if (variable->rank == 2) {
    const std::size_t rows = variable->dims[0];
    for (std::size_t c = 0; c * rows < count; ++c) {
      const auto begin = vector.values.begin() + static_cast<std::ptrdiff_t>(c * rows);
      out.push_back({fmt::format("{}({})", name, c + 1),
                     {begin, begin + static_cast<std::ptrdiff_t>(rows)},
                     vector.complex});
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
  const unsigned fields = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(&variable));
  if (variable.nbytes < fields * count * sizeof(matvar_t*)) return;
  for (std::size_t i = 0; i < fields * count; ++i) {
    const matvar_t* field = static_cast<matvar_t* const*>(variable.data)[i];
    if (field != nullptr) validate_shape(source, *field, depth + 1);
  }
}

std::vector<MatVector> read_vectors(const Source& source) {
  validate_elements(source);
  const MemoryFile copy(source.bytes);
  Mat_LogInitFunc("bodesmith", [](int, char*) {});
  const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(Mat_Open(copy.path().c_str(), MAT_ACC_RDONLY),
                                                    &Mat_Close);
  if (mat == nullptr) throw InputError(source.file, 0, "is not a MATLAB file that can be opened");
  std::vector<MatVector> out;
  while (true) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable(Mat_VarReadNextInfo(mat.get()),
                                                                  &Mat_VarFree);
    if (variable == nullptr) break;
    validate_shape(source, *variable, 0);
    if (Mat_VarReadDataAll(mat.get(), variable.get()) != 0)
      throw InputError(
          source.file, 0,
          fmt::format("holds a variable '{}' that is damaged", variable->name ? variable->name : ""));
    collect(variable.get(), "", out, 0);
  }
  if (out.empty()) throw InputError(source.file, 0, "holds no vectors of numbers");
  return out;
}

std::string last_part(const std::string& name) {
  return lower_case(name.substr(name.rfind('.') == std::string::npos ? 0 : name.rfind('.') + 1));
}

class MatRoles {
 public:
  MatRoles(const Source& source, const std::vector<MatVector>& vectors)
      : source_(source), vectors_(vectors) {}

  const MatVector* named(std::initializer_list<std::string_view> names, std::size_t length = 0) const {
    for (const std::string_view name : names) {
      for (const MatVector& v : vectors_) {
        const bool fits = length == 0 ? v.values.size() > 1 : v.values.size() == length;
        if (fits && last_part(v.name) == name) return &v;
      }
    }
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
    return vectors_[require_name(source_, names, name)];
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
  const Source& source_;
  const std::vector<MatVector>& vectors_;
};

std::vector<double> reals(const MatVector& vector) {
  std::vector<double> out;
  for (const Complex& v : vector.values) out.push_back(v.real());
  return out;
}

std::optional<Foreign> matlab_response(const Source& source, const MatRoles& roles) {
  Heading axis;
  axis.unit = "Hz";
  const MatVector* f =
      roles.named({"frequency_hz", "freq_hz", "f_hz", "frequency", "freq", "f", "fhz", "hz"});
  if (f == nullptr) {
    f = roles.named({"omega", "w", "wout", "omega_rad_s", "w_rad_s"});
    axis.quantity = Quantity::angular_frequency;
  }
  if (f == nullptr) return std::nullopt;
  const std::size_t length = f->values.size();
  Words words{"MATLAB 5 file", {"frequency " + f->name}};
  std::vector<double> frequency = hertz(axis, reals(*f), words);
  ResponseTrace trace;
  const bool scale_word = source.choice == "db" || source.choice == "gain" || source.choice == "ohm";
  const MatVector* h = roles.only_complex(length);
  if (!source.choice.empty() && !scale_word) h = &roles.chosen(source.choice);
  if (h != nullptr && h->values.size() != length)
    throw InputError(
        source.file, 0,
        fmt::format("'{}' has {} values, {} has {}", h->name, h->values.size(), f->name, length));
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
    trace.magnitude_db = decibels(source, scale, reals(*h), words);
    if (const MatVector* phase = roles.named({"phase_deg", "phase"}, length)) {
      trace.phase_deg = reals(*phase);
      words.notes.push_back(fmt::format("{} in degrees", phase->name));
    }
  }
  return response_columns(source, std::move(words), std::move(frequency), std::move(trace), {});
}

std::optional<Foreign> matlab_record(const Source& source, const MatRoles& roles) {
  const Choice choice = split_choice(source.choice);
  const MatVector* t = roles.named({"time_s", "t_s", "time", "t", "tout"});
  const MatVector* u = choice.first.empty() ? nullptr : &roles.chosen(choice.first);
  const MatVector* y = choice.second.empty() ? nullptr : &roles.chosen(choice.second);
  if (u == nullptr) {
    const std::size_t length = t == nullptr ? 0 : t->values.size();
    u = roles.named({"u", "input", "in", "x", "vin", "r"}, length);
    y = roles.named({"y", "output", "out", "vout"}, u == nullptr ? length : u->values.size());
    if (u == nullptr) std::swap(u, y);
  }
  if (u == nullptr) return std::nullopt;
  const std::size_t length = u->values.size();
  Words words{"MATLAB 5 file", {}};
  std::vector<double> time;
  if (t != nullptr) {
    time = reals(*t);
    words.notes.push_back("time " + t->name);
  } else {
    const auto rate = roles.scalar({"fs", "fs_hz", "sample_rate", "samplerate", "rate"});
    const auto step = rate ? std::optional(1.0 / *rate) : roles.scalar({"ts", "dt", "step_s", "h"});
    if (!step) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) time.push_back(static_cast<double>(i) * *step);
    words.notes.push_back(fmt::format("steps of {}", engineering_text(*step, "s", 6)));
  }
  for (const MatVector* v : {u, y}) {
    if (v != nullptr && v->values.size() != time.size())
      throw InputError(
          source.file, 0,
          fmt::format("'{}' has {} values for {} times", v->name, v->values.size(), time.size()));
  }
  std::vector<SignalTrace> signals{{u->name, reals(*u)}};
  if (y != nullptr) signals.push_back({y->name, reals(*y)});
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

const Format& matlab_file() {
  static const MatlabFile format;
  return format;
}

}  // namespace bodesmith::formats
