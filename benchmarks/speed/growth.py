"""How does the cost of a shot grow with the balls on the table, with events, with the batch and with threads?
Figures and their picture."""

import os
import time

import numpy as np

import snooker_env as sn
from commands import picture_style, provenance
from snooker_env.physics.impact import contact
from snooker_env.simulation import MAX_EVENTS, _run

BALLS = (2, 3, 4, 6, 8, 11, 15, 22)
BATCHES = tuple(4**k for k in range(9))  # 1 to 65,536
THREAD_BATCH = 4096
_ENOUGH = 1.0  # s of repeats for one figure
_LEAST = 256  # shots played for one figure: small batches are played one after the other


def kernel_call(p, v, w, threads=1, fidelity="standard"):
    """The batch through ``_run``: no checks, no result objects."""
    state = [np.array(a) for a in (p, v, w, np.ones(p.shape[:2], bool))]
    physics, table = sn.Physics.of(None), sn.Table.preset("match")
    start = time.perf_counter()
    _run(state, physics, table, contact.parse_fidelity(fidelity), MAX_EVENTS, threads=threads)
    return time.perf_counter() - start


def public_call(p, v, w, threads=1):
    """The batch through ``simulate_batch``."""
    start = time.perf_counter()
    sn.simulate_batch(p, v, w, threads=threads)
    return time.perf_counter() - start


def per_shot(call, shots, *options, repeats, batch=None):
    """Microseconds a shot: the quickest of ``repeats``, or of as many as fit into a second.

    A repeat is one ``call`` of all shots, or (``batch``) one call after the other of so many: every size then
    plays the same shots.
    """
    n = len(shots[0])
    slices = [tuple(a[k : k + (batch or n)] for a in shots) for k in range(0, n, batch or n)]
    found = []
    while not found or (len(found) < repeats and sum(found) < _ENOUGH):
        found.append(sum(call(*part, *options) for part in slices))
    return float(min(found)) / n * 1e6


def growth(make, time_shots, n, largest, repeats):
    """Figures. make(kind, n): sets of shots; time_shots(p, v, w): each shot's own us; ``largest``: no batch
    above it."""
    sets = {b: make(f"random {b} balls", n) for b in BALLS}
    times = {b: time_shots(*shots) for b, shots in sets.items()}
    counts = {b: sn.simulate_batch(*shots, threads=1).event_count for b, shots in sets.items()}
    rack, table = make("break-off", n), sets[22]
    batches = [b for b in BATCHES if b <= largest]
    sized = {b: _resized(table, max(b, _LEAST)) for b in batches}
    kernel = {b: per_shot(kernel_call, sized[b], repeats=repeats, batch=b) for b in batches}
    public = {b: per_shot(public_call, sized[b], repeats=repeats, batch=b) for b in batches}
    many = _resized(table, min(THREAD_BATCH, largest))
    return {
        "balls": [{"balls": b, "us": spread(times[b]), "events": float(counts[b].mean())} for b in BALLS],
        "events": {
            "random 22 balls": {"events": counts[22].tolist(), "us": times[22].tolist()},
            "break-off": {
                "events": sn.simulate_batch(*rack, threads=1).event_count.tolist(),
                "us": time_shots(*rack).tolist(),
            },
        },
        "batch": [{"shots": b, "kernel us": kernel[b], "simulate_batch us": public[b]} for b in batches],
        "threads": _by_threads(many, sorted({1, 2, os.cpu_count() or 1}), repeats),
    }


def _by_threads(shots, threads, repeats):
    """Rows; numbers of threads take turns, so that what else the machine does meets them all."""
    rows = [{"threads": t, "shots": len(shots[0])} for t in threads]
    for name, call in (("kernel us", kernel_call), ("simulate_batch us", public_call)):
        found, start = [], time.perf_counter()
        while not found or (len(found) < repeats and time.perf_counter() - start < _ENOUGH * len(threads)):
            found.append([per_shot(call, shots, t, repeats=1) for t in threads])
        for row, us in zip(rows, np.min(found, axis=0), strict=True):
            row[name] = float(us)
    return rows


def _resized(shots, size):
    """The first ``size`` shots of a set, over again where it is shorter."""
    return tuple(a[np.arange(size) % len(a)] for a in shots)


def spread(values):
    """Median, 5 %, 95 %."""
    return [float(q) for q in np.quantile(values, [0.5, 0.05, 0.95])]


