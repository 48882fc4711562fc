#pragma once

/// Start here. Every job is a value in and a value out; this header has the first call of each, and its own header says the
/// rest. Frequencies are Hertz or RadPerSecond (base/units.hpp), gains are plain numbers, levels end in _db.
///
///     bodesmith::Provenance from;  // the files that were read, and as what
///     const auto points = bodesmith::BodePoints::read_csv("gains.csv", from);
///     const auto fit = bodesmith::fit_directly_within(points, {}, 0.3, 1, 8);             // fewest poles within 0.3 dB
///     const auto made = bodesmith::synthesis::realise(fit.sections);                        // op-amps, E96 and E24
///     const auto design = bodesmith::tolerance::design_of_circuit(made.circuit, fit.sections, "mine",
///                                                             bodesmith::tolerance::OpAmps::ideal);
///
/// What is wrong with an input is an InputError with file and line, what cannot be built a DesignError; a function that
/// returns an Outcome holds a Refusal instead, with its reason. Nothing prints, nothing writes but an OutputSet's commit().
/// tests/consumer/main.cpp is a program that uses it. Controllers for measured plants (tuning/tune.hpp) need Eigen as well.

#include "approximate/approximate.hpp"  // a cascade to sections: approximate_cascade()
#include "base/error.hpp"               // InputError, DesignError
#include "base/files.hpp"               // OutputSet
#include "chain/model_file.hpp"         // a model.toml: read_model()
#include "filters/design.hpp"           // standard filters: least_order(), place()
#include "fit/cascade/cascade_fit.hpp"  // gains to a fractional cascade: fit_cascade()
#include "fit/direct/direct_fit.hpp"    // gains to sections: fit_directly(), fit_directly_within()
#include "fpaa/plan/plan.hpp"           // sections to a board: make_plan()
#include "gap/diagnosis.hpp"            // what a model is missing: diagnose()
#include "lti/judge_responses.hpp"      // one response against another over a band: judge_responses()
#include "lti/loop_margins.hpp"         // gain and phase margin: loop_margins()
#include "signal/bode_points.hpp"       // gains, from files of any program: BodePoints
#include "signal/time_record.hpp"       // records in time: TimeRecord
#include "simulate/simulate.hpp"        // a model's answer to an input: simulate()
#include "synthesis/realise.hpp"        // sections to op-amps: realise()
#include "tolerance/margins.hpp"        // a loop's margins over tolerances: study_loop()
#include "tolerance/yield.hpp"          // tolerances: run_monte_carlo()
