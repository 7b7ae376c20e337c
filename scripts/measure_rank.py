#!/usr/bin/env python3
"""Does `arabesque measure` put results in the same order as independent judges do?

    scripts/measure_rank.py --set FOLDER --judges FOLDER --out FOLDER [--program PATH] [--size 720x720] [name ...]

Of every NAME_exemplar.svg of the set with its NAME_truth.svg, a larger drawing of the same pattern, seven pages are judged: the truth,
what the program makes of the exemplar, and five spoiled versions:

    holes    whatever lies in a few discs is gone            jitter   everything is shifted a little, each its own way
    overlap  one in eight is pushed onto its neighbour       turned   three in ten are turned
    pasted   the exemplar, side by side, whole

The judges are eval2d.py (`overall`, 0 is a true pattern) and evenness.py (largest of what its ratios are above 1). The last lines are
Spearman's coefficients between what the program says and what they say, over all pages and over those of each pattern. What was judged
once is kept in the output folder. Needs numpy and scipy, and what the judges need."""
import argparse, copy, json, math, os, random, re, subprocess, sys
import xml.etree.ElementTree as ET

SVG = "{http://www.w3.org/2000/svg}"
ET.register_namespace("", SVG[1:-1])
KINDS = ["truth", "program", "holes", "jitter", "overlap", "turned", "pasted"]


def read(path):
    root = ET.parse(path).getroot()
    return root, [float(v) for v in root.get("viewBox").split()]


def middle(item):
    """Middle of the box around the numbers of an item's paths, as far as they are absolute."""
    numbers = [float(v) for e in item.iter() for v in re.findall(r"-?\d*\.?\d+", e.get("d") or "")]
    for e in item.iter():
        if e.get("cx"):
            numbers += [float(e.get("cx")), float(e.get("cy"))]
    xs, ys = numbers[0::2], numbers[1::2]
    return ((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2) if xs and ys else None


def items(root):
    """What is drawn, with where it is; no background."""
    found = [(item, middle(item)) for item in root if item.tag != SVG + "rect" and item.tag != SVG + "defs"]
    return [(item, at) for item, at in found if at]


def shift(item, dx, dy):
    item.set("transform", f"translate({dx:.3f} {dy:.3f}) " + (item.get("transform") or ""))


def spoil(kind, truth, exemplar, seed):
    """The text of one spoiled version of the truth."""
    root, (x0, y0, w, h) = read(truth)
    everything, rng = items(root), random.Random(f"{kind} {seed}")
    spacing = math.sqrt(w * h / max(len(everything), 1))
    if kind == "holes":
        discs = [(x0 + rng.uniform(.12, .88) * w, y0 + rng.uniform(.12, .88) * h, rng.uniform(1.3, 2.2) * spacing) for _ in range(9)]
        for item, (x, y) in everything:
            if any(math.hypot(x - a, y - b) < r for a, b, r in discs):
                root.remove(item)
    elif kind == "jitter":
        for item, _ in everything:
            shift(item, rng.gauss(0, .28 * spacing), rng.gauss(0, .28 * spacing))
    elif kind == "overlap":
        for k in rng.sample(range(len(everything)), len(everything) // 8):
            item, (x, y) = everything[k]
            a, b = min((at for j, (_, at) in enumerate(everything) if j != k), key=lambda at: math.hypot(at[0] - x, at[1] - y))
            shift(item, .6 * (a - x), .6 * (b - y))
    elif kind == "turned":
        for k in rng.sample(range(len(everything)), 3 * len(everything) // 10):
            item, (x, y) = everything[k]
            item.set("transform", f"rotate({rng.choice([-1, 1]) * rng.uniform(40, 140):.1f} {x:.2f} {y:.2f})")
    else:
        small, (a0, b0, a, b) = read(exemplar)
        for item, _ in everything:
            root.remove(item)
        for i in range(math.ceil(w / a)):
            for j in range(math.ceil(h / b)):
                for item, _ in items(small):
                    again = copy.deepcopy(item)
                    shift(again, x0 - a0 + i * a, y0 - b0 + j * b)
                    root.append(again)
    return ET.tostring(root, encoding="unicode")


def told(command):
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("set", "judges", "out"):
        parser.add_argument("--" + name, required=True)
    parser.add_argument("--program", default="target/release/arabesque")
    parser.add_argument("--size", default="720x720")
    parser.add_argument("--judge-only", action="store_true")
    parser.add_argument("names", nargs="*")
    a = parser.parse_args()
    names = a.names or sorted(f[: -len("_exemplar.svg")] for f in os.listdir(a.set) if f.endswith("_exemplar.svg"))
    os.makedirs(a.out, exist_ok=True)
    rows = []
    for name in names:
        exemplar, truth = (os.path.join(a.set, f"{name}_{what}.svg") for what in ("exemplar", "truth"))
        pages = {kind: os.path.join(a.out, f"{name}-{kind}.svg") for kind in KINDS}
        for kind, page in pages.items():
            if os.path.exists(page):
                continue
            if kind == "truth":
                text = open(truth, encoding="utf-8").read()
            elif kind == "program":
                subprocess.run([a.program, "fill", exemplar, "--size", a.size, "--seed", "1", "-o", page], check=True)
                continue
            else:
                text = spoil(kind, truth, exemplar, name)
            open(page, "w", encoding="utf-8").write(text)
        for kind, page in pages.items():
            kept = page + ".judged.json"
            if not os.path.exists(kept):
                judge = [sys.executable, os.path.join(a.judges, "eval2d.py"), exemplar, page, "--truth", truth, "--json"]
                even = [sys.executable, os.path.join(a.judges, "evenness.py"), exemplar, page, "--json"]
                json.dump({"eval2d": told(judge)["summary"], "evenness": told(even)[0]}, open(kept, "w"))
            rows.append((name, kind, page, exemplar, json.load(open(kept))))
    if not a.judge_only:
        compare(rows, a.program)


def compare(rows, program):
    from scipy.stats import spearmanr
    table = []
    for name, kind, page, exemplar, judged in rows:
        own = told([program, "measure", exemplar, page, "--json"])["reports"][0]
        even = max(judged["evenness"][k] for k in ("q99", "q999", "unevenness")) - 1
        table.append((name, kind, own, judged["eval2d"]["overall"], even))
        families = " ".join(f"{f['family']} {f['fault']:.2f}" for f in own["families"])
        print(f"{name:10s} {kind:8s} measure {own['fault']:.2f}  eval2d {judged['eval2d']['overall']:.2f}  evenness {even:5.2f}   {families}")

    def rank(title, kept):
        fault = [own["fault"] for _, _, own, _, _ in kept]
        evenness = [max([f["fault"] for f in own["families"] if f["family"] == "evenness"], default=0) for _, _, own, _, _ in kept]
        one, two = spearmanr(fault, [row[3] for row in kept])[0], spearmanr(evenness, [row[4] for row in kept])[0]
        print(f"{title:10s} fault against eval2d {one:.2f}, evenness against evenness.py {two:.2f}")

    for name in dict.fromkeys(row[0] for row in table):
        rank(name, [row for row in table if row[0] == name])
    rank("all", table)


if __name__ == "__main__":
    main()
