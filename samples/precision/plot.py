#!/usr/bin/python3
"""Plots of `tyndall precision --out FOLDER` and `tyndall stability --out FOLDER`, which run this by themselves.

    plot.py FOLDER

Reads FOLDER/precision.csv, causes.csv and the pictures (SCENE_picture.pfm, SCENE_exact.pfm) where they are, and writes beside them, for each scene, error against time of the fog's passes on logarithmic axes (a curve a technique, the
Pareto front marked) and the picture, the exact one and the error between them, both as PNG and the first as SVG too, and
precision.html, which holds all of that and the tables. Of FOLDER/stability.csv it draws stability.png and stability.svg:
of each case what was measured, and its bound, against what is varied.
"""
import csv
import html
import pathlib
import sys

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.lines import Line2D
    import numpy
except ImportError as error:
    print(f"plot.py: {error}; no plots are drawn (Debian's package is python3-matplotlib)", file=sys.stderr)
    sys.exit(3)

COLUMNS = ["scene", "integrator", "visibility", "grid", "slices", "frame", "physics", "relative_l2", "bias",
           "reference_error", "fog_ms", "on_front", "own", "device"]
MOST_LISTED = 60  # rows of a scene's table; of more, only what is on the front is listed
DASHES = {"one_tap": "-", "n_taps": "--", "prefiltered": "-.", "lit_fraction": ":"}


def read_csv(path, columns=()):
    with path.open(newline="") as file:
        reader = csv.DictReader(file)
        missing = [column for column in columns if column not in (reader.fieldnames or [])]
        if missing:
            raise ValueError(f"'{path}' has no column '{missing[0]}'")
        return list(reader)


def read_rows(path):
    rows = read_csv(path, COLUMNS)
    if not rows:
        raise ValueError(f"'{path}' has no rows")
    for row in rows:
        for column in ("relative_l2", "bias", "reference_error", "fog_ms"):
            row[column] = float(row[column])
        row["slices"] = int(row["slices"])
        row["frame"] = int(row["frame"])
        row["on_front"] = row["on_front"] == "1"
        row["own"] = row["own"] == "1"
    return rows


def read_pfm(path):
    """Rows from the top, three channels; NaN where nothing was computed."""
    with path.open("rb") as file:
        if file.readline().strip() != b"PF":
            raise ValueError(f"'{path}' is no colour PFM")
        width, height = map(int, file.readline().split())
        file.readline()  # -1: little endian
        values = numpy.frombuffer(file.read(), dtype="<f4")
    return values.reshape(height, width, 3)[::-1].astype(float)


def judged(rows):
    """Of each picture the last frame against the first truth, which leaves nothing out."""
    last = max(row["frame"] for row in rows)
    return [row for row in rows if row["frame"] == last and row["physics"] == rows[0]["physics"]]


