#!/usr/bin/python3
"""Work-precision plots of `tyndall precision --out FOLDER`.

    plot.py FOLDER

Reads FOLDER/precision.csv and writes beside it, for each scene, error against time of the fog's passes on logarithmic
axes as PNG and SVG (a curve a technique, the Pareto front marked), and precision.html, which holds all of them and the
table.
"""
import csv
import html
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)

COLUMNS = ["scene", "integrator", "visibility", "grid", "slices", "frame", "physics", "relative_l2", "bias",
           "reference_error", "fog_ms", "on_front", "device"]


def read_rows(path):
    with path.open(newline="") as file:
        reader = csv.DictReader(file)
        missing = [column for column in COLUMNS if column not in (reader.fieldnames or [])]
        if missing:
            raise ValueError(f"'{path}' has no column '{missing[0]}'")
        rows = list(reader)
    if not rows:
        raise ValueError(f"'{path}' has no rows")
    for row in rows:
        for column in ("relative_l2", "bias", "reference_error", "fog_ms"):
            row[column] = float(row[column])
        row["slices"] = int(row["slices"])
        row["frame"] = int(row["frame"])
        row["on_front"] = row["on_front"] == "1"
    return rows


def judged(rows):
    """Of each picture the last frame against the first truth, which leaves nothing out."""
    last = max(row["frame"] for row in rows)
    return [row for row in rows if row["frame"] == last and row["physics"] == rows[0]["physics"]]


def plot_scene(scene, rows, folder):
    figure, axes = plt.subplots(figsize=(7.0, 5.0), constrained_layout=True)
    techniques = sorted({(row["integrator"], row["visibility"], row["grid"]) for row in rows})
    colors = matplotlib.colormaps["turbo"]
    for index, technique in enumerate(techniques):
        curve = sorted((row["slices"], row["fog_ms"], row["relative_l2"]) for row in rows
                       if (row["integrator"], row["visibility"], row["grid"]) == technique)
        axes.plot([ms for _, ms, _ in curve], [error for _, _, error in curve], marker="o", markersize=4,
                  linewidth=1, color=colors((index + 0.5) / len(techniques)), label=", ".join(technique))
    front = sorted((row["fog_ms"], row["relative_l2"]) for row in rows if row["on_front"])
    axes.step([ms for ms, _ in front], [error for _, error in front], where="post", color="black", linewidth=2,
              alpha=0.4, label="Pareto front")
    axes.set(xscale="log", yscale="log", xlabel="fog's passes, ms", ylabel="relative L2 error of linear radiance",
             title=f"{scene}, {rows[0]['device']}")
    axes.grid(which="both", alpha=0.3)
    axes.legend(fontsize="x-small")
    for suffix in ("png", "svg"):
        figure.savefig(folder / f"precision_{scene}.{suffix}", dpi=150)
    plt.close(figure)


def table(rows):
    names = ["integrator", "visibility", "grid", "slices", "frame", "physics", "relative_l2", "bias", "fog_ms",
             "reference_error"]
    formats = {"relative_l2": "{:.3%}", "bias": "{:+.3%}", "fog_ms": "{:.2f}", "reference_error": "{:.0e}"}
    lines = ["<table><tr>" + "".join(f"<th>{name}</th>" for name in names) + "</tr>"]
    for row in rows:
        cells = (html.escape(formats.get(name, "{}").format(row[name])) for name in names)
        lines.append(f"<tr{' class=front' if row['on_front'] else ''}>"
                     + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    return "\n".join(lines + ["</table>"])


def write_page(rows, scenes, folder):
    style = ("body{font:14px sans-serif;max-width:70em;margin:2em auto}td,th{padding:.1em .6em;text-align:right}"
             ".front{font-weight:bold}")
    parts = [f"<!doctype html><meta charset=utf-8><title>Error against run time</title><style>{style}</style>",
             "<h1>Error against run time</h1>", f"<p>{html.escape(rows[0]['device'])}. Bold: nothing measured is both",
             " faster and more exact, of the same scene, frame and truth.</p>"]
    for scene in scenes:
        svg = (folder / f"precision_{scene}.svg").read_text()
        parts += [f"<h2>{html.escape(scene)}</h2>", svg[svg.index("<svg"):],
                  table([row for row in rows if row["scene"] == scene])]
    (folder / "precision.html").write_text("\n".join(parts))


def main(arguments):
    if len(arguments) != 1:
        print("plot.py: give the folder that `tyndall precision --out` wrote", file=sys.stderr)
        return 2
    folder = pathlib.Path(arguments[0])
    try:
        rows = read_rows(folder / "precision.csv")
    except (OSError, ValueError, KeyError) as error:
        print(f"plot.py: {error}", file=sys.stderr)
        return 2
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    for scene in scenes:
        plot_scene(scene, judged([row for row in rows if row["scene"] == scene]), folder)
    write_page(rows, scenes, folder)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
