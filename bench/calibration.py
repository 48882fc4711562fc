#!/usr/bin/env python3
"""Are the probabilities of `bodesmith diagnose` right? Cases of three generators, the program's answers, and what became of them.

    bench/calibration.py draw --program build/bin/bodesmith --out DIR [--first I] [--count N] [--seconds S] [--generators 1 2 3]
    bench/calibration.py show DIR/answers.jsonl [--fit-below I]
    bench/calibration.py score DIR/answers.jsonl
    bench/calibration.py misses DIR/answers.jsonl
    bench/calibration.py stability --program build/bin/bodesmith --out DIR [--count N] [--draws M]

`draw` hides effects (hidden_effects.py, hidden_effects_too.py by turns, records of 400 to 900 samples in white, red and 1/f noise; on
demand hidden_effects_third.py) and keeps for each case the truth and, of each step, every name that was fitted with its log evidence.
`score` counts what was named, `misses` lists what was not. `show` fits the temperature of the
probabilities on the cases below I, and prints the reliability diagram, the expected calibration error and the mean log score of the
others.
"""
import argparse
import itertools
import json
import math
import os
import random
import shutil
import subprocess
import time

import hidden_effects as first
import hidden_effects_too as second
import hidden_effects_third as third


def make(i, folder, generators=(1, 2)):
    """Case number i; what is hidden, and what the case is."""
    generator = generators[i % len(generators)]
    if generator == 3:
        return third.make_case(i, folder)
    if generator == 2:
        return second.make_case(i, folder)
    kinds, base, noise, times = first.plan(f"calibration {i // 50}", 50)[i % 50]
    return first.make_case(random.Random(f"calibration {i}"), folder, kinds, base, noise, times, samples=(400, 900))


def rivals(step):
    """Names of one step, '' for none: log evidence, rms of the training records, unknowns (the last two for Schwarz' criterion)."""
    fitted = [[c["effect"], c["log_evidence"], c["train_rms_after"], len(c["parameters"])] for c in step["candidates"]
              if c["log_evidence"] is not None and c["outcome"] in ("named", "tied", "worse", "other place or form")]
    return [["", step["log_evidence_without"], step["train_rms_before"], 0]] + fitted


def training(folder):
    return [name for name in ("a.csv", "b.csv", "c.csv") if os.path.exists(f"{folder}/{name}")]


def answer(program, folder):
    t0 = os.times().children_user
    code = subprocess.run([program, "diagnose", "model.toml", "--data", *training(folder), "--holdout", "h.csv", "-o", "out", "--threads", "1"],
                          cwd=folder, capture_output=True, text=True)
    if code.returncode != 0:
        return {"failed": code.stderr[-300:]}
    d = json.load(open(folder + "/out/diagnosis.json"))
    return {"cpu_s": os.times().children_user - t0, "verdict": d["verdict"], "outside": d["outside"], "alternatives": d["alternatives"],
            "log_evidence": d["log_evidence"], "signs": d["signs_of_more"], "gap": {k: d["gap"][k] for k in ("initial", "refitted", "final")},
            "refused": [[c["effect"], c["log_evidence"], c["outcome"]] for c in d["refused"]],
            "steps": [{"effect": s["effect"], "probability": s["probability"], "tied_with": s["tied_with"], "placed": s["placed"],
                       "rivals": rivals(s)} for s in d["steps"]]}


def drawn(i, folder, generators):
    """Case number i in an empty folder; what is hidden."""
    shutil.rmtree(folder, ignore_errors=True)
    truth = make(i, folder, generators)
    truth["samples"] = sum(len(open(f"{folder}/{name}").readlines()) - 1 for name in training(folder))
    return truth


def draw(args):
    program = os.path.abspath(args.program)
    os.makedirs(args.out, exist_ok=True)
    end = time.time() + args.seconds
    with open(args.out + "/answers.jsonl", "a") as out:
        for i in range(args.first, args.first + args.count):
            if time.time() > end:
                break
            folder = f"{args.out}/case"
            truth = drawn(i, folder, args.generators)
            out.write(json.dumps({"case": i, "truth": truth, **answer(program, folder)}) + "\n")
            out.flush()


