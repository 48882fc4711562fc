// MATLAB level 5, compressed, by libmatio. Sections: z, p, k (zeros and poles in rad/s, H = k prod(s - z)/prod(s - p)),
// delay_s; a response: f (Hz), H; a record: t (s), u, y.
#include <complex>
#include <memory>
#include <stdexcept>
#include <vector>

#include "base/hertz_values.hpp"
#include "base/temporary.hpp"
#include "exchange/writer.hpp"
#include "lti/section_making.hpp"
#include "signal/formats/matio.hpp"

namespace bodesmith::exchange {
namespace {

using formats::matio;

/// No date in it: the same input gives the same bytes.
constexpr const char* kMatHeader = "MATLAB 5.0 MAT-file, Platform: any, written by bodesmith";

class MatOutput {
 public:
  MatOutput() : mat_(matio().create(file_.path().c_str(), kMatHeader, MAT_FT_MAT5), matio().close) {
    if (mat_ == nullptr) throw std::runtime_error("libmatio cannot create a file in memory");
  }
  void add(const char* name, std::vector<double> values) {
    std::size_t dims[2] = {values.size(), 1};
    put(matio().variable(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0));
  }
  void add(const char* name, const std::vector<Complex>& values) {
    // libmatio reads the first of no complex numbers.
    if (values.empty()) return add(name, std::vector<double>{});
    std::vector<double> re;
    std::vector<double> im;
    for (const Complex& v : values) {
      re.push_back(v.real());
      im.push_back(v.imag());
    }
    mat_complex_split_t split{re.data(), im.data()};
    std::size_t dims[2] = {values.size(), 1};
    put(matio().variable(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &split, MAT_F_COMPLEX));
  }
  std::string bytes() {
    mat_.reset();
    return file_.bytes();
  }

 private:
  void put(matvar_t* variable) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> owned(variable, matio().free);
    if (variable == nullptr || matio().write(mat_.get(), variable, MAT_COMPRESSION_ZLIB) != 0)
      throw std::runtime_error("libmatio cannot write a variable");
  }

  MemoryFile file_;
  std::unique_ptr<mat_t, int (*)(mat_t*)> mat_;
};

class MatlabWriter : public Writer {
 public:
  MatlabWriter() : Writer("matlab", ".mat", "MATLAB 5: z, p, k; f, H; t, u, y") {}
  Written write(const Exportable& from, const ExportOptions&) const override {
    MatOutput out;
    std::vector<std::string> said;
    if (from.record) {
      out.add("t", from.record->times_s());
      out.add("u", from.record->u);
      if (!from.record->y.empty()) out.add("y", from.record->y);
      said.push_back("t in s, u" + std::string(from.record->y.empty() ? "" : ", y"));
    }
    if (from.sections) {
      add_sections(*from.sections, out);
      said.emplace_back("z, p in rad/s, k, delay_s: H = k prod(s - z)/prod(s - p) exp(-s delay_s)");
    }
    if (from.response) {
      out.add("f", hertz_values(from.response->frequency));
      out.add("H", from.response->response);
      said.emplace_back("f in Hz, H complex");
    }
    return {out.bytes(), said};
  }

 private:
  static void add_sections(const Sections& sections, MatOutput& out) {
    const PooledRoots roots = pooled_roots(sections);
    out.add("z", roots.zeros);
    out.add("p", roots.poles);
    out.add("k", std::vector<double>{roots.gain});
    out.add("delay_s", std::vector<double>{sections.delay_s});
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, matlab_writer, MatlabWriter)

}  // namespace bodesmith::exchange
