"""From target Bode magnitudes, or measured records of a piezo stage, to checked analog hardware.

    import bodesmith as bs
    points = bs.read_points("gains.csv")
    cascade = bs.fit_cascade(points)                   # G(s) = gain Π((λs+1)/(xλs+1))^β
    sections = bs.approximate(cascade, max_error_db=0.05)
    plan = bs.fpaa(sections); plan.write("fpaa")       # or bs.spice(sections).write("spice")
    bs.plot_bode(cascade, sections, plan)

Frequencies are in Hz and their names end in _hz; other units stand at the end of names too (_s, _db, _deg, _rad_s). What is
given wrongly raises InputError (with .file and .line), what cannot be made DesignError; a limit that is not met is data.
Long work lets other threads run, ends at Ctrl-C and tells `progress` (a callable) its fraction.
"""

from __future__ import annotations

from ._core import version as __version__
from .controllers import Controller, Streams, controller, streams, trim
from .errors import BodesmithWarning, DesignError, InputError
from .exchange import export
from .fitting import (
    BodePoints,
    approximate,
    approximate_fractional,
    design,
    families,
    fit,
    fit_cascade,
    fit_direct,
    fit_measured,
    fit_waveform,
    methods,
    read_points,
)
from .hardware import Circuit, Layout, Plan, fpaa, layout, spice
from .loops import Margins, margins
from .lti import Cascade, Sections
from .models import Disturbance, Model, Record, read_record, reference
from .plots import plot_bode
from .project import run
from .responses import Bode, FrequencyResponse, bode, log_grid, read_response, response_of
from .signals import (
    Comparison,
    Diagnosis,
    Drive,
    Identification,
    Simulation,
    Sweep,
    compare_models,
    compensate,
    diagnose,
    hysteresis_models,
    identify,
    simulate,
    sweep,
)
from .tolerance import Yield, yield_

__all__ = [
    "Bode",
    "BodePoints",
    "BodesmithWarning",
    "Cascade",
    "Circuit",
    "Comparison",
    "Controller",
    "DesignError",
    "Diagnosis",
    "Disturbance",
    "Drive",
    "FrequencyResponse",
    "Identification",
    "InputError",
    "Layout",
    "Margins",
    "Model",
    "Plan",
    "Record",
    "Sections",
    "Simulation",
    "Streams",
    "Sweep",
    "Yield",
    "__version__",
    "approximate",
    "approximate_fractional",
    "bode",
    "compare_models",
    "compensate",
    "controller",
    "design",
    "diagnose",
    "export",
    "families",
    "fit",
    "fit_cascade",
    "fit_direct",
    "fit_measured",
    "fit_waveform",
    "fpaa",
    "hysteresis_models",
    "identify",
    "layout",
    "log_grid",
    "margins",
    "methods",
    "plot_bode",
    "read_points",
    "read_record",
    "read_response",
    "reference",
    "response_of",
    "run",
    "simulate",
    "spice",
    "streams",
    "sweep",
    "trim",
    "yield_",
]
