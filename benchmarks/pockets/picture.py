"""How wide are the pockets, in one chart? Draws ``pockets.png`` from the figures of
``python -m benchmarks.pockets``."""

from commands import picture_style

from .pool_tables import ANGLES, INCH, SPEEDS

COLOURS = (picture_style.BLUE, picture_style.ORANGE, picture_style.GREEN, picture_style.PURPLE)
DROPS, DOES_NOT = picture_style.BLUE, picture_style.ORANGE


def _against_speed(ax, figures, table, pocket, top):
    """Lateral window of a rolling ball against speed, one colour an angle."""
    rows = [
        r
        for r in figures["windows"]
        if (r["table"], r["pocket"], r["ball"], r["measure"]) == (table, pocket, "rolling", "mm")
    ]
    rows = [r for r in rows if r["distance"] == min(r["distance"] for r in rows)]
    last = figures["speeds"][-1]
    for row, colour in zip(rows, COLOURS, strict=False):
        ax.plot(figures["speeds"], row["after"], "o-", color=colour)
        ax.plot(figures["speeds"], row["before"], ":", color=colour)
        ax.annotate(
            f"{row['angle']}°",
            (last, row["after"][-1]),
            (7, 0),
            textcoords="offset points",
            va="center",
            color=colour,
            size=picture_style.TEXT,
            weight="bold",
        )
    ax.set(
        xlabel="speed [m/s]",
        ylabel="window [mm]",
        ylim=(0, top),
        xlim=(0, 1.16 * last),
        title=f"{pocket} pocket, table {table!r}".capitalize(),
    )


def _against_distance(ax, figures):
    """Window as an angle against the distance."""
    slow, fast = (min(figures["speeds"], key=lambda v, to=to: abs(v - to)) for to in (1.0, 6.0))
    for (pocket, angle), colour in zip(
        (("corner", 0), ("corner", 40), ("middle", 0), ("middle", 60)), COLOURS, strict=True
    ):
        for speed, line in ((slow, "o-"), (fast, "s--")):
            want = ("match", pocket, angle, "rolling", "deg")
            rows = [
                r
                for r in figures["windows"]
                if (r["table"], r["pocket"], r["angle"], r["ball"], r["measure"]) == want
            ]
            y = [r["after"][figures["speeds"].index(speed)] for r in rows]
            name = f"{pocket}, {angle}°" if speed == slow else None
            ax.plot([r["distance"] for r in rows], y, line, color=colour, label=name)
    picture_style.log_axis(ax.xaxis)
    picture_style.log_axis(ax.yaxis, subs=(1, 3))
    ticks = sorted({r["distance"] for r in figures["windows"]})
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
    ax.set(
        xlabel="distance [m]",
        ylabel="window [degrees]",
        title=f"With the distance: {slow:g} m/s, dashed {fast:g} m/s",
    )
    ax.legend(loc="lower left")


def _rail(ax, figures):
    """Marks: what drops along the rail, rolling ball."""
    rail = figures["rail"]
    rows = [(table, run, off) for table in ("match", "tight") for run in rail["runs"] for off in rail["offs"]]
    at = {(m["table"], m["run"], m["off"]): m for m in rail["marks"] if m["ball"] == "rolling"}
    for y, row in enumerate(rows):
        for x, _ in enumerate(rail["speeds"]):
            m = at[row]
            if not m["arrives"][x]:
                continue
            potted = m["after"][x]
            ax.plot(x, y, "o" if potted else "x", color=DROPS if potted else DOES_NOT, ms=7, mew=2.0)
            if m["before"][x] != potted:
                ax.plot(x, y, "s", mfc="none", mec=picture_style.INK, ms=12, mew=1.0)
    ax.set_xticks(range(len(rail["speeds"])), [f"{v:g}" for v in rail["speeds"]])
    names = [
        f"{table}, {run:g} m, " + ("touching" if off == 0 else f"{1e3 * off:g} mm off")
        for table, run, off in rows
    ]
    ax.set_yticks(range(len(rows)), names)
    ax.set(
        xlabel="speed [m/s]",
        ylim=(len(rows) - 0.4, -0.6),
        xlim=(-0.6, len(rail["speeds"]) - 0.4),
        title="Along the rail, rolling ball",
    )
    ax.tick_params(length=0)
    for mark, colour, label in (
        ("o", DROPS, "drops"),
        ("x", DOES_NOT, "does not"),
        ("s", picture_style.INK, "differs if at once"),
    ):
        ax.plot(
            [],
            [],
            mark,
            color=colour,
            mfc="none" if mark == "s" else colour,
            ms=7,
            mew=1.0 if mark == "s" else 2.0,
            label=label,
        )
    ax.legend(loc="upper center", bbox_to_anchor=(0.36, -0.13), ncols=3, handletextpad=0.2, columnspacing=0.8)


def _pool(ax, figures):
    """Effective target sizes of Alciatore's pool pockets."""
    for kind, colour in zip(("corner", "side"), COLOURS, strict=False):
        sizes = figures["pool"][kind]
        ax.plot(
            ANGLES[kind],
            sizes["Alciatore"],
            "-",
            color=colour,
            lw=5,
            alpha=0.3,
            label=f"{kind}, Alciatore, slow",
        )
        for name, mark in (("slow", "o-"), ("fast", "s--")):
            ax.plot(
                ANGLES[kind],
                sizes[f"{name} after"],
                mark,
                color=colour,
                label=f"{kind}, here, {SPEEDS[name]:g} m/s",
            )
    ax.set(xlabel="angle off the pocket's axis [degrees]", ylabel="target size [inches]", ylim=(0, None))
    scale = ax.secondary_yaxis("right", functions=(lambda x: x * INCH * 1e3, lambda x: x / INCH / 1e3))
    scale.set_ylabel("[mm]")
    ax.set_title("Pool pockets, beside Alciatore's TP 3.5, 3.6")
    ax.legend(loc="lower left")


def draw(figures, out):
    """Six panels: windows against speed (three), against distance, along the rail, pool."""
    note = (
        "Window: the range of paths that drop, of one rolling ball, by the angle of its path off the pocket's axis (degrees at the lines)\n"
        f"and its speed {min(r['distance'] for r in figures['windows']):g} m before the pocket. Solid: the drop takes time. "
        "Dotted: a ball drops at once where its centre crosses the edge."
    )
    with picture_style.drawing() as plt:
        fig, axes = picture_style.page(
            plt,
            12.2,
            "How wide the pockets are",
            note,
            foot="python -m benchmarks.pockets, physics 'match'",
            rows=3,
            columns=2,
            height_ratios=[1, 1, 1.35],
        )
        _against_speed(axes[0, 0], figures, "match", "corner", 70)
        _against_speed(axes[0, 1], figures, "tight", "corner", 70)
        _against_speed(axes[1, 0], figures, "match", "middle", 95)
        _against_distance(axes[1, 1], figures)
        _rail(axes[2, 0], figures)
        _pool(axes[2, 1], figures)
        picture_style.save(fig, out)