OUTSIDE = set(first.OUTSIDE)


def hidden(row):
    """Names that are right; None where something outside the catalogue acts: then none is."""
    truth = row["truth"]
    return None if truth.get("outside") or OUTSIDE.intersection(truth["kinds"]) else {*truth["kinds"], *truth.get("allowed", [])}


def told(row):
    """(name, its probability, whether it is right) of each step."""
    right = hidden(row)
    return [(s["effect"], s["probability"], right is not None and s["effect"] in right) for s in row["steps"]]


def posterior(weights):
    most = max(w for _, w in weights)
    held = {}
    for name, w in weights:
        held[name] = held.get(name, 0.0) + math.exp(w - most)
    total = sum(held.values())
    return {name: w / total for name, w in held.items()}


def schwarz(step, samples):
    """Probabilities of one step's names by Schwarz' criterion instead: white noise, the same candidates."""
    return posterior([(r[0], -samples * math.log(max(r[2], 1e-300)) - 0.5 * r[3] * math.log(samples)) for r in step["rivals"]])


def read_again(row, tempered, of_a_whole, of_a_sign):
    """The row with other constants of evidence/posterior.cpp: log evidences over `tempered`, k of the odds of outside."""
    whole = row["verdict"] in ("explained", "nothing_missing")
    k = of_a_whole if whole else of_a_sign * max(s["times_chance"] for s in row["signs"]) ** 2 if row["signs"] else 1.0
    left = row["gap"]["final"]["holdout_rms"] / row["gap"]["refitted"]["holdout_rms"] if row["steps"] else float(not whole)
    outside = max(0.01, 1.0 - 1.0 / (1.0 + k * left))
    steps = []
    for s in row["steps"]:
        names = posterior([(r[0], r[1] / tempered) for r in s["rivals"] if r[1] is not None])
        steps.append({**s, "probability": (1.0 - outside) * names.get(s["effect"], 1.0)})
    return {**row, "steps": steps, "outside": outside}


def log_score(rows):
    """Mean ln of the probability that was given to what is so, a told name each."""
    all_told = [t for r in rows for t in told(r)]
    return sum(math.log(min(max(p if right else 1.0 - p, 1e-6), 1.0)) for _, p, right in all_told) / max(1, len(all_told))


EDGES = [0.0, 0.5, 0.8, 0.9, 0.95, 0.98, 1.0001]


def diagram(rows):
    """(from, to, names, mean probability, share that is right) of each bin; expected calibration error."""
    bins, error, count = [], 0.0, 0
    for low, high in zip(EDGES, EDGES[1:]):
        inside = [(p, right) for r in rows for _, p, right in told(r) if low <= p < high]
        if inside:
            mean, share = sum(p for p, _ in inside) / len(inside), sum(right for _, right in inside) / len(inside)
            bins.append((low, min(high, 1.0), len(inside), mean, share))
            error += len(inside) * abs(mean - share)
            count += len(inside)
    return bins, error / max(1, count)


def show_one(title, rows):
    bins, error = diagram(rows)
    print(f"{title}: {len(rows)} cases, {sum(b[2] for b in bins)} names told; expected calibration error {error:.3f}, mean log score {log_score(rows):.3f}")
    print("| told | names | mean | right |\n|---|---|---|---|")
    for low, high, n, mean, share in bins:
        print(f"| {low:g} to {high:g} | {n} | {mean:.3f} | {share:.3f} |")


