#!/usr/bin/env python3
"""Draws what a frame costs when the wide tree is built anew, refit, or kept by the adaptive policy.

    bench_motion ../../shared/scenes/munich.obj --cars 300 --frames 1000 --rays 500 --series motion_series.csv
    plot_motion.py motion_series.csv [--picture PICTURE] [--scene NAME] [--cars V] [--rays N] [--window FRAMES]

A frame costs its update and N rays, half of them closest, half occluded, at the time per ray that was measured in that
frame. Numbers of the end are medians over the last tenth of the frames. The break-even points also go to standard
output; in brackets what 90 % of 1,000 resamples of the last tenth's frames say, the same frames for all policies.
Writes PICTURE.svg and PICTURE.png. Drawing needs Matplotlib (apt install python3-matplotlib).
"""
import argparse
import csv
import math
import random
import sys

POLICIES = ["rebuild", "refit", "adaptive"]  # of the wide tree
BREAK_EVENS = [("refit", "rebuild"), ("adaptive", "rebuild"), ("refit", "adaptive")]  # (cheaper update, cheaper rays)
STYLES = {"rebuild": ("#0072B2", "-"), "refit": ("#D55E00", "--"), "adaptive": ("#009E73", "-.")}
NUMBERS = ["update_ms", "closest_ns_per_ray", "occluded_ns_per_ray", "sah_cost", "reinserted", "rotated", "rebuilt_in_place"]
RESAMPLES = 1000


class SeriesError(Exception):
    """The file does not hold what is needed."""


