#pragma once

#include "call.hpp"

/// One function a command; the table in functions.cpp names them for Python.
namespace bodesmith::python {

Answer read_document_file(const Call& call);
Answer check_document(const Call& call);
Answer write_document(const Call& call);
Answer read_points(const Call& call);
Answer read_response(const Call& call);
Answer read_record(const Call& call);
Answer write_files(const Call& call);

Answer fit_cascade(const Call& call);
Answer fit_direct(const Call& call);
Answer fit_measured(const Call& call);
Answer fit_waveform(const Call& call);
Answer approximate(const Call& call);
Answer design(const Call& call);
Answer plan_board(const Call& call);
Answer realise_circuit(const Call& call);
Answer lay_out(const Call& call);
Answer respond(const Call& call);
Answer respond_netlist(const Call& call);
Answer simulate_model(const Call& call);
Answer make_reference(const Call& call);
Answer identify_model(const Call& call);
Answer compensate_model(const Call& call);
Answer diagnose_model(const Call& call);
Answer yield_of(const Call& call);
Answer run_project(const Call& call);
Answer loop_margins_of(const Call& call);
Answer approximate_fractional(const Call& call);
Answer export_to(const Call& call);
Answer analog_controller(const Call& call);
Answer plan_streams(const Call& call);
Answer trim_plan(const Call& call);
Answer sweep_model(const Call& call);
Answer names(const Call& call);

const std::vector<Function>& functions();

}  // namespace bodesmith::python