def show(args):
    rows = [r for r in map(json.loads, open(args.answers)) if "steps" in r]
    fitted, others = [r for r in rows if r["case"] < args.fit_below], [r for r in rows if r["case"] >= args.fit_below]
    show_one("as told, all", rows)
    if args.read:
        show_one("read with these constants, on those below", [read_again(r, *args.read) for r in fitted])
        others_read = [read_again(r, *args.read) for r in others]
        show_one("read with these constants, on the others", others_read)
    grid = itertools.product((1.0, 1.5, 2.0, 3.0, 4.0), (0.05, 0.1, 0.2, 0.35), (2.0, 4.0, 8.0))
    best = max(grid, key=lambda g: log_score([read_again(r, *g) for r in fitted]))
    print("best on those below:", dict(zip(("tempered", "of_a_whole", "of_a_sign"), best)))
    show_one("fitted, on those it was fitted on", [read_again(r, *best) for r in fitted])
    show_one("fitted, on the others", [read_again(r, *best) for r in others])
    with_rms = [r for r in others if r["steps"] and len(r["steps"][0]["rivals"][0]) > 2]
    by_schwarz = [{**r, "steps": [{**s, "probability": schwarz(s, r["truth"]["samples"]).get(s["effect"], 0.0)} for s in r["steps"]]} for r in with_rms]
    if with_rms:
        print(f"Schwarz' criterion on {len(with_rms)} of these: mean log score {log_score(by_schwarz):.3f}, error {diagram(by_schwarz)[1]:.3f}; "
              f"as told {log_score(with_rms):.3f}, fitted {log_score([read_again(r, *best) for r in with_rms]):.3f}")


def missed(row):
    """Hidden names that no step says, itself or in its tie; names of steps that say none of the hidden ones. An outsider has neither."""
    right = hidden(row)
    if right is None:
        return [], []
    given = [{s["effect"], *s["tied_with"]} for s in row["steps"]]
    return ([k for k in row["truth"]["kinds"] if not any(k in g for g in given)], [s["effect"] for s, g in zip(row["steps"], given) if not g & right])


def is_large(row, kind):
    """Whether what this effect itself adds to the training records is five times the noise and more."""
    return row["truth"]["sizes"][row["truth"]["kinds"].index(kind)] >= 5


def five_times(row):
    """Whether all of a case is; a control has nothing that is not."""
    return all(size >= 5 for size in row["truth"]["sizes"])


def wrong(row):
    """Whether a case counts against the program."""
    if hidden(row) is None:
        return row["verdict"] not in ("unexplained", "partly_explained")
    return any(missed(row)) and five_times(row)


def score(args):
    rows = [r for r in map(json.loads, open(args.answers)) if "steps" in r]
    in_catalogue = [r for r in rows if hidden(r) is not None and r["truth"]["kinds"]]
    large = [r for r in in_catalogue if five_times(r)]
    controls, outsiders = [r for r in rows if hidden(r) is not None and not r["truth"]["kinds"]], [r for r in rows if hidden(r) is None]
    share = lambda a, b: f"{a} of {b} ({a / max(1, b):.3f})"
    effects = sum(is_large(r, kind) for r in in_catalogue for kind in r["truth"]["kinds"])
    lost = sum(is_large(r, kind) for r in in_catalogue for kind in missed(r)[0])
    print(f"{len(rows)} cases; effects of five times the noise and more named {share(effects - lost, effects)}, no extra name where all are "
          f"{share(sum(not missed(r)[1] for r in large), len(large))}")
    told_of = lambda rows: share(sum(not wrong(r) for r in rows), len(rows))
    print(f"controls accused {share(sum(bool(r['steps']) for r in controls), len(controls))}, outsiders told {told_of(outsiders)}, "
          f"of five times the noise {told_of([r for r in outsiders if five_times(r)])}")
    cpu = sorted(r["cpu_s"] for r in rows)
    print(f"processor: median {cpu[len(cpu) // 2]:.2f} s, longest {cpu[-1]:.1f} s; expected calibration error {diagram(rows)[1]:.3f}, mean log score {log_score(rows):.3f}")


