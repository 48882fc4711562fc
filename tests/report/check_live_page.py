"""Drives the page that live_page_test.cpp writes: python3 check_live_page.py PAGE.html. Prints what is not as it should be.

The page holds three choices, the second of them chosen, and: figure 0 "Gain" and "Phase" over 1 Hz to 1 kHz, 31 logarithmic points, traces line (20 log10 f dB; -f/10
degrees) and marks (at 10 and 100 Hz, 3 dB higher); figure 1 "Noise" over 10 Hz to 10 kHz; figure 2 a circle, y over x.
"""

import math
import sys

from browser import Browser

failures = []


def expect(what, wanted, got):
    if wanted != got:
        failures.append(f"{what}: expected {wanted!r}, got {got!r}")


def expect_near(what, wanted, got, within):
    if got is None or abs(wanted - got) > within:
        failures.append(f"{what}: expected {wanted} within {within}, got {got}")


def plot(figure, index):
    return f"bodesmith.figures[{figure}].plots[{index}]"


def view(page, figure, index, axis="x"):
    return page.js(f"{plot(figure, index)}.view.{axis}")


def press(page, figure, index, text):
    page.click(f"[...{plot(figure, index)}.host.parentElement.querySelectorAll('.controls button')]"
               f".find(b => b.textContent === '{text}')")


def trace_button(figure, index, k):
    return f"{plot(figure, index)}.host.parentElement.querySelectorAll('.traces button')[{k}]"


def values(page, figure, index):
    return page.js(f"[...{plot(figure, index)}.host.parentElement.querySelectorAll('.value')].map(v => v.textContent)")


def reading(page, figure, index):
    return page.js(f"{plot(figure, index)}.host.parentElement.querySelector('.reading').textContent")


def over(page, figure, index):
    return page.place(f"{plot(figure, index)}.u.over")


def hover_reads_values_back(page):
    at = over(page, 0, 0)
    # The middle of 1 Hz to 1 kHz on a logarithmic axis is 31.6 Hz, the sample number 15 of 0 to 30.
    page.mouse("mouseMoved", at["x"], at["top"] + 20)
    page.frames()
    expect("frequency under the cursor", "frequency: 31.623 Hz", reading(page, 0, 0))
    expect("gain under the cursor", ["30 dB", "", ""], values(page, 0, 0))
    expect("phase in the linked plot", "-3.1623 degrees", values(page, 0, 1)[0])
    page.mouse("mouseMoved", at["left"] + at["width"] * 2 / 3 + 3, at["top"] + 20)
    page.frames()
    expect("mark under the cursor", ["40 dB", "43 dB"], values(page, 0, 0)[:2])
    at = over(page, 2, 0)
    whole = page.js(f"{plot(2, 0)}.u.valToPos(0.5, 'x')"), page.js(f"{plot(2, 0)}.u.valToPos(0.5, 'y')")
    page.mouse("mouseMoved", at["left"] + whole[0], at["top"] + whole[1])
    page.frames()
    expect("nothing is read inside a loop, far from it", [""], values(page, 2, 0))
    edge = page.js(f"{plot(2, 0)}.u.valToPos(0, 'x')"), page.js(f"{plot(2, 0)}.u.valToPos(1, 'y')")
    page.mouse("mouseMoved", at["left"] + edge[0] + 2, at["top"] + edge[1] + 2)
    page.frames()
    expect("top of the loop", ["1 V"], values(page, 2, 0))


