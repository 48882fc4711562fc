#include "cli/seeded_inputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>

#include "base/files.hpp"

namespace bodesmith {

namespace fs = std::filesystem;

void write_seeded_inputs(const fs::path& folder) {
  std::string curve = "frequency_hz,gain\n", record = "time_s,u,y\n";
  for (int i = 0; i < 150; ++i) {
    const double f = 20.0 * std::pow(1000.0, i / 149.0);
    curve += fmt::format("{:.9g},{:.9g}\n", f, 1.0 / std::sqrt(f) * (1.0 + 0.01 * std::sin(1e3 * i)));
  }
  for (int i = 0; i < 300; ++i)
    record += fmt::format("{:.3f},{:.9g},{:.9g}\n", 1e-3 * i, std::sin(0.05 * i),
                          0.9 * std::sin(0.05 * i) + 0.05 * std::pow(std::sin(0.05 * i), 2));
  write_file(folder / "curve.csv", curve);
  write_file(folder / "record.csv", record);
  write_file(folder / "reference.csv", "time_s,r,y\n" + record.substr(record.find('\n') + 1));
  write_file(folder / "given_cascade.json",
             R"({"schema":"bodesmith.cascade/1","gain":1,"terms":[{"lambda_s":0.01,"x":0.1,"beta":0.4}]})");
  write_file(
      folder / "sections.json",
      R"({"schema":"bodesmith.sections/1","gain":1,"sections":[{"gain":2,"zeros_rad_s":[[-30000,0]],)"
      R"("poles_rad_s":[[-10000,0]]},{"gain":1,"zeros_rad_s":[[-40000,0]],"poles_rad_s":[[-90000,0]]}]})");
  write_file(folder / "model.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"polynomial\"\ncoefficients = [0, 1, 0.2]\n"
             "[[block]]\ntype = \"lowpass\"\ncorner_hz = 40.0\n");
  write_file(folder / "base.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 0.8\noffset = 0.0\n");
  write_file(folder / "project.toml",
             "schema = \"bodesmith.project/1\"\n[target]\nsections = \"sections.json\"\nfrom_hz = 500.0\n"
             "to_hz = 50000.0\n[hardware.circuit]\n[tolerances]\nresistor_percent = 1.0\n");
  std::string response = "frequency_hz,magnitude_db,phase_deg\n";
  for (int i = 0; i < 40; ++i) {
    const double f = std::pow(10.0, 0.075 * i);
    const std::complex<double> h = 1.0 / (1.0 + std::complex<double>(0.0, f / 30.0));
    response +=
        fmt::format("{:.9g},{:.9g},{:.9g}\n", f, 20.0 * std::log10(std::abs(h)) + 1e-3 * std::sin(1e3 * i),
                    std::arg(h) * 57.29577951308232);
  }
  write_file(folder / "response.csv", response);
  const fs::path example = fs::path(BODESMITH_SOURCE_DIR) / "examples/nanopositioner";
  for (const char* name : {"gains.csv", "disturbance.json"})
    write_file(folder / name, read_file(example / name));
  write_file(folder / "cauer.sc", read_file(example.parent_path() / "switched_capacitor/cauer.sc"));
}

const std::vector<std::string>& seeded_commands() {
  static const std::vector<std::string> all = {
      "run project.toml -o out",
      "new made --kind filter",
      "schema -o schemas",
      "completion bash > completion.bash",
      "design lowpass --family elliptic --order 4 --corner-hz 1000 --ripple-db 0.5 --stop-db 40 -o design.json",
      "fit gains.csv -o cascade.json",
      "fit curve.csv --direct --order 3 --seed 5 -o fit.json",
      "fit --waveform disturbance.json --order 2 -o waveform.json",
      "fit --measured response.csv -o measured.json",
      "approximate given_cascade.json --order 3 -o approximated.json",
      "fpaa sections.json -o board --stream",
      "spice sections.json -o circuit",
      "layout disturbance.json -o layout",
      "controller disturbance.json -o controller",
      "yield sections.json --samples 200 --seed 3 -o yield.json",
      "yield controller disturbance.json --draws 4 --track 1 100 --no-ngspice -o errors",
      "identify record.csv --model prandtl_ishlinskii -o model_out.toml",
      "model disturbance.json sections.json -o series.toml",
      "compensate model.toml --reference reference.csv -o drive.csv",
      "diagnose base.toml --data record.csv --holdout record.csv --max-terms 1 --threads 2 -o diagnosis",
      "simulate model.toml --input record.csv -o y.csv --spectra s.csv --loops l.csv",
      "export sections.json -o sections.m",
      "tune response.csv --kind notch-lead --bandwidth-hz 20 --seed 2 -o controller.json --sections loop.json",
      "bode sections.json --count 20000 -o bode.csv",
      "sc cauer.sc --noise --count 20 -o sc.csv",
  };
  return all;
}

}  // namespace bodesmith
