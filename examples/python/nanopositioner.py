"""The nanopositioner's compensator in Python, from measured gains to hardware, cell by cell.

    python3 nanopositioner.py [FOLDER]        what it makes goes to FOLDER (out/python)

Every `# %%` begins a cell for editors and notebooks that know them.
"""

# %%
from __future__ import annotations

import pathlib
import sys

import numpy as np

import bodesmith as bs

EXAMPLE = pathlib.Path(__file__).resolve().parents[1] / "nanopositioner"


def main(folder: pathlib.Path) -> dict[str, float]:
    figures: dict[str, float] = {}

    # %% Gains of the descending disturbance at five frequencies, relative to 1 Hz.
    points = bs.read_points(EXAMPLE / "gains.csv")
    print(np.column_stack([points.frequency_hz, points.gain]))

    # %% A cascade of fractional compensators ((λs+1)/(xλs+1))^β through them.
    cascade = bs.fit_cascade(points)
    cascade.save(folder / "cascade.json")
    figures["fit_max_db"] = cascade.fit["max_db"]
    print(cascade)

    # %% Integer sections that stay within 0.05 dB of it at every frequency.
    sections = bs.approximate(cascade, max_error_db=0.05)
    sections.save(folder / "sections.json")
    figures["approximation_db"] = sections.error["everywhere_max_magnitude_db"]
    print(sections)

    # %% The same sections on an FPAA board, as it runs …
    plan = bs.fpaa(sections)
    plan.write(folder / "fpaa")
    figures["fpaa_percent"] = plan.error_with_delays["max_complex_percent"]
    print(plan)

    # %% … and around op-amps, with E96 resistors and E12 capacitors.
    circuit = bs.spice(sections)
    circuit.write(folder / "spice")
    figures["circuit_db"] = circuit.error["all"]["max_magnitude_db"]
    print(circuit)

    # %% What the tolerances of the parts do to it.
    statistics = bs.yield_([sections, plan], names=["op-amps", "FPAA"], samples=2000)
    for one in statistics.designs:
        print(f"{one['name']}: 95 of 100 within {one['worst_db']['p95']:.3g} dB")

    # %% The disturbance generator in multipliers and a switch.
    disturbance = bs.Disturbance.load(EXAMPLE / "disturbance.json")
    layout = bs.layout(disturbance)
    layout.write(folder / "layout")
    print(layout)

    # %% All responses in one plot.
    f = bs.log_grid(0.5, 300.0)
    responses = bs.bode(cascade, sections, plan, frequency_hz=f)
    responses.plot().savefig(folder / "bode.svg")
    worst = np.max(np.abs(responses["plan"].response / responses["cascade"].response - 1.0))
    print(f"board against cascade: {100 * worst:.3g} % at most")

    # %% A stage with this hysteresis behind an amplifier of 2 kHz: a triangle of full stroke at 10 Hz, driven without …
    stage = bs.Model([{"type": "lowpass", "corner_hz": 2000.0}, *disturbance.model().blocks])
    wanted = bs.reference("triangle", frequency_hz=10.0, duration_s=0.4, step_s=2e-4)
    raw = bs.simulate(stage, wanted, start="equilibrium")
    span = np.ptp(wanted.u)
    figures["uncompensated_percent"] = 100 * float(np.sqrt(np.mean((raw.y - wanted.u) ** 2))) / span

    # %% … and with compensation.
    drive = bs.compensate(stage, wanted)
    figures["tracking_percent"] = drive.predicted_error["rms_percent_of_range"]
    print(f"rms {figures['uncompensated_percent']:.3g} % of range without, {figures['tracking_percent']:.3g} % with compensation")
    drive.plot().savefig(folder / "drive.svg")

    # %% The whole project with its report (half a minute): bs.run(EXAMPLE / "project.toml", folder / "project")
    return figures


if __name__ == "__main__":
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/python")
    out.mkdir(parents=True, exist_ok=True)
    for name, value in main(out).items():
        print(f"{name}: {value:.3g}")
