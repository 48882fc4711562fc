#!/usr/bin/env python3
"""Draws docs/report.png: the alternatives of a run's page with the cursor on a plot. Wants chromium.

    docs/make_report_picture.py out/nanopositioner/report.html
"""

import base64
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "report"))
from browser import Browser  # noqa: E402

with Browser() as page:
    page.open("file://" + str(pathlib.Path(sys.argv[1]).resolve()), width=900)
    page.click("document.querySelectorAll('.choices > .wide tbody tr')[5].cells[1]")
    at = page.place("bodesmith.choices[0].figure.plots[0].u.over")
    page.mouse("mouseMoved", at["left"] + 0.62 * at["width"], at["y"])
    page.frames()
    top, bottom = page.js("""[document.querySelector('.choices').getBoundingClientRect().top + scrollY,
        bodesmith.choices[0].figure.plots[0].host.parentElement.getBoundingClientRect().bottom + scrollY]""")
    clip = {"x": 0, "y": top - 10, "width": 900, "height": bottom - top, "scale": 1}
    shot = page.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)
    (ROOT / "docs" / "report.png").write_bytes(base64.b64decode(shot["data"]))