def dragging_zooms_and_links(page):
    at = over(page, 0, 0)
    y = at["y"]
    page.drag(at["left"] + at["width"] / 3, y, at["left"] + at["width"] * 2 / 3, y + 1)
    for figure, index in ((0, 0), (0, 1), (1, 0)):
        low, high = view(page, figure, index)
        expect_near(f"zoomed from, plot {figure} {index}", 10, low, 0.3)
        expect_near(f"zoomed to, plot {figure} {index}", 100, high, 3)
    expect("the drag along x left y alone", page.js(f"{plot(0, 0)}.whole().y"), view(page, 0, 0, "y"))
    page.mouse("mousePressed", at["x"], y, "left", 1)
    page.mouse("mouseReleased", at["x"], y, "left", 1)
    page.mouse("mousePressed", at["x"], y, "left", 2)
    page.mouse("mouseReleased", at["x"], y, "left", 2)
    page.frames()
    expect("whole after a double click", [1, 1000], view(page, 0, 0))
    expect("whole in the other figure", [10, 10000], view(page, 1, 0))
    page.click("document.querySelector('.tools input')")
    press(page, 0, 0, "+")
    expect("unlinked figure stays", [10, 10000], view(page, 1, 0))
    expect("linked plot of the same figure follows", view(page, 0, 0), view(page, 0, 1))
    if not view(page, 0, 0)[1] < 1000:
        failures.append("the button + does not zoom")
    press(page, 0, 0, "whole")
    page.click("document.querySelector('.tools input')")


def traces_are_switches(page):
    button = trace_button(0, 0, 0)
    expect("on at first", "true", page.js(button + ".getAttribute('aria-pressed')"))
    expect("a trace that begins hidden", "false", page.js(trace_button(0, 0, 2) + ".getAttribute('aria-pressed')"))
    page.click(button)
    expect("off", ["false", False],
           page.js(f"[{button}.getAttribute('aria-pressed'), {plot(0, 0)}.u.series[1].show]"))
    page.click(button)
    expect("on again", True, page.js(f"{plot(0, 0)}.u.series[1].show"))
    expect("the view stays", [1, 1000], view(page, 0, 0))


def axes_become_linear(page):
    press(page, 0, 0, "log x")
    expect("both plots of the figure", [1, 1], page.js(f"[0, 1].map(i => bodesmith.figures[0].plots[i].u.scales.x.distr)"))
    expect_near("decades are no longer equally wide", 0.01 * over(page, 0, 0)["width"],
                page.js(f"{plot(0, 0)}.u.valToPos(11, 'x') - {plot(0, 0)}.u.valToPos(1, 'x')"), 6)
    press(page, 0, 0, "log x")
    expect("logarithmic again", [1, 1000], view(page, 0, 0))
    expect("decibels have no logarithm", True,
           page.js(f"{plot(0, 1)}.logSwitches.y.disabled"))


def lines_stand_at_round_numbers(page):
    # Ranges that begin anywhere: uPlot's own lines of logarithmic axes never end there.
    for view, wanted in (("[0.00999999, 5000]", ["0.01", "0.1", "1", "10", "100", "1k"]), ("[9.98, 101]", ["10", "20", "50", "100"]),
                         ("[33, 41]", ["34", "36", "38", "40"]), ("[1e-20, 1e20]", None)):
        page.js(f"{plot(1, 0)}.setView({{x: {view}}}, false)")
        page.frames()
        numbers = page.js(f"{plot(1, 0)}.u.axes[0]._values.filter(text => text !== '')")
        if wanted:
            expect("numbers of the axis over " + view, wanted, numbers)
        elif not 5 <= len(numbers) <= 15:
            failures.append(f"{len(numbers)} numbers on the axis over {view}")
    page.js(f"{plot(1, 0)}.showWhole()")


def csv_is_copied(page):
    page.js("Object.defineProperty(navigator, 'clipboard', {value: {writeText: async t => { window.copied = t; }}})")
    press(page, 0, 0, "copy CSV")
    page.wait("window.copied")
    lines = page.js("window.copied").split("\n")
    expect("CSV head", "frequency_hz,line_db,marks_db", lines[0])
    expect("CSV rows", 31, len(lines) - 2)
    for line in lines[1:-1]:
        frequency, gain, mark = line.split(",")
        expect_near("gain at " + frequency, 20 * math.log10(float(frequency)), float(gain), 1e-5)
        expect("mark at " + frequency, {10.0: "23", 100.0: "43"}.get(float(frequency), ""), mark)
    expect("said", "31 rows are in the clipboard.", page.js("bodesmith.figures[0].said.textContent"))


