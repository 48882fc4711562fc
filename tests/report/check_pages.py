"""Opens a page as a reader would: python3 check_pages.py PAGE.html [RUN.json]. Prints what is not as it should be.

Every plot must tell a value under the keyboard, nothing may be wider than a phone, nothing may be asked of the network. With
RUN.json the alternatives of the main example are chosen one by one, and what the page says of each is compared with that file.
"""

import json
import sys

from browser import Browser

failures = []


def expect(what, wanted, got):
    if wanted != got:
        failures.append(f"{what}: expected {wanted!r}, got {got!r}")


def every_plot_is_read(page):
    names = page.js("bodesmith.links.plots.map(one => one.plot.data.title)")
    if not names:
        failures.append("no plot is live")
    for i, name in enumerate(names):
        page.js(f"bodesmith.links.plots[{i}].plot.host.focus()")
        page.key("Home")
        values = page.js(f"bodesmith.links.plots[{i}].plot.legend.values.map(field => field.textContent)")
        if not any(values):
            failures.append(f"plot {i} ({name}) tells no value")
        drawn = page.js(f"""(canvas => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data
                         .some(byte => byte !== 0))(bodesmith.links.plots[{i}].plot.host.querySelector('canvas'))""")
        expect(f"plot {i} ({name}) is drawn", True, drawn)


def near(what, wanted, text, digits=3):
    """A number at the start of a text against one from run.json, as far as the text says it."""
    got = float(text.split()[0])
    if abs(got - wanted) > 0.51 * 10 ** (-digits) * max(abs(wanted), 10 ** digits * 1e-12):
        if f"{wanted:.{digits}g}" != f"{got:.{digits}g}":
            failures.append(f"{what}: expected {wanted}, got {text}")


def choose_every_alternative(page, run):
    tracked = [f"{f:g}" for f in run["tracking"]["frequency_hz"]]
    rows = "document.querySelectorAll('.choices > .wide tbody tr')"
    expect("alternatives", len(run["alternatives"]), page.js(rows + ".length"))
    built = [one["built"] for one in run["alternatives"]].index(True)
    expect("shown at first", built, page.js("bodesmith.choices[0].chosen"))
    for i, one in enumerate(run["alternatives"]):
        page.click(f"{rows}[{i}].cells[1]")
        expect("chosen", [i, True], page.js(f"[bodesmith.choices[0].chosen, {rows}[{i}].querySelector('input').checked]"))
        shown = page.js("""({name: document.querySelector('.chosen h3').textContent,
            figures: [...document.querySelectorAll('.chosen .key div')].map(card => [...card.children].map(c => c.textContent)),
            tables: [...document.querySelectorAll('.chosen .wide table')].filter(t => t.caption).map(t => [t.caption.textContent,
                [...t.tBodies[0].rows].map(row => [...row.cells].map(c => c.textContent))])})""")
        expect("its name", one["name"] + (" (built)" if one["built"] else ""), shown["name"])
        figures = {meaning: value for value, meaning in shown["figures"]}
        near("error at the points of " + one["name"], one["points_max_db"], figures["largest error at the points"])
        tables = dict(shown["tables"])
        stages = {row[0]: row for row in tables["Error budget"]}
        for stage in one["budget"]:
            row = stages[stage["stage"]]
            near(f"waveform of {one['name']}, {stage['stage']}", round(stage["waveform"]["rms_percent"], 3), row[6])
            if stage["against"]:
                near(f"dB of {one['name']}, {stage['stage']}", stage["max_magnitude_db"], row[2])
        got = tables["Tracking in percent of the range"]
        expect("tracked frequencies", tracked, [row[0] for row in got])
        for row, percent in zip(got, one["tracked_at_percent"]):
            expect(f"tracking of {one['name']} at {row[0]} Hz", "does not settle" if percent is None else f"{percent:.3f}", row[1])
        circuit = one["hardware"]["circuit"]
        expect("parts of " + one["name"], circuit["parts"] if circuit else 0, len(tables.get("Parts", [])))
        # The response in the plot, at its first frequency, against the sections in bode.csv's manner: of the built one.
        names = page.js("bodesmith.choices[0].figure.plots[0].traces.map(trace => trace.name)")
        if "sections" not in names:
            failures.append(f"no response of {one['name']}")


def main():
    url = "file://" + sys.argv[1]
    with Browser() as page:
        page.open(url)
        every_plot_is_read(page)
        if len(sys.argv) > 2:
            with open(sys.argv[2], encoding="utf-8") as file:
                choose_every_alternative(page, json.load(file))
        page.open(url, width=400, dark=True)
        expect("nothing wider than a phone", 400, page.js("document.documentElement.scrollWidth"))
        said, asked = page.errors_and_requests()
        expect("errors of the page", [], said)
        expect("addresses asked for", {url}, set(asked))
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