def plot_scene(scene, rows, folder):
    figure, axes = plt.subplots(figsize=(8.0, 5.5), constrained_layout=True)
    integrators = sorted({row["integrator"] for row in rows})
    grids = sorted({row["grid"] for row in rows}, key=lambda grid: [int(side) for side in grid.split("x")])
    colors = dict(zip(integrators, plt.rcParams["axes.prop_cycle"].by_key()["color"]))
    sizes = {grid: 2.5 + 1.5 * index for index, grid in enumerate(grids)}
    techniques = sorted({(row["integrator"], row["visibility"], row["grid"]) for row in rows})
    for technique in techniques:
        integrator, visibility, grid = technique
        curve = sorted((row["slices"], row["fog_ms"], row["relative_l2"]) for row in rows
                       if (row["integrator"], row["visibility"], row["grid"]) == technique)
        axes.plot([ms for _, ms, _ in curve], [error for _, _, error in curve], DASHES[visibility], marker="o",
                  markersize=sizes[grid], linewidth=0.8, color=colors[integrator], alpha=0.7)
    front = sorted((row["fog_ms"], row["relative_l2"]) for row in rows if row["on_front"])
    axes.step([ms for ms, _ in front], [error for _, error in front], where="post", color="black", linewidth=3,
              alpha=0.35)
    own = [row for row in rows if row["own"]]
    axes.plot([row["fog_ms"] for row in own], [row["relative_l2"] for row in own], "k*", markersize=13)
    keys = [Line2D([], [], color=color, label=name) for name, color in colors.items()]
    keys += [Line2D([], [], color="gray", linestyle=DASHES[name], label=name)
             for name in sorted({row["visibility"] for row in rows})]
    keys += [Line2D([], [], color="gray", linestyle="", marker="o", markersize=size, label=grid)
             for grid, size in sizes.items()]
    keys += [Line2D([], [], color="black", linewidth=3, alpha=0.35, label="Pareto front"),
             Line2D([], [], color="black", linestyle="", marker="*", markersize=10, label="the scene's own")]
    axes.set(xscale="log", yscale="log", xlabel="fog's passes, ms", ylabel="relative L2 error of linear radiance",
             title=f"{scene}, {rows[0]['device']}")
    axes.title.set_fontsize("medium")
    axes.grid(which="both", alpha=0.3)
    axes.legend(handles=keys, fontsize="x-small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    for suffix in ("png", "svg"):
        figure.savefig(folder / f"precision_{scene}.{suffix}", dpi=150)
    plt.close(figure)


def plot_error(scene, folder):
    """The picture, the exact one, and in colours how far each pixel is off, in parts of the mean radiance."""
    picture = read_pfm(folder / f"{scene}_picture.pfm")
    exact = read_pfm(folder / f"{scene}_exact.pfm")
    known = numpy.isfinite(exact).all(axis=2)
    mean = exact[known].mean()
    error = numpy.sqrt(((picture - exact) ** 2).mean(axis=2)) / mean

    def tone(radiance):
        return numpy.clip(1.0 - numpy.exp(-radiance / mean), 0.0, 1.0) ** (1.0 / 2.2)

    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(15.0, 3.4), constrained_layout=True)
    left.imshow(tone(picture))
    left.set_title(f"{scene}, picture")
    scale = matplotlib.colors.LogNorm(1e-4, 1.0)
    if known.all():
        middle.imshow(tone(exact))
        colored = right.imshow(error, norm=scale, cmap="magma")
    else:  # a choice of pixels: as points
        y, x = numpy.nonzero(known)
        for axes in (middle, right):
            axes.set(xlim=(-0.5, known.shape[1] - 0.5), ylim=(known.shape[0] - 0.5, -0.5), aspect="equal",
                     facecolor="gray")
        middle.scatter(x, y, s=9, marker="s", linewidths=0, c=tone(exact[known]))
        colored = right.scatter(x, y, s=9, marker="s", linewidths=0, c=error[known], norm=scale, cmap="magma")
    middle.set_title("exact")
    right.set_title("error, parts of the mean radiance")
    figure.colorbar(colored, ax=right, extend="both")
    for axes in (left, middle, right):
        axes.set_xticks([])
        axes.set_yticks([])
    figure.savefig(folder / f"error_{scene}.png", dpi=110)
    plt.close(figure)