def keys_walk_and_zoom(page):
    page.js(f"{plot(0, 0)}.u.setCursor({{left: -10, top: -10}}); {plot(0, 0)}.host.focus()")
    for key in ("Home", "ArrowRight", "ArrowRight"):
        page.key(key)
    expect("spoken", "line: 1.5849 Hz, 4 dB", page.js("bodesmith.figures[0].said.textContent"))
    expect("shown too", "4 dB", values(page, 0, 0)[0])
    page.key("ArrowDown")
    expect("the other trace's nearest", "marks: 10 Hz, 23 dB", page.js("bodesmith.figures[0].said.textContent"))
    page.key("+", "+")
    low, high = view(page, 0, 0)
    if not (low > 1 or high < 1000):
        failures.append("the key + does not zoom")
    page.key("0", "0")
    expect("0 shows everything", [1, 1000], view(page, 0, 0))
    page.key("Escape")
    expect("Escape clears", ["", "", ""], values(page, 0, 0))


def data_on_demand(page):
    page.click(f"{plot(0, 0)}.host.parentElement.querySelector('summary')")
    head, rows = page.js(f"(t => [[...t.tHead.rows[0].cells].map(c => c.textContent), t.tBodies[0].rows.length])"
                         f"({plot(0, 0)}.host.parentElement.querySelector('details table'))")
    expect("head of the table", ["frequency_hz", "line_db", "marks_db"], head)
    expect("rows of the table", 31, rows)


def text_stays_text(page):
    expect("no script out of the data", None, page.js("window.bad ?? null"))
    expect("the name as it is", "</script><script>window.bad = 1</script>",
           page.js(trace_button(1, 0, 0) + ".textContent"))


def the_policy_holds(page):
    page.js("(() => { const s = document.createElement('script'); s.textContent = 'window.bad = 2'; document.body.append(s); })()")
    expect("an inline script that is not the page's own", None, page.js("window.bad ?? null"))
    expect("a request", "refused", page.js("fetch('http://127.0.0.1:9/').then(() => 'sent', () => 'refused')"))


def a_row_is_chosen(page):
    chosen = "document.querySelector('.chosen')"
    plot = "bodesmith.choices[0].figure.plots[0]"
    expect("chosen at first", [1, "choice 2", "2 dB"],
           page.js(f"[bodesmith.choices[0].chosen, {chosen}.querySelector('h3').textContent, "
                   f"{chosen}.querySelector('.key b').textContent]"))
    expect("markup in a note stays text", "<b>not bold</b>", page.js(f"{chosen}.querySelector('.warning').textContent"))
    page.js(f"{plot}.setView({{x: [10, 100]}}, false)")
    page.click("document.querySelectorAll('.choices tbody tr')[2].cells[0]")
    expect("the third one's table", "3 kΩ", page.js(f"{chosen}.querySelector('td:nth-child(2)').textContent"))
    expect("its note is gone", None, page.js(f"{chosen}.querySelector('.warning')"))
    expect("its gain at 10 Hz", 60, page.js(f"{plot}.u.data[1][1][10]"))
    expect("the zoom stays, the other axis fits", [10, 100, True],
           page.js(f"[...{plot}.view.x, {plot}.view.y[1] > 180]"))
    page.js("document.querySelectorAll('.choices input')[2].focus()")
    page.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowUp", code="ArrowUp", windowsVirtualKeyCode=38)
    page.frames()
    expect("an arrow key chooses the row above", [1, "choice 2 is shown below."],
           page.js(f"[bodesmith.choices[0].chosen, {chosen}.querySelector('.spoken').textContent]"))