def read_series(path, cars=None):
    """The frames of each policy of the wide tree for one number of cars: (cars, {policy: [{column: value}]})."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    columns = ["cars", "frame", "tree", "policy", "rebuilt", *NUMBERS]
    missing = [name for name in columns if not rows or name not in rows[0]]
    if missing:
        raise SeriesError(f"{path}: no column {missing[0]}, or no rows; expected what bench_motion --series writes")
    cars = cars or int(rows[0]["cars"])
    series = {}
    for row in rows:
        if row["tree"] == "wide" and int(row["cars"]) == cars and row["policy"] in POLICIES:
            try:
                frame = {name: float(row[name]) for name in NUMBERS}
                frame.update(frame=int(row["frame"]), rebuilt=row["rebuilt"])
            except (TypeError, ValueError):
                raise SeriesError(f"{path}: frame {row['frame']}, {row['policy']}: no number; expected one") from None
            series.setdefault(row["policy"], []).append(frame)
    lengths = {len(series.get(policy, [])) for policy in POLICIES}
    if len(lengths) != 1 or lengths == {0}:
        raise SeriesError(f"{path}: not every policy has every frame with {cars} cars; expected {', '.join(POLICIES)}")
    return cars, series


def median(sample):
    """By the nearest-rank rule, as in bench_motion."""
    return sorted(sample)[(len(sample) + 1) // 2 - 1]


def running_median(values, window):
    """Over `window` values, half of them on either side; fewer at the ends."""
    half = window // 2
    return [median(values[max(0, at - half):at + half + 1]) for at in range(len(values))]


def ray_ms(frame):
    """Milliseconds of one ray, the mean of both kinds."""
    return 0.5e-6 * (frame["closest_ns_per_ray"] + frame["occluded_ns_per_ray"])


def frame_cost_ms(frame, rays):
    return frame["update_ms"] + rays * ray_ms(frame)


def last_tenth(frames):
    return frames[-max(1, len(frames) // 10):]


def price_of(frames):
    """(milliseconds of an update, milliseconds of a ray): medians."""
    return median([frame["update_ms"] for frame in frames]), median([ray_ms(frame) for frame in frames])


def break_even_rays(plain, better):
    """Rays a frame from which on the price `better` is the lower one: 0 for always, infinity for never."""
    (plain_update, plain_ray), (better_update, better_ray) = plain, better
    if better_ray >= plain_ray:
        return math.inf
    return max(0.0, (better_update - plain_update) / (plain_ray - better_ray))


def break_even_range(plain, better):
    """The 5 % and 95 % quantiles over resamples of the same frames of both."""
    chance = random.Random(1)
    found = []
    for _ in range(RESAMPLES):
        chosen = chance.choices(range(len(plain)), k=len(plain))
        found.append(break_even_rays(price_of([plain[at] for at in chosen]), price_of([better[at] for at in chosen])))
    found.sort()
    return found[RESAMPLES // 20], found[-RESAMPLES // 20]


def in_words(rays):
    """To two digits, which is more than a break-even point is good for."""
    if rays == math.inf:
        return "never"
    return f"{float(f'{rays:.2g}'):,.0f}"


def break_even_text(plain, better, rays, low, high):
    if rays == math.inf:
        begin = f"{better} never cheaper than {plain}"
    elif rays == 0.0:
        begin = f"{better} always cheaper than {plain}"
    else:
        begin = f"{better} cheaper than {plain} from {in_words(rays)} rays on"
    if in_words(low) == in_words(high):
        return begin
    return f"{begin} ({in_words(low)} " + ("or more, or never)" if high == math.inf else f"to {in_words(high)})")


def break_evens(series):
    """[(plain, better, rays, text)] at the end of the drive."""
    found = []
    for plain, better in BREAK_EVENS:
        ends = last_tenth(series[plain]), last_tenth(series[better])
        rays = break_even_rays(price_of(ends[0]), price_of(ends[1]))
        found.append((plain, better, rays, break_even_text(plain, better, rays, *break_even_range(*ends))))
    return found


def deeds(frames):
    """What was done beyond refitting: {what: [frame numbers]}; a frame may stand in several."""
    done = {"refit only": [], "cars reinserted": [], "subtree rebuilt_in_place": [], "all nodes rebuilt_in_place": [],
            "tree rebuilt": []}
    for frame in frames:
        # All nodes, or their last part, count as a subtree, too.
        in_place = frame["rebuilt_in_place"] - (frame["rebuilt"] == "nodes")
        for what, happened in [("cars reinserted", frame["reinserted"]), ("subtree rebuilt_in_place", in_place > 0),
                               ("all nodes rebuilt_in_place", frame["rebuilt"] == "nodes"),
                               ("tree rebuilt", frame["rebuilt"] == "tree"),
                               ("refit only", not (frame["reinserted"] or frame["rotated"] or frame["rebuilt_in_place"] or
                                                   frame["rebuilt"]))]:
            if happened:
                done[what].append(frame["frame"])
    return done


def runs(numbers):
    """Numbers that follow each other, as (first, how many)."""
    found = []
    for number in numbers:
        if found and number == sum(found[-1]):
            found[-1] = (found[-1][0], found[-1][1] + 1)
        else:
            found.append((number, 1))
    return found


def draw_frames(axes, series, rays, window):
    for policy in POLICIES:
        cost = [frame_cost_ms(frame, rays) for frame in series[policy]]
        colour, line = STYLES[policy]
        axes.plot([frame["frame"] for frame in series[policy]], running_median(cost, window), line, color=colour,
                  label=policy)
    axes.set_ylim(bottom=0.0, top=1.35 * axes.get_ylim()[1])  # room for the legend
    axes.set_ylabel("cost of a frame (ms)")
    axes.legend(ncol=len(POLICIES), loc="upper left", title=f"running median over {window} frames")


def draw_curve(axes, series, window, value, label):
    for policy in POLICIES:
        colour, line = STYLES[policy]
        axes.plot([frame["frame"] for frame in series[policy]],
                  running_median([value(frame) for frame in series[policy]], window), line, color=colour)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(label)


def draw_reinserted(axes, frames, window):
    colour = STYLES["adaptive"][0]
    numbers, counts = [frame["frame"] for frame in frames], [frame["reinserted"] for frame in frames]
    axes.fill_between(numbers, counts, color=colour, alpha=0.35, linewidth=0, label="each frame")
    axes.plot(numbers, running_median(counts, window), color=colour, label="running median")
    axes.set_ylim(0, max(1.0, 1.6 * max(counts)))
    axes.set_ylabel("cars\nreinserted")
    axes.legend(ncol=2, loc="upper left")


def draw_deeds(axes, frames):
    """A lane of marks for each of the rarer deeds, at least as wide as can be seen."""
    done = {what: when for what, when in deeds(frames).items() if what != "cars reinserted"}
    first, last = frames[0]["frame"], frames[-1]["frame"]
    widest = max(1.0, 0.004 * (last - first))
    for lane, (what, when) in enumerate(reversed(done.items())):
        bars = [(begin - 0.5 * widest, count - 1 + widest) for begin, count in runs(when)]
        axes.broken_barh(bars, (lane - 0.36, 0.72), color=STYLES["adaptive"][0], linewidth=0)
    axes.set_yticks(range(len(done)), [f"{what} ({len(when)})" for what, when in reversed(done.items())])
    axes.set_ylim(-0.6, len(done) - 0.4)
    axes.set_xlim(first, max(last, first + 1))
    axes.set_xlabel("frame")


def draw_rays(axes, series, points):
    met = [at for *_, at, _ in points if 1.0 <= at < math.inf]
    fewest, most = 10.0 ** math.floor(math.log10(min([100.0, *met]))), 1e7
    rays = [fewest * (most / fewest) ** (at / 100) for at in range(101)]
    prices = {policy: price_of(last_tenth(series[policy])) for policy in POLICIES}
    for policy in POLICIES:
        update_ms, one_ray_ms = prices[policy]
        colour, line = STYLES[policy]
        axes.plot(rays, [update_ms + count * one_ray_ms for count in rays], line, color=colour, label=policy)
    key = []
    for letter, (plain, _, at, text) in zip("ABC", points):
        key.append(f"{letter}: {text}")
        if fewest <= at <= most:
            cost_ms = prices[plain][0] + at * prices[plain][1]
            axes.text(at, cost_ms, letter, ha="center", va="center", fontsize=9, weight="bold", zorder=5,
                      bbox={"boxstyle": "circle,pad=0.25", "facecolor": "white", "edgecolor": "black"})
    axes.set(xscale="log", yscale="log", xlim=(fewest, most), ylabel="cost of a frame (ms)", xlabel="rays per frame")
    axes.set_ylim(bottom=0.5 * axes.get_ylim()[0])
    axes.legend(loc="upper left")
    # Beneath, where no line can run through it.
    key.append("In brackets: 90 % of resamples of these frames. Other runs may differ by more.")
    axes.annotate("\n".join(key), (0.02, 0.0), (0, -42), xycoords=("figure fraction", "axes fraction"),
                  textcoords="offset points", va="top", linespacing=1.3)


def draw(series, cars, points, options):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"font.size": 10, "legend.fontsize": 9, "legend.title_fontsize": 9, "axes.grid": True,
                         "grid.color": "#DDDDDD", "axes.axisbelow": True, "lines.linewidth": 1.6,
                         "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
                         "svg.hashsalt": "motion"})
    figure = plt.figure(figsize=(7.5, 13.0), layout="constrained")
    grid = figure.add_gridspec(6, 1, height_ratios=[3.0, 1.6, 1.6, 1.1, 1.2, 3.6])
    frames = figure.add_subplot(grid[0])
    rates, costs, counts, lanes = (figure.add_subplot(grid[row], sharex=frames) for row in (1, 2, 3, 4))
    rays = figure.add_subplot(grid[5])
    for axes in (frames, rates, costs, counts):
        axes.tick_params(labelbottom=False)
    draw_frames(frames, series, options.rays, options.window)
    draw_curve(rates, series, options.window, lambda frame: 1e3 / max(frame["closest_ns_per_ray"], 1e-3), "Mrays/s")
    draw_curve(costs, series, options.window, lambda frame: frame["sah_cost"], "SAH cost")
    draw_reinserted(counts, series["adaptive"], options.window)
    draw_deeds(lanes, series["adaptive"])
    draw_rays(rays, series, points)
    where = f"{cars} cars" + (f" in {options.scene}" if options.scene else "")
    figure.suptitle(f"{where}: what a frame costs", fontsize=12)
    frames.set_title(f"(a) Update and {options.rays:,} rays, half closest, half occluded")
    rates.set_title("(b) Closest rays: millions a second, one thread")
    costs.set_title("(c) What a long random ray costs by the surface-area heuristic")
    counts.set_title("(d) What the adaptive policy did (in brackets: in how many frames)")
    rays.set_title("(e) Over the number of rays, from the last tenth of the frames")
    figure.savefig(options.picture + ".svg", metadata=dict.fromkeys(["Date", "Creator", "Format", "Type"]))
    figure.savefig(options.picture + ".png", dpi=110)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("series", help="what bench_motion --series has written")
    parser.add_argument("--picture", default="motion", help="name of the pictures, without .svg and .png")
    parser.add_argument("--scene", default="", help="name of the scene, for the titles")
    parser.add_argument("--cars", type=int, help="number of cars; default: the first in the file")
    parser.add_argument("--rays", type=int, default=10_000, help="rays of a frame, half closest, half occluded")
    parser.add_argument("--window", type=int, default=25, help="frames of the running median, an odd number")
    options = parser.parse_args(arguments)
    if options.window < 1 or options.window % 2 == 0 or options.rays < 0:
        parser.error("expected an odd --window and --rays of at least 0")
    try:
        cars, series = read_series(options.series, options.cars)
        points = break_evens(series)
        for *_, text in points:
            print(text)
        print("; ".join(f"{what}: {len(frames)} frames" for what, frames in deeds(series["adaptive"]).items()))
        draw(series, cars, points, options)
    except (SeriesError, OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    except ImportError:
        print("plot_motion.py: no Matplotlib; expected it installed (apt install python3-matplotlib)", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
