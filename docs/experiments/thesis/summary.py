#!/usr/bin/env python3
"""Prints what README.md says of the cells: python3 summary.py [cells.csv]"""

import collections
import csv
import pathlib
import statistics
import sys

PICTURE = ("scene", "depth", "width", "height")


def read_cells(path):
    with open(path, newline="", encoding="utf-8") as file:
        cells = list(csv.DictReader(file))
    for cell in cells:
        for key in ("depth", "width", "height", "tile", "lines", "tasks", "reads", "M"):
            cell[key] = int(cell[key])
        cell["size"] = cell["width"] * cell["height"]
    return cells


def alone(cells, varied, fixed):
    """M by level of one factor, for every set of cells that agree in all others."""
    sets = collections.defaultdict(dict)
    for cell in cells:
        sets[tuple(cell[key] for key in fixed)][cell[varied]] = cell["M"]
    return list(sets.values())


def show(name, ratios):
    print(f"{name}: {statistics.median(ratios):.4f} in the median, {max(ratios):.4f} at most")


def tiles(cells):
    def of(lines):
        return alone([c for c in cells if c["lines"] in lines], "tile", PICTURE + ("lines",))

    small = of([512])
    show("L = 512, M of tiles of 2 over M of tiles of 40", [m[2] / m[40] for m in small])
    best = collections.Counter(tuple(t for t in m if m[t] == min(m.values())) for m in small)
    for sizes, count in best.most_common():
        print(f"L = 512, least M with tiles of {sizes}: {count} of {len(small)} pictures")
    for lines in ([4096], [32768], [262144], [32768, 262144]):
        show(f"L in {lines}, largest M over least by tile",
             [max(m.values()) / min(m.values()) for m in of(lines)])


def lines(cells):
    for few, many in ((512, 4096), (4096, 32768), (32768, 262144)):
        show(f"M of L = {few} over M of L = {many}",
             [m[few] / m[many] for m in alone(cells, "lines", PICTURE + ("tile",))])


def depths(cells):
    sums = collections.defaultdict(collections.Counter)
    for cell in cells:
        for key in ("M", "reads"):
            sums[cell["depth"]][key] += cell[key]
    for depth in sorted(sums)[1:]:
        growth = [sums[depth][key] / sums[depth - 1][key] for key in ("M", "reads")]
        print(f"depth {depth}: M {growth[0]:.3f} and reads {growth[1]:.3f} times the depth before")
    deepest = [c for c in cells if c["depth"] == max(sums)]
    for level in range(max(sums)):
        hits, reads = (sum(int(c[f"{key}_{level}"]) for c in deepest) for key in ("hits", "reads"))
        print(f"depth {max(sums)}, level {level}: {hits / reads:.4%} hit")


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).with_name("cells.csv")
    cells = read_cells(path)
    words, reads, tasks = (sum(c[key] for c in cells) for key in ("M", "reads", "tasks"))
    print(f"M {words} of {reads} reads: {words / reads:.4%}, {2e-6 * words:.1f} MB; records of "
          f"pointers {32e-12 * tasks:.3f} TB")
    worst = max(cells, key=lambda c: c["M"] / c["reads"])
    print("worst cell:", *(worst[key] for key in PICTURE + ("tile", "lines")),
          f"{worst['M'] / worst['reads']:.4%}")
    tiles(cells)
    lines(cells)
    depths(cells)
    show("M of the largest picture over M of the smallest",
         [m[max(m)] / m[min(m)] for m in alone(cells, "size", ("scene", "depth", "tile", "lines"))])


if __name__ == "__main__":
    main()
