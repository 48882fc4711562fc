"""To python-control: with the module where it is installed, and in any case with a stand-in that keeps what it is given."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest

import bodesmith as bs


class Kept:
    def __init__(self, *arguments):
        self.arguments = arguments


@pytest.fixture
def stand_in(monkeypatch):
    module = types.ModuleType("control")
    module.StateSpace = module.FrequencyResponseData = module.TransferFunction = Kept
    module.pade = lambda delay, order: ([delay], [order])
    module.series = lambda *systems: systems
    monkeypatch.setitem(sys.modules, "control", module)
    return module


def state_space_response(system, f):
    a, b, c, d = system.arguments
    return np.array([(c @ np.linalg.solve(2j * np.pi * one * np.eye(len(a)) - a, b) + d)[0, 0] for one in f])


@pytest.mark.parametrize(
    "sections",
    [
        bs.design("bandpass", family="elliptic", order=5, corner_hz=(900.0, 1100.0)),
        bs.design("highpass", family="butterworth", order=3, corner_hz=1e-3),
        bs.Sections([(2.0, [-1.0, -1e6], [-10.0, -1e5]), (5.0, [], [-3 + 4j, -3 - 4j])], gain=-0.5),
        bs.Sections([], gain=3.0),
    ],
)
def test_state_space_responds_as_the_sections(stand_in, sections):
    f = np.geomspace(1e-4, 1e6, 60)
    wanted = sections.response(f)
    assert state_space_response(sections.to_control(), f) == pytest.approx(wanted, rel=1e-7, abs=1e-12 * np.abs(wanted).max())


def test_frd_is_in_rad_s(stand_in):
    sections = bs.design("lowpass", order=2, corner_hz=10.0)
    response, omega = sections.to_frd([1.0, 10.0]).arguments
    assert omega == pytest.approx([2 * np.pi, 20 * np.pi])
    assert response == pytest.approx(sections.response([1.0, 10.0]))


def test_a_delay_needs_its_order(stand_in):
    sections = bs.Sections([(1.0, [], [-1.0])], delay_s=0.5)
    with pytest.raises(bs.InputError, match="pade_order"):
        sections.to_control()
    _, delay = sections.to_control(pade_order=3)
    assert delay.arguments == ([0.5], [3])


def test_with_python_control():
    control = pytest.importorskip("control", reason="python-control is not installed")
    sections = bs.design("lowpass", family="chebyshev1", order=5, corner_hz=100.0)
    f = np.geomspace(1, 1e3, 20)
    assert sections.to_control()(2j * np.pi * f) == pytest.approx(sections.response(f), rel=1e-9)
    assert isinstance(sections.to_frd(f), control.FrequencyResponseData)