def light_and_dark(page):
    ground = "getComputedStyle(document.body).backgroundColor"
    page.scheme(True)
    page.frames()
    dark = page.js(ground)
    expect("dark by the system", "rgb(18, 22, 27)", dark)
    page.js("(c => { c.value = 'light'; c.dispatchEvent(new Event('change')); })(document.querySelector('#theme'))")
    expect("light by choice", "rgb(244, 245, 247)", page.js(ground))
    for theme in ("light", "dark"):
        page.js(f"(c => {{ c.value = '{theme}'; c.dispatchEvent(new Event('change')); }})(document.querySelector('#theme'))")
        for name, on, least in [("--text", "--card", 4.5), ("--muted", "--card", 4.5), ("--muted", "--ground", 4.5),
                                ("--link", "--card", 4.5), ("--head-muted", "--head", 4.5), ("--text", "--warn", 4.5),
                                ("--text", "--chosen", 4.5), ("--strong", "--card", 4.5),
                                *[(f"--trace-{i}", "--card", 3.0) for i in range(8)]]:
            ratio = page.js(CONTRAST + f"('{name}', '{on}')")
            if "-v" in sys.argv:
                print(f"{theme} {name} on {on}: {ratio:.2f}")
            if ratio < least:
                failures.append(f"contrast of {name} on {on}, {theme}: {ratio:.2f}, expected {least}")
    page.js("(c => { c.value = 'auto'; c.dispatchEvent(new Event('change')); })(document.querySelector('#theme'))")
    page.scheme(False)


# Relative luminance and contrast of two colours given as #rrggbb (WCAG 2.2).
CONTRAST = """((a, b) => {
  const light = name => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const [r, g, b] = [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16) / 255)
        .map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const [high, low] = [light(a), light(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
})"""


def what_a_screen_reader_finds(page):
    nodes = page.call("Accessibility.getFullAXTree")["nodes"]
    named = lambda role: [n.get("name", {}).get("value", "") for n in nodes if n.get("role", {}).get("value") == role]
    expect("plots", 5, len([name for name in named("application") if " over " in name]))
    for role in ("button", "application", "link", "combobox", "checkbox"):
        if "" in named(role):
            failures.append(f"a {role} without a name")


def paper_and_no_scripts(page, url):
    shown = "[getComputedStyle(document.querySelector('.plots .live')).display !== 'none', " \
            "getComputedStyle(document.querySelector('.plots .still')).display !== 'none']"
    expect("on the screen the live plot", [True, False], page.js(shown))
    page.scheme(True, "print")
    expect("on paper the drawing", [False, True], page.js(shown))
    expect("on paper light", "rgb(255, 255, 255)", page.js("getComputedStyle(document.body).backgroundColor"))
    page.scheme(False)
    page.call("Emulation.setScriptExecutionDisabled", value=True)
    page.open(url, scripts=False)
    expect("without scripts the drawing", [False, True], page.js(shown))
    page.call("Emulation.setScriptExecutionDisabled", value=False)


def main():
    url = "file://" + sys.argv[1]
    with Browser() as page:
        page.open(url)
        expect("size of the figures", 3, page.js("bodesmith.figures.length"))
        for check in (lines_stand_at_round_numbers, hover_reads_values_back, dragging_zooms_and_links, traces_are_switches, axes_become_linear,
                      csv_is_copied, keys_walk_and_zoom, data_on_demand, text_stays_text, a_row_is_chosen, light_and_dark,
                      what_a_screen_reader_finds):
            check(page)
        said, asked = page.errors_and_requests()
        expect("errors of the page", [], said)
        expect("addresses asked for", {url}, set(asked))
        the_policy_holds(page)
        page.open(url, width=400)
        expect("nothing wider than a phone", 400, page.js("document.documentElement.scrollWidth"))
        paper_and_no_scripts(page, url)
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
