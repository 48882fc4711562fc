#include "functions.hpp"

namespace bodesmith::python {

const std::vector<Function>& functions() {
  static const std::vector<Function> all = {
      {"read_document", read_document_file},
      {"check_document", check_document},
      {"write_document", write_document},
      {"read_points", read_points},
      {"read_response", read_response},
      {"read_record", read_record},
      {"write_files", write_files},
      {"fit_cascade", fit_cascade},
      {"fit_direct", fit_direct},
      {"fit_measured", fit_measured},
      {"fit_waveform", fit_waveform},
      {"approximate", approximate},
      {"design", design},
      {"fpaa", plan_board},
      {"spice", realise_circuit},
      {"layout", lay_out},
      {"response", respond},
      {"netlist_response", respond_netlist},
      {"simulate", simulate_model},
      {"reference", make_reference},
      {"identify", identify_model},
      {"compensate", compensate_model},
      {"diagnose", diagnose_model},
      {"yield", yield_of},
      {"run", run_project},
      {"margins", loop_margins_of},
      {"approximate_fractional", approximate_fractional},
      {"export", export_to},
      {"controller", analog_controller},
      {"fpaa_streams", plan_streams},
      {"fpaa_trim", trim_plan},
      {"sweep", sweep_model},
      {"names", names},
  };
  return all;
}

}  // namespace bodesmith::python
