#!/usr/bin/env python3
"""Draws what the exact memory costs against how much changes.

    bench_memory ../../shared/scenes/munich.obj --mast 8 -95 27 --receivers 10 --frames 60 > memory.csv
    plot_memory.py memory.csv [--picture PICTURE]

On the left milliseconds for a link and frame, mean and longest, over how far the receiver moves in a frame; on the right what does not depend
on a clock: sequences solved and legs looked along, over how many paths appear and vanish. Rows of one scene, one number of cars and one number of
receivers: those of the first row. Writes PICTURE.svg and PICTURE.png. Drawing needs Matplotlib (apt install python3-matplotlib).
"""
import argparse
import csv
import sys

STYLES = {"off": ("#D55E00", "--", "from scratch"), "exact": ("#0072B2", "-", "cache: exact")}
KEYS = ["scene", "threads", "max_diffractions", "cars", "receivers"]
NUMBERS = ["step_m", "off_mean_ms", "off_maximum_ms", "exact_mean_ms", "exact_maximum_ms", "births", "deaths", "solved_off",
           "solved_exact", "legs_off", "legs_exact", "receivers"]


class RowsError(Exception):
    """The file does not hold what is needed."""


def read_rows(path):
    """The rows that belong to the first one, by step."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    missing = [name for name in KEYS + NUMBERS if not rows or name not in rows[0]]
    if missing:
        raise RowsError(f"{path}: no column {missing[0]}, or no rows; expected what bench_memory writes")
    own = [row for row in rows if all(row[key] == rows[0][key] for key in KEYS)]
    try:
        own = [{name: float(row[name]) for name in NUMBERS} for row in own]
    except (TypeError, ValueError):
        raise RowsError(f"{path}: no number where one is expected") from None
    return rows[0], sorted(own, key=lambda row: row["step_m"])


def change_of(row):
    """Paths that appear or vanish, for a link and frame."""
    return (row["births"] + row["deaths"]) / row["receivers"]


def work_of(row, mode):
    """Sequences solved and legs looked along, for a link and frame."""
    return (row[f"solved_{mode}"] + row[f"legs_{mode}"]) / row["receivers"]


def draw(rows, title, picture):
    import matplotlib
    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.hashsalt": "dcem", "font.size": 9})
    from matplotlib import pyplot
    figure, (time_axes, work_axes) = pyplot.subplots(1, 2, figsize=(8.0, 3.4), layout="constrained")
    for mode, (colour, line, name) in STYLES.items():
        steps = [row["step_m"] for row in rows]
        time_axes.plot(steps, [row[f"{mode}_mean_ms"] for row in rows], line, color=colour, marker="o", label=name)
        time_axes.plot(steps, [row[f"{mode}_maximum_ms"] for row in rows], ":", color=colour, label=f"{name}, worst frame")
        work_axes.plot([change_of(row) for row in rows], [work_of(row, mode) for row in rows], line, color=colour, marker="o",
                       label=name)
    time_axes.set_xscale("symlog", linthresh=0.01)
    time_axes.set_yscale("log")
    time_axes.set_xlabel("the receiver moves (m a frame)")
    time_axes.set_ylabel("for a link and frame (ms)")
    work_axes.set_xscale("symlog", linthresh=0.01)
    work_axes.set_yscale("symlog", linthresh=1.0)
    work_axes.set_xlabel("paths that appear or vanish (for a link and frame)")
    work_axes.set_ylabel("sequences solved and legs")
    for axes in (time_axes, work_axes):
        axes.grid(True, linewidth=0.3)
        axes.legend(fontsize=7)
    figure.suptitle(title)
    for ending in ("svg", "png"):
        figure.savefig(f"{picture}.{ending}", dpi=160, metadata={"Date": None} if ending == "svg" else None)


def main(arguments):
    parser = argparse.ArgumentParser(description="Draws what the exact memory costs against how much changes.")
    parser.add_argument("rows", help="what bench_memory has written")
    parser.add_argument("--picture", default="memory", help="where to, without an ending")
    options = parser.parse_args(arguments)
    try:
        first, rows = read_rows(options.rows)
    except (OSError, RowsError) as error:
        sys.exit(str(error))
    try:
        draw(rows, f"{first['scene']}, {first['cars']} cars, {first['receivers']} links", options.picture)
    except ImportError:
        sys.exit("drawing needs Matplotlib (apt install python3-matplotlib)")


if __name__ == "__main__":
    main(sys.argv[1:])