def by_events(events, us, bins=12):
    """Medians over the shots in bins of equal numbers: [events], [us]."""
    order = np.argsort(events, kind="stable")
    groups = [g for g in np.array_split(order, min(bins, len(order))) if len(g)]
    return [float(np.median(events[g])) for g in groups], [float(np.median(us[g])) for g in groups]


def print_growth(found):
    """The tables."""
    print("\nGrowth, `standard`, one thread: us a shot")
    print("  balls on the table  " + "".join(f"{row['balls']:9d}" for row in found["balls"]))
    for k, name in enumerate(("median", "5 %", "95 %")):
        print(f"  {name:20s}" + "".join(f"{row['us'][k]:9.2f}" for row in found["balls"]))
    print("  events              " + "".join(f"{row['events']:9.1f}" for row in found["balls"]))
    for kind, of in found["events"].items():
        events, us = by_events(np.array(of["events"]), np.array(of["us"]), 8)
        print(f"  {kind}: events    " + "".join(f"{e:9.0f}" for e in events))
        print(f"  {' ' * len(kind)}  us        " + "".join(f"{u:9.1f}" for u in us))
    for key, of in (("batch", "shots"), ("threads", "threads")):
        print(
            f"  {of + ' at once' if key == 'batch' else of:20s}"
            + "".join(f"{row[of]:9d}" for row in found[key])
        )
        for name in ("kernel us", "simulate_batch us"):
            print(f"  {name:20s}" + "".join(f"{row[name]:9.2f}" for row in found[key]))


def draw(figures, file):
    """Four panels."""
    found = figures["growth"]
    foot = f"python -m benchmarks.speed --parts growth; {provenance.line(figures['machine'])}"
    note = "Fidelity standard. kernel: the compiled engine alone; simulate_batch: with checks of the input and result objects."
    with picture_style.drawing() as plt:
        figure, ((by_balls, by_event), (by_batch, by_thread)) = picture_style.page(
            plt, 7.6, "How the time of a simulated shot grows", note, foot=foot, rows=2, columns=2
        )
        balls = [row["balls"] for row in found["balls"]]
        median, low, high = np.array([row["us"] for row in found["balls"]]).T
        by_balls.fill_between(balls, low, high, alpha=0.18, lw=0, label="5 % to 95 % of shots")
        by_balls.plot(balls, median, "o-", label="median")
        by_balls.set(
            xlabel="balls on the table", ylabel="time of a shot [µs]", title="With the balls on the table"
        )
        by_balls.set_ylim(0, 1.35 * high.max())
        by_balls.set_xticks([2, 4, 6, 8, 11, 15, 22])
        for kind, of in found["events"].items():
            events, us = np.array(of["events"]), np.array(of["us"])
            (line,) = by_event.plot(*by_events(events, us), "o-", label=f"{kind}: medians", zorder=3)
            by_event.scatter(np.maximum(events, 1), us, s=4, alpha=0.25, color=line.get_color(), lw=0)
        by_event.set(
            xlabel="events in the shot", ylabel="time of a shot [µs]", title="With the events in a shot"
        )
        rows = found["threads"]
        for name, label in (("kernel us", "kernel"), ("simulate_batch us", "simulate_batch")):
            by_batch.plot(
                [r["shots"] for r in found["batch"]], [r[name] for r in found["batch"]], "o-", label=label
            )
            by_thread.plot([r["threads"] for r in rows], [1e6 / r[name] for r in rows], "o-", label=label)
        by_batch.set(
            xlabel="shots in a batch",
            ylabel="time of a shot [µs]",
            title="With the batch (22 balls, 1 thread)",
        )
        threads, kernel = [r["threads"] for r in rows], rows[0]["kernel us"]
        by_thread.plot(
            threads,
            [1e6 / kernel * t for t in threads],
            ":",
            color=picture_style.GREY,
            label="kernel times the threads",
        )
        title = f"With the threads (22 balls, {rows[0]['shots']:,} shots)"
        by_thread.set(xlabel="threads", ylabel="shots a second", title=title, ylim=(0, None), xticks=threads)
        by_thread.yaxis.set_major_formatter(picture_style.number)
        picture_style.log_axis(by_event.xaxis)
        picture_style.log_axis(by_event.yaxis)
        picture_style.log_axis(by_batch.xaxis, decades=2)
        picture_style.log_axis(by_batch.yaxis, subs=(1, 2, 3, 5))
        for axes in (by_balls, by_event, by_batch, by_thread):
            axes.legend(
                loc="lower left" if axes is by_thread else "upper right" if axes is by_batch else "upper left"
            )
        picture_style.save(figure, file)
