"""What do the pockets look like in one picture? Draws ``pockets.png`` from the figures of ``python -m benchmarks.pockets``."""

from .._common.command import pyplot, save_figure
from .pool_tables import ANGLES, INCH, SPEEDS

AFTER, BEFORE = "the drop takes time", "at once at the edge"


def _against_speed(ax, figures, table, pocket):
    """Lateral window of a rolling ball against speed, one colour an angle."""
    rows = [r for r in figures["windows"] if (r["table"], r["pocket"], r["ball"], r["measure"]) == (table, pocket, "rolling", "mm")]
    rows = [r for r in rows if r["distance"] == min(r["distance"] for r in rows)]
    last = figures["speeds"][-1]
    for k, row in enumerate(rows):
        ax.plot(figures["speeds"], row["after"], "o-", color=f"C{k}", ms=4)
        ax.plot(figures["speeds"], row["before"], ":", color=f"C{k}", lw=1.4)
        ax.annotate(f"{row['angle']} deg", (last, row["after"][-1]), (6, 0), textcoords="offset points", va="center", fontsize=9,
                    color=f"C{k}")  # fmt: skip
    ax.set(xlabel="speed 0.3 m before the pocket [m/s]", ylabel="window [mm]", ylim=(0, None), xlim=(0, 1.25 * last))
    ax.set_title(f"{pocket} pocket, table {table!r}", fontsize=11)
    ax.grid(alpha=0.3)


def _against_distance(ax, figures):
    """Window as an angle against the distance."""
    for k, (pocket, angle) in enumerate((("corner", 0), ("corner", 40), ("middle", 0), ("middle", 60))):
        for speed, line in ((1.0, "o-"), (6.0, "s--")):
            want = ("match", pocket, angle, "rolling", "deg")
            rows = [r for r in figures["windows"] if (r["table"], r["pocket"], r["angle"], r["ball"], r["measure"]) == want]
            y = [r["after"][figures["speeds"].index(speed)] for r in rows]
            name = f"{pocket} {angle} deg" if speed == 1.0 else None
            ax.plot([r["distance"] for r in rows], y, line, color=f"C{k}", ms=4, label=name)
    ax.set(xlabel="distance [m]", ylabel="window [degrees]", xscale="log", yscale="log")
    ticks = sorted({r["distance"] for r in figures["windows"]})
    ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
    ax.set_xticks([], minor=True)
    ax.set_yticks([0.3, 1, 3, 10], ["0.3", "1", "3", "10"])
    ax.set_title("table 'match': 1 m/s solid, 6 m/s dashed", fontsize=11)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8.5)


def _rail(ax, figures):
    """Marks: what drops along the rail, rolling ball."""
    rail = figures["rail"]
    rows = [(table, run, off) for table in ("match", "tight") for run in rail["runs"] for off in rail["offs"]]
    at = {(m["table"], m["run"], m["off"]): m for m in rail["marks"] if m["ball"] == "rolling"}
    for y, row in enumerate(rows):
        for x, _ in enumerate(rail["speeds"]):
            m = at[row]
            if not m["arrives"][x]:
                ax.text(x, y, "-", ha="center", va="center", color="0.5", fontsize=9)
                continue
            potted = m["after"][x]
            ax.plot(x, y, "o" if potted else "x", color="C2" if potted else "C3", ms=7, mew=1.6)
            if m["before"][x] != potted:
                ax.plot(x, y, "s", mfc="none", mec="0.3", ms=12, mew=0.9)
    ax.set_xticks(range(len(rail["speeds"])), [f"{v:g}" for v in rail["speeds"]], fontsize=9)
    names = [f"{table}, {run:g} m, " + ("frozen" if off == 0 else f"{1e3 * off:g} mm off") for table, run, off in rows]
    ax.set_yticks(range(len(rows)), names, fontsize=8)
    ax.set(xlabel="speed [m/s]", ylim=(len(rows) - 0.4, -0.6), xlim=(-0.6, len(rail["speeds"]) - 0.4))
    ax.tick_params(length=0)
    ax.set_title("down the rail, rolling: o drops, x does not\n(square: otherwise when at once at the edge)", fontsize=10)


def _pool(ax, figures):
    """Effective target sizes of Alciatore's pool pockets."""
    for k, kind in enumerate(("corner", "side")):
        sizes = figures["pool"][kind]
        ax.plot(ANGLES[kind], sizes["Alciatore"], "-", color=f"C{k}", lw=3, alpha=0.35, label=f"{kind}, Alciatore (slow)")
        for name, mark in (("slow", "o-"), ("fast", "s--")):
            ax.plot(ANGLES[kind], sizes[f"{name} after"], mark, color=f"C{k}", ms=4, label=f"{kind}, {SPEEDS[name]:g} m/s here")
    ax.set(xlabel="angle off the axis [degrees]", ylabel="target size [in]", ylim=(0, None))
    scale = ax.secondary_yaxis("right", functions=(lambda x: x * INCH * 1e3, lambda x: x / INCH / 1e3))
    scale.set_ylabel("[mm]")
    ax.set_title("pool pockets of TP 3.5 and TP 3.6", fontsize=11)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)


def draw(figures, out):
    """Six panels: windows against speed (three), against distance, down the rail, pool."""
    plt = pyplot()
    fig, axes = plt.subplots(3, 2, figsize=(9, 12), layout="constrained", gridspec_kw={"height_ratios": [1, 1, 1.25]})
    _against_speed(axes[0, 0], figures, "match", "corner")
    _against_speed(axes[0, 1], figures, "tight", "corner")
    _against_speed(axes[1, 0], figures, "match", "middle")
    _against_distance(axes[1, 1], figures)
    _rail(axes[2, 0], figures)
    _pool(axes[2, 1], figures)
    for ax in axes[0]:
        ax.set_ylim(0, 70)
    fig.suptitle(f"How wide the pockets are, by angle off the axis. Solid: {AFTER}; dotted: {BEFORE}", fontsize=12)
    save_figure(fig, out, dpi=100)
