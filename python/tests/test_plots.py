"""Each result draws itself in one call."""

from __future__ import annotations

import numpy as np
import pytest

import bodesmith as bs


def first_line(figure, axes=0):
    return figure.axes[axes].get_lines()[0].get_xydata()


def test_bode_plot_shows_the_responses(cascade, sections):
    f = np.geomspace(1, 100, 20)
    figure = bs.plot_bode(cascade, sections, frequency_hz=f)
    assert first_line(figure)[:, 1] == pytest.approx(cascade.at(f).magnitude_db)
    assert first_line(figure, 1)[:, 1] == pytest.approx(cascade.at(f).phase_deg)
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["cascade", "sections"]
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_results_draw_themselves(cascade, sections, plan, points, disturbance):
    wanted = cascade.plot().axes[0].get_lines()[-1].get_xydata()
    assert wanted[:, 0] == pytest.approx(points.frequency_hz[1:])
    assert len(plan.plot(sections).axes[0].get_lines()) == 3
    assert len(bs.layout(disturbance).plot().axes[0].patches) > 3
    statistics = bs.yield_(sections, samples=50)
    assert first_line(statistics.plot())[:, 1] == pytest.approx(statistics.designs[0]["magnitude_db"]["p50"])


def test_signals_draw_themselves():
    u = bs.reference("sine", frequency_hz=2.0, duration_s=1.0, step_s=5e-3)
    model = disturbance_like()
    run = bs.simulate(model, u)
    assert run.plot().axes[0].get_lines()[1].get_ydata() == pytest.approx(run.y)
    drive = bs.compensate(model, u)
    assert drive.plot().axes[1].get_lines()[0].get_ydata() == pytest.approx(drive.predicted - drive.reference)
    found = bs.identify(run.record, "linear")
    difference = found.plot().axes[1].get_lines()[0].get_ydata()
    assert np.sqrt(np.mean(difference**2)) == pytest.approx(found.training["rms"], rel=1e-6)


def disturbance_like():
    return bs.Disturbance([0.35, -0.64, 0.29], [-0.24, 0.08, 0.16]).model()
