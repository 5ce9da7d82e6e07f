#!/usr/bin/python3
"""Makes the tables of tests/reference/statistics and what SciPy and statsmodels say of them.

    apt-get install python3-scipy python3-statsmodels python3-pandas
    tests/reference/make_statistics.py

Writes NAME.csv (the data) and NAME.python.csv (quantity,value). make_statistics.R then adds
NAME.r.csv, what R says of the same data. Every value is printed by those programs, none by Relumbre.
"""
import itertools
import os

import numpy as np
import pandas as pd
import scipy.stats as st
import statsmodels.formula.api as smf
from statsmodels.stats.anova import anova_lm

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "statistics")


def balanced():
    """A replicated 3 x 4 x 2 design with an interaction."""
    rng = np.random.default_rng(1)
    rows = [
        (a, b, c, 10 + 2 * i - 0.7 * j + (0.9 * i * j if c == "on" else 0) + rng.normal(0, 1.3))
        for (i, a), (j, b), c in itertools.product(enumerate("xyz"), enumerate("pqrs"), ("on", "off"))
        for _ in range(3)
    ]
    return pd.DataFrame(rows, columns=["a", "b", "c", "y"])


def unbalanced():
    """The same design with rows lost at random and skewed noise."""
    rng = np.random.default_rng(2)
    table = balanced()
    table["y"] = np.exp(table["y"] / 6) + rng.exponential(1.0, len(table))
    return table.iloc[np.sort(rng.choice(len(table), 53, replace=False))].reset_index(drop=True)


def ties():
    """Few distinct responses."""
    rng = np.random.default_rng(3)
    rows = [(g, h, float(rng.integers(0, 4) + (g == "late"))) for g in ("early", "mid", "late")
            for h in ("left", "right") for _ in range(11)]
    return pd.DataFrame(rows, columns=["g", "h", "y"])


def tiny():
    """Three rows a group: where Shapiro-Wilk's approximation for small n is used."""
    rows = [("u", 1.5), ("u", 2.25), ("u", 1.0), ("v", 3.5), ("v", 4.75), ("v", 3.0), ("w", 2.0), ("w", 2.5), ("w", 7.0)]
    return pd.DataFrame(rows, columns=["g", "y"])


def machine():
    """1,920 cells of a deterministic function, with the shape of a machine's memory accesses."""
    scenes = {"teapot": 0.41, "bunny": 0.55, "dragon": 0.37, "buddha": 0.29}
    resolutions = [(640, 480), (800, 600), (1280, 720), (1920, 1080), (3200, 1800)]
    rows = []
    for (scene, cover), depth, (w, h), tile, lines in itertools.product(
            scenes.items(), range(5, 11), resolutions, (2, 10, 20, 40), (512, 4096, 32768, 262144)):
        reads = w * h * (1 + cover * depth * 2.3)
        nodes = cover * 4.0 ** depth
        spill = 1 / (1 + lines / (nodes * (1 + w / 5000)))
        misses = float(round(nodes * 0.8 + 0.02 * reads * spill * (1 + 0.01 * np.log(tile) * w / 640)))
        rows.append((scene, depth, tile, lines, f"{w}x{h}", misses, 1 - misses / reads))
    return pd.DataFrame(rows, columns=["scene", "depth", "tile", "lines", "resolution", "M", "L"])


def analyses(table, response, factors, out):
    """Everything the statistics module computes of one response."""
    is_balanced = table.groupby(factors).size().nunique() == 1 and \
        len(table.groupby(factors)) == np.prod([table[f].nunique() for f in factors])

    def terms(join, tables):
        for kind, typ in tables.items():
            formula = f"{response} ~ " + join.join(f"C({f}, Sum)" for f in factors)
            if join == "*":
                formula = f"{response} ~ (" + " + ".join(f"C({f}, Sum)" for f in factors) + ")**2"
            model = smf.ols(formula, data=table).fit()
            for name, row in anova_lm(model, typ=typ).iterrows():
                name = name.replace("C(", "").replace(", Sum)", "")
                if name == "Intercept":
                    continue
                prefix = f"{kind}.{name.lower()}"
                out[f"{prefix}.df"] = row["df"]
                out[f"{prefix}.ss"] = row["sum_sq"]
                if name != "Residual":
                    out[f"{prefix}.f"] = row["F"]
                    out[f"{prefix}.p"] = row["PR(>F)"]
        return model

    model = terms(" + ", {"main": 2, **({"main.type3": 3} if is_balanced else {})})
    if len(factors) > 1:
        terms("*", {"pairs": 2, **({"pairs.type3": 3} if is_balanced else {})})
    residuals = model.resid.to_numpy()
    out["residuals.shapiro.w"], out["residuals.shapiro.p"] = st.shapiro(residuals)
    if len(table) >= 20:
        out["residuals.k2"], out["residuals.k2.p"] = st.normaltest(residuals)

    for factor in factors:
        groups = {level: part[response].to_numpy() for level, part in table.groupby(factor, sort=False)}
        values = list(groups.values())
        out[f"{factor}.brown_forsythe"], out[f"{factor}.brown_forsythe.p"] = st.levene(*values, center="median")
        out[f"{factor}.bartlett"], out[f"{factor}.bartlett.p"] = st.bartlett(*values)
        out[f"{factor}.h"], out[f"{factor}.h.p"] = st.kruskal(*values)
        for a, b in itertools.combinations(groups, 2):
            pair = f"{factor}.{a}|{b}"
            u = st.mannwhitneyu(groups[a], groups[b]).statistic
            out[f"{pair}.delta"] = 2 * u / (len(groups[a]) * len(groups[b])) - 1


def main():
    os.makedirs(FOLDER, exist_ok=True)
    for make, responses in ((balanced, ["y"]), (unbalanced, ["y"]), (ties, ["y"]), (tiny, ["y"]), (machine, ["M", "L"])):
        name = make.__name__
        make().to_csv(os.path.join(FOLDER, f"{name}.csv"), index=False)
        table = pd.read_csv(os.path.join(FOLDER, f"{name}.csv"), float_precision="round_trip")
        factors = [c for c in table.columns if c not in responses]
        with open(os.path.join(FOLDER, f"{name}.python.csv"), "w") as file:
            for response in responses:
                values = {}
                analyses(table, response, factors, values)
                for key, value in values.items():
                    print(f"{response},{key},{float(value)!r}", file=file)


main()
