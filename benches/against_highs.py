"""Takes the rows that `cargo bench --bench verdicts` wrote and the times that it printed; gives a table against HiGHS.

HiGHS solves the self-stress problem on the full rows: least sum of y with A^T y = 0, y >= 1, by its simplex with its
own presolve, one thread. Both times are processor time, all threads together: the machine may be shared. Where it says infeasible the assembly can open; where the rows then lack rank it slides,
which HiGHS is not asked. Ratios within one run count.

    cargo bench --bench verdicts -- FOLDER NAME... > times.jsonl
    python3 benches/against_highs.py FOLDER times.jsonl [SECONDS]

SECONDS (default 120) is when HiGHS is stopped; its time is then a lower bound, marked >. Needs numpy and highspy.
"""

import json
import math
import sys
import time

import highspy
import numpy as np


def read_rows(file):
    """Starts, columns and values of A, row by row, and its number of unknowns."""
    raw = open(file, "rb").read()
    rows, unknowns = np.frombuffer(raw, "<u8", 2)
    starts, at, columns, values = [0], 16, [], []
    for _ in range(int(rows)):
        entries = int.from_bytes(raw[at : at + 8], "little")
        pairs = np.frombuffer(raw, [("c", "<u8"), ("v", "<f8")], entries, at + 8)
        columns.append(pairs["c"])
        values.append(pairs["v"])
        starts.append(starts[-1] + entries)
        at += 8 + 16 * entries
    return np.array(starts), np.concatenate(columns), np.concatenate(values), int(unknowns)


def self_stress(starts, columns, values, unknowns):
    """The problem over y: a row of A is a column here."""
    lp = highspy.HighsLp()
    rows = len(starts) - 1
    lp.num_col_, lp.num_row_ = rows, unknowns
    lp.col_cost_ = np.ones(rows)
    lp.col_lower_ = np.ones(rows)
    lp.col_upper_ = np.full(rows, highspy.kHighsInf)
    lp.row_lower_ = np.zeros(unknowns)
    lp.row_upper_ = np.zeros(unknowns)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_ = starts
    lp.a_matrix_.index_ = columns.astype(np.int32)
    lp.a_matrix_.value_ = values
    return lp


def solve(lp, limit):
    """Processor seconds of the run alone, and how it ended."""
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("solver", "simplex")
    highs.setOptionValue("threads", 1)
    highs.setOptionValue("time_limit", float(limit))
    highs.passModel(lp)
    start = time.process_time()
    highs.run()
    return time.process_time() - start, highs.modelStatusToString(highs.getModelStatus())


def exponent(points):
    """The slope of log time over log rows, least squares."""
    x, y = np.log(np.array(points, float)).T
    return float(np.polyfit(x, y, 1)[0]) if len(points) > 1 else math.nan


def main():
    folder, times = sys.argv[1], sys.argv[2]
    limit = float(sys.argv[3]) if len(sys.argv) > 3 else 120.0
    print("| assembly | parts | rows | verdict | weavelock | HiGHS simplex | ratio |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    families = {}
    for line in open(times):
        case = json.loads(line)
        rows = read_rows(f"{folder}/{case['name'].replace('/', '_')}.rows")
        seconds, ended = solve(self_stress(*rows), limit)
        own = case["decide_cpu_s"]
        stopped = ">" if "limit" in ended.lower() else ""
        word = {"Optimal": "balanced"}.get(ended, ended.lower())
        name = case["name"].split("/")[-1].removesuffix(".toml")
        print(
            f"| {name} | {case['parts']} | {case['rows']} | {case['verdict']} | {own * 1e3:.3g} ms "
            f"| {stopped}{seconds:.3g} s, {word} | {stopped}{seconds / own:.0f} |",
            flush=True,
        )
        families.setdefault(name.split("-")[0], []).append((case["rows"], own))
    for family, points in families.items():
        if len(points) > 2:
            print(f"\n{family}: time grows with rows to the power {exponent(points):.2f}", end="")
    print()


main()