def misses(args):
    for row in filter(lambda r: "steps" not in r or wrong(r), map(json.loads, open(args.answers))):
        truth = row["truth"]
        gap = {k: "/".join(f"{v:.3g}" for v in (g["train_rms"], g["holdout_rms"])) for k, g in row.get("gap", {}).items()}
        told_here = [s["effect"] + "".join("|" + t for t in s["tied_with"]) + f" {s['placed']} p{s['probability']:.2f}" for s in row.get("steps", [])]
        print(f"{row['case']} {'+'.join(truth['kinds']) or truth.get('outside') or 'control'}, {truth['base']}, {truth['noise']}, x{truth['times'] or 0:.1f}: "
              f"{row.get('verdict', row.get('failed'))} {told_here}; signs {row.get('signs')}; gap {gap}; "
              + str({k: truth[k] for k in ('places', 'sizes', 'sigma', 'shapes', 'rate_hz') if k in truth}))


def said(row):
    """Names, their places and ties, and the verdict."""
    return [[s["effect"], s["placed"], sorted(s["tied_with"])] for s in row["steps"]], row["verdict"]


def moved(folder, draw, other):
    """The case with every y moved by a billionth of its range."""
    r = random.Random(f"{folder} {draw}")
    os.makedirs(other, exist_ok=True)
    shutil.copy(f"{folder}/model.toml", other)
    for name in [*training(folder), "h.csv"]:
        lines = open(f"{folder}/{name}").readlines()
        rows = [[float(v) for v in line.split(",")] for line in lines[1:]]
        size = max(row[2] for row in rows) - min(row[2] for row in rows)
        with open(f"{other}/{name}", "w") as f:
            f.write(lines[0])
            f.writelines(f"{t:.12g},{u:.12g},{y + 1e-9 * size * r.gauss(0, 1):.15g}\n" for t, u, y in rows)


def stability(args):
    """Of drawn cases the share whose names, places, ties and verdict stay when y moves by a billionth of its range; answers are kept as by draw."""
    program, folder = os.path.abspath(args.program), f"{args.out}/stability"
    same = draws = 0
    os.makedirs(args.out, exist_ok=True)
    with open(args.out + "/answers.jsonl", "a") as out:
        for i in range(args.first, args.first + args.count):
            truth = drawn(i, folder, args.generators)
            row = {"case": i, "truth": truth, **answer(program, folder)}
            out.write(json.dumps(row) + "\n")
            out.flush()
            for draw in range(args.draws):
                moved(folder, draw, folder + "/moved")
                got = said(answer(program, folder + "/moved"))
                draws += 1
                same += got == said(row)
                if got != said(row):
                    print(i, truth["kinds"], truth["base"], said(row), got, flush=True)
            print(f"{same} of {draws} draws over {i - args.first + 1} cases the same", flush=True)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = p.add_subparsers(required=True)
    d = sub.add_parser("draw")
    d.add_argument("--program", required=True)
    d.add_argument("--out", required=True)
    d.add_argument("--first", type=int, default=0)
    d.add_argument("--count", type=int, default=10**6)
    d.add_argument("--seconds", type=float, default=1e9)
    d.add_argument("--generators", nargs="+", type=int, choices=(1, 2, 3), default=(1, 2), help="by turns")
    d.set_defaults(run=draw)
    for name, run in (("score", score), ("misses", misses)):
        c = sub.add_parser(name)
        c.add_argument("answers")
        c.set_defaults(run=run)
    s = sub.add_parser("show")
    s.add_argument("answers")
    s.add_argument("--fit-below", type=int, default=120)
    s.add_argument("--read", nargs=3, type=float, help="tempered, of_a_whole, of_a_sign instead of the program's")
    s.set_defaults(run=show)
    b = sub.add_parser("stability")
    b.add_argument("--program", required=True)
    b.add_argument("--out", required=True)
    b.add_argument("--first", type=int, default=1000)
    b.add_argument("--count", type=int, default=100)
    b.add_argument("--draws", type=int, default=3)
    b.add_argument("--generators", nargs="+", type=int, choices=(1, 2, 3), default=(1, 2), help="by turns")
    b.set_defaults(run=stability)
    args = p.parse_args()
    args.run(args)


if __name__ == "__main__":
    main()
