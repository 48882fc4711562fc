#!/usr/bin/env python3
"""Drawings that stand in a page look as their own files do: one element after another has the same style and place.

    check_drawings.py PAGE.html DRAWING.svg [DRAWING.svg ...]

Styles and ids of one drawing must not reach another. Compared are the styles that a browser works out and the boxes in
each drawing's own units, not pictures: a browser smooths edges a shade otherwise from one picture to the next.
"""

import os
import sys

from browser import Browser

STYLES = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-opacity",
          "opacity", "display", "visibility", "marker-start", "marker-end", "clip-path", "transform"]
OF_TEXT = ["font-family", "font-size", "font-weight", "font-style", "text-anchor", "dominant-baseline", "letter-spacing"]
# Every drawing of a document: its elements' names, boxes and everything that makes them look so. An id that a style points
# at is one of the same drawing, or a stranger's.
READ = """[...document.querySelectorAll('svg')].map(svg => [...svg.querySelectorAll('*')].filter(e => e.getBBox).map(e => {
  const style = getComputedStyle(e), text = e.tagName == 'text' || e.tagName == 'tspan';
  const box = e instanceof SVGGeometryElement ? e.getBBox() : {};  // letters' own follow the scale of the screen
  const looks = (text ? %s : %s).map(name => {
    const value = style.getPropertyValue(name), id = /url\\("?#([^")]*)"?\\)/.exec(value);
    return name + ': ' + (id ? (svg.querySelector('[id="' + id[1] + '"]') ? 'its own' : 'a stranger') : value);
  });
  return {what: e.tagName + ' ' + e.textContent.slice(0, 40), looks, box: [box.x, box.y, box.width, box.height]};
}))""" % (STYLES + OF_TEXT, STYLES)


def names(drawing):
    return [element["what"] for element in drawing]


def main():
    wrong = []
    with Browser() as page:
        page.open("file://" + os.path.abspath(sys.argv[1]))
        shown = page.js(READ)
        for file in sys.argv[2:]:
            page.open("file://" + os.path.abspath(file))
            own = page.js(READ)[0]
            there = [drawing for drawing in shown if names(drawing) == names(own)]
            if not own or not there:
                wrong.append(f"{file}: no drawing of the page has its {len(own)} elements")
            for got, wanted in zip(there[0] if there else [], own):
                other = [f"{a} ({b})" for a, b in zip(got["looks"], wanted["looks"]) if a != b]
                if got["box"] != wanted["box"]:
                    other.append(f"box {got['box']} ({wanted['box']})")
                if other:
                    wrong.append(f"{file}: {wanted['what']}: {'; '.join(other)}")
    print("\n".join(wrong[:20]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
