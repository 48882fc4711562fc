#!/usr/bin/env python3
"""Direct fits against Octave's invfreqs (package signal) on the same points, in one run.

Usage: docs/compare_octave.py [path of bodesmith]     (needs octave and octave-signal)

invfreqs fits a complex response by least squares, so it is given the exact minimum-phase response of each curve;
bodesmith is given the magnitudes alone. Both are judged by the largest miss in dB at the points.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/bin/bodesmith")

OCTAVE = """
pkg load signal
warning('off', 'all');
s = 1i*w;
%s
for n = [%s]
  %% weights 1/|H|^2 make the fit relative; iterations as Sanathanan and Koerner
  scale = sqrt(w(1)*w(end));
  [b, a] = invfreqs(H, w/scale, n, n, 1./abs(H).^2, 30);
  G = polyval(b, s/scale) ./ polyval(a, s/scale);
  p = roots(a);
  printf('%%d %%.6g %%d\\n', n, max(abs(20*log10(abs(G./H)))), all(real(p) < 0));
end
"""

CURVES = {
    "RIAA playback": ("riaa", "H = (1+318e-6*s)./((1+3180e-6*s).*(1+75e-6*s));", [2, 4]),
    "A-weighting": ("a_weighting", "H = s.^4./((s+129.4).^2.*(s+676.7).*(s+4636).*(s+76655).^2);", [4, 6]),
    "pink noise slope": ("pink_noise", "H = s.^-0.5;", [4, 6, 8]),
}


def main():
    print("| curve | order | bodesmith fit --direct, dB | invfreqs, dB | invfreqs stable |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, (example, response, orders) in CURVES.items():
            points = ROOT / "examples" / example / "points.csv"
            rows = [line for line in points.read_text().splitlines() if line and not line.startswith("#")][1:]
            w = [2 * math.pi * float(row.split(",")[0]) for row in rows]
            script = "w = [" + ";".join(repr(x) for x in w) + "];\n" + OCTAVE % (response, " ".join(map(str, orders)))
            done = subprocess.run(["octave", "--quiet", "--no-gui", "--eval", script], capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(done.stderr)
            peer = {int(n): (float(db), stable == "1") for n, db, stable in map(str.split, done.stdout.split("\n")[:-1])}
            for order in orders:
                out = pathlib.Path(folder) / "sections.json"
                subprocess.run([PROGRAM, "fit", points, "--direct", "--order", str(order), "-o", out], check=True,
                               capture_output=True)
                sections = json.loads(out.read_text())
                db = sections["error"]["max_magnitude_db"]
                print(f"| {name} | {order} | {db:.3g} | {peer[order][0]:.3g} | {'yes' if peer[order][1] else 'no'} |")


main()