def table(rows, formats):
    lines = ["<table><tr>" + "".join(f"<th>{name}</th>" for name in formats) + "</tr>"]
    for row in rows:
        cells = (html.escape(form.format(float(row[name]) if form != "{}" else row[name]))
                 for name, form in formats.items())
        lines.append(f"<tr{' class=front' if row.get('on_front') else ''}>"
                     + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    return "\n".join(lines + ["</table>"])


def row_table(rows):
    if len(rows) > MOST_LISTED:
        rows = [row for row in judged(rows) if row["on_front"] or row["own"]]
    return table(rows, {"integrator": "{}", "visibility": "{}", "grid": "{}", "slices": "{}", "frame": "{}",
                        "physics": "{}", "relative_l2": "{:.3%}", "bias": "{:+.3%}", "fog_ms": "{:.2f}",
                        "reference_error": "{:.0e}"})


def cause_table(rows):
    return table(rows, {"cause": "{}", "first_relative_l2": "{:.3%}", "first_bias": "{:+.3%}",
                        "last_relative_l2": "{:.3%}", "last_bias": "{:+.3%}", "fog_ms": "{:.2f}", "frame_ms": "{:.2f}"})


def write_page(rows, causes, scenes, folder):
    style = ("body{font:14px sans-serif;max-width:75em;margin:2em auto}td,th{padding:.1em .6em;text-align:right}"
             ".front{font-weight:bold}img,svg{max-width:100%}")
    parts = [f"<!doctype html><meta charset=utf-8><title>Error against run time</title><style>{style}</style>",
             "<h1>Error against run time</h1>", f"<p>{html.escape(rows[0]['device'])}. Bold: nothing measured is both",
             " faster and more exact, of the same scene, frame and truth. Of a sweep the front and the scene's own",
             " configuration are listed; precision.csv holds all.</p>"]
    for scene in scenes:
        svg = (folder / f"precision_{scene}.svg").read_text()
        parts += [f"<h2>{html.escape(scene)}</h2>", svg[svg.index("<svg"):]]
        if (folder / f"error_{scene}.png").exists():
            parts.append(f"<p><img src='error_{scene}.png' alt='picture, exact picture, error'></p>")
        parts.append(row_table([row for row in rows if row["scene"] == scene]))
        of_scene = [row for row in causes if row["scene"] == scene]
        if of_scene:
            parts += ["<h3>What is left without one cause of error, first frame and last</h3>", cause_table(of_scene)]
    (folder / "precision.html").write_text("\n".join(parts))


def plot_stability(rows, folder):
    measured = [row for row in rows if row["worst"] != "-"]
    cases = list(dict.fromkeys((row["case"], row["measured"]) for row in measured))
    if not cases:
        return
    columns = min(4, len(cases))
    lines = -(-len(cases) // columns)
    figure, grid = plt.subplots(lines, columns, figsize=(4.2 * columns, 3.6 * lines), squeeze=False,
                                constrained_layout=True)
    for axes in grid.flat[len(cases):]:
        axes.set_visible(False)
    for (case, measure), axes in zip(cases, grid.flat):
        shown = [row for row in measured if (row["case"], row["measured"]) == (case, measure)]
        places = range(len(shown))
        least = 1e-12  # what is exactly 0 stands there
        curves = {}  # one for what differs after the last comma: in froxels or pixels, say
        for place, row in zip(places, shown):
            rest = row["parameter"].rpartition(", ")
            curves.setdefault(rest[2] if rest[1] else "", []).append((place, max(float(row["worst"]), least)))
        for curve in curves.values():
            axes.plot(*zip(*curve), "o-", linewidth=0.8, markersize=4)
        bounded = [(place, float(row["bound"])) for place, row in zip(places, shown) if row["bound"] != "-"]
        axes.plot([place for place, _ in bounded], [bound for _, bound in bounded], "_", color="firebrick",
                  markersize=14)
        axes.set_xticks(list(places), [row["parameter"] for row in shown], rotation=90, fontsize=6)
        axes.set(yscale="log", xlim=(-0.5, len(shown) - 0.5))
        axes.set_title(f"{case}: {measure}", fontsize="x-small")
        axes.tick_params(axis="y", which="both", labelsize=6)
        axes.grid(axis="y", alpha=0.3)
    figure.suptitle(f"{rows[0]['device']}; red: bound", fontsize="small")
    for suffix in ("png", "svg"):
        figure.savefig(folder / f"stability.{suffix}", dpi=110)
    plt.close(figure)


def draw_precision(folder):
    rows = read_rows(folder / "precision.csv")
    causes = read_csv(folder / "causes.csv")
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    for scene in scenes:
        plot_scene(scene, judged([row for row in rows if row["scene"] == scene]), folder)
        if (folder / f"{scene}_exact.pfm").exists():
            plot_error(scene, folder)
    write_page(rows, causes, scenes, folder)


def main(arguments):
    if len(arguments) != 1:
        print("plot.py: give the folder that `tyndall precision --out` or `tyndall stability --out` wrote",
              file=sys.stderr)
        return 2
    folder = pathlib.Path(arguments[0])
    stability = folder / "stability.csv"
    try:
        if stability.exists():
            plot_stability(read_csv(stability, ["case", "parameter", "measured", "worst", "bound", "device"]), folder)
        if not stability.exists() or (folder / "precision.csv").exists():
            draw_precision(folder)
    except (OSError, ValueError, KeyError) as error:
        print(f"plot.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
