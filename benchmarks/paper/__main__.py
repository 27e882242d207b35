"""Does the package give the paper's numbers, and who follows the measurements? The paper reproduced, other
models, other data.

    python -m benchmarks.paper [--json FILE] [--out FOLDER] [--no-pictures]

Paper: Mathavan, Jackson & Parkin (2014). Tables 1 and 2; the error of each collision model per shot (Figs. 7
and 8); full hits (Fig. 4); the curved object ball (Fig. 6); one pot with different spins (Fig. 1); throw and
cushion rebound against other data. The models are stated in ``paper_shots.py`` and ``other_data.py``. Takes a
few seconds; the pictures (``paper.png``, ``paper_data.png``) need matplotlib, which
``pip install -e ".[test]"`` brings.
"""

import numpy as np

from .._common.command import Command, run, save_figures
from . import other_data, paper_shots
from .paper_shots import MEASURED_TO, QUANTITIES

FILES = ("paper.png", "paper_data.png")
PATH = 81
"""Points of a path that is kept."""
LABELS = dict(
    zip(
        QUANTITIES,
        ("cue ball's speed", "object ball's speed", "cue ball's angle", "object ball's angle"),
        strict=True,
    )
)


def measure():
    """Every figure."""
    found = paper_shots.predictions()
    shots = paper_shots.spin_shots()
    curves = [paper_shots.curved_path(mu) for mu in paper_shots.CURVED["mu_bb"]]
    figures = {
        "tables": paper_shots.table_rows(found),
        "models": paper_shots.model_rows(found),
        "head_on": paper_shots.head_on(),
        "curved": [c | {"path": c["path"][::5].round(6).tolist()} for c in curves],
        "spins": [
            {
                "top": top,
                "side": side,
                "aim_shift_deg": shift,
                "cue_ball": s.positions[0].tolist(),
                "duration": s.duration,
                "path": s.at(np.linspace(0.0, s.duration, PATH))[0][:, 0].round(4).tolist(),
            }
            for top, side, shift, s in shots
        ],
        "throw_a14": other_data.a14(),
        "throw_domenech": other_data.domenech(),
        "cushion": other_data.cushion(),
    }
    return figures


def print_tables(rows):
    """Tables 1 and 2; a star marks what the printed paper gets wrong."""
    print(
        "Tables 1 and 2: once both balls roll; errors of speeds over the prediction, of angles over the measurement, as the paper's"
    )
    print(
        "quantity             shot  measured  printed   euler:10000  reference   error %: printed  computed"
    )
    for r in rows:
        d = 3 if r["quantity"].startswith("v") else 2
        star, error_star = ("*" if r[k] else " " for k in ("slip", "error_slip"))
        print(
            f"{LABELS[r['quantity']]:20s} {r['shot']:4d}  {r['measured']:8.{d}f}  {r['printed']:7.{d}f}{star}  {r['euler:10000']:11.{d}f}"
            f"  {r['reference']:9.{d}f}  {r['printed_error']:15.2f}{error_star}  {r['error']:8.2f}"
        )
    right = sum(not r["slip"] for r in rows)
    gap = {
        kind: max(abs(r["reference"] - r["euler:10000"]) for r in rows if r["quantity"].startswith(kind))
        for kind in ("v", "angle")
    }
    print(f"euler:10000 gives {right} of the {len(rows)} printed predictions; * printed, but not borne out:")
    for r in rows:
        what = f"shot {r['shot']}, {LABELS[r['quantity']]}"
        if r["slip"]:
            print(f"  {what}: printed {r['printed']:.3f}, computed {r['euler:10000']:.3f}")
        if r["error_slip"]:
            print(f"  {what}, its error: printed {r['printed_error']:.2f} %, computed {r['error']:.2f} %")
    print(
        f"The converged solution (reference) differs from it by at most {gap['v']:.4f} m/s and {gap['angle']:.3f} deg."
    )


def print_models(models):
    """Figs. 7 and 8: the error of each model per shot, then who is right how often."""
    print("\nFigs. 7 and 8: error of each model in % of the measured value, shots 1 to 5")
    for j, quantity in enumerate(QUANTITIES):
        print(
            LABELS[quantity]
            + (" (the measured one is the cut angle by definition: tests no model)" if j == 3 else "")
        )
        for name, m in models.items():
            print(f"  {name:28s}" + "".join(f"{e:8.1f}" for e in m["error_percent"][j]))
    print("\nrms error in %, and on how many shots a model is within the camera's accuracy")
    print(
        "                                 all shots: v_c    v_o  angle_c   without shot 1: v_c    v_o  angle_c   within"
    )
    for name, m in models.items():
        every, rest = m["rms_percent"][:3], m["rms_percent_without_shot_1"][:3]
        within = " ".join(f"{n}/5" for n in m["within_camera"])
        print(
            f"  {name:28s}"
            + "".join(f"{x:{w}.1f}" for x, w in zip((*every, *rest), (18, 7, 9, 22, 7, 9), strict=True))
            + f"   {within}"
        )
    worst = {name: max(m["rms_percent_without_shot_1"][:3]) for name, m in models.items()}
    order = sorted(worst, key=lambda name: worst[name])
    limits = ", ".join(f"{q} {x:g}" for q, x in MEASURED_TO.items())
    print(
        f"Camera's accuracy, by the paper: {limits} (m/s, deg). The worst of the three rms, without shot 1, best model first:"
    )
    print("  " + "; ".join(f"{name} {worst[name]:.1f} %" for name in order))
    hits = {name: sum(m["within_camera"]) for name, m in models.items()}
    best = [name for name, n in hits.items() if n == max(hits.values())]
    print(
        f"Within the camera's accuracy most often: {', '.join(best)}, on {max(hits.values())} of 15 numbers; they miss the others."
    )
    still = [
        e for name, m in models.items() if name in paper_shots.FRICTIONLESS for e in m["error_percent"][3]
    ]
    print(
        f"Object ball's angle: the models without friction err by {max(map(abs, still)):.2f} % at most, where the paper gives the models"
    )
    print(
        "without spin 9 to 12 %. Their equations and the heights of its bars are not in its text; the models here are those stated."
    )


def print_figures(figures):
    """Figs. 4, 6 and 1."""
    head = figures["head_on"]
    print(
        "\nFig. 4: object ball's speed [m/s] just after a full hit by a rolling cue ball (the paper's text has no measured points)"
    )
    print("  v0                       " + "".join(f"{v:9.2f}" for v in head["v0"]) + "   ratio at 1 m/s")
    for name, speeds in head.items():
        if name != "v0":
            print(
                f"  {name:25s}"
                + "".join(f"{v:9.4f}" for v in speeds)
                + f"   {speeds[head['v0'].index(1.0)]:.4f}"
            )
    c = paper_shots.CURVED
    print(f"\nFig. 6: object ball's path, rolling cue ball {c['v0']:g} m/s, cut {c['cut']:g} deg")
    print("  mu_bb  leaves at  rolls at  turns [deg]  slips for [s]  and [mm]  aside [mm]")
    for r in figures["curved"]:
        print(
            f"  {r['mu_bb']:5.2f} {r['leaves_deg']:10.2f} {r['rolls_deg']:9.2f} {r['leaves_deg'] - r['rolls_deg']:12.2f} {r['T_S']:14.3f}"
            f" {r['length'] * 1e3:9.0f} {r['aside'] * 1e3:11.2f}"
        )
    print(
        f"  largest gap between simulate() and the paper's parabola: {max(r['gap'] for r in figures['curved']):.0e} m"
    )
    pot = paper_shots.POT
    print(
        f"\nFig. 1: one pot at {pot['speed']:g} m/s; where the cue ball stops (x, y) [m], and how far the aim had to shift [deg]"
    )
    print("  top \\ side" + "".join(f"{s:+27.2f} R" for s in paper_shots.SIDES))
    for top in paper_shots.TOPS[::-1]:
        row = [s for s in figures["spins"] if s["top"] == top]
        cells = [
            f"   ({s['cue_ball'][0]:6.3f}, {s['cue_ball'][1]:6.3f}) {s['aim_shift_deg']:+6.2f}" for s in row
        ]
        print(f"  {top:+8.1f} R" + "".join(cells))


def print_throw(a14, domenech):
    """Throw against cut angle: the published table, then the measured one."""
    print("\nThrow [deg] of a pool ball, Marlow's friction (TP A.14, itself computed)")
    for kind, rows in a14.items():
        print(
            f"  {kind:25s}"
            + "".join(f"{c:7.0f}" for c in rows["cut"])
            + "   largest difference from the printed"
        )
        for name in list(rows)[1:]:
            gap = np.abs(np.array(rows[name]) - rows["printed"]).max()
            print(
                f"    {name:23s}"
                + "".join(f"{x:7.2f}" for x in rows[name])
                + ("" if name == "printed" else f"   {gap:.3f}")
            )
    stuns = [rows for rows in a14.values() if "closed form, mu follows" in rows]
    check = max(np.abs(np.array(rows["reference"]) - rows["closed form, mu follows"]).max() for rows in stuns)
    print(
        "  A.14 and fast keep the friction of the first slip; reference follows the slip down, where Marlow's friction is higher."
    )
    print(f"  Of the stun shots that too has a closed form, which reference meets to {check:.0e} deg.")
    d = domenech
    laws = list(d["laws"])
    print(
        f"\nMeasured throw [deg] (Domenech 2023, 61 mm balls, rolling at 0.80 m/s, {d['n']} shots), means over 10 deg of cut"
    )
    print("  cut       n  measured" + "".join(f"{name:>29s}" for name in laws))
    for b in d["bins"]:
        print(
            f"  {b['from']:2d} to {b['to']:2d} {b['n']:3d} {b['measured']:9.2f}"
            + "".join(f"{b[name]:29.2f}" for name in laws)
        )
    for key in ("mean", "rms", "largest"):
        print(f"  residual, {key:8s}    " + "".join(f"{d['misfit'][name][key]:29.2f}" for name in laws))
    print(
        f"  The data scatter by {d['scatter']:.2f} deg (rms) about a cubic. Throw is taken just after the impact;",
        end=" ",
    )
    print(f"the cloth then changes it by {d['largest_change_by_cloth']:.2f} deg at most (mu 0.10).")
    for name in laws:
        m, limit = d["misfit"][name], 2 * d["scatter"] / np.sqrt(d["n"])
        verdict = "misses the data" if abs(m["mean"]) > limit else "agrees on average"
        beyond = np.sqrt(max(0.0, m["rms"] ** 2 - d["scatter"] ** 2))
        print(
            f"  {name} {verdict}: mean residual {m['mean']:+.2f} deg (two standard errors {limit:.2f}), beyond the scatter {beyond:.2f}"
        )


def print_cushion(c):
    """Straight cushion rebounds."""
    slow, limit = len(c["incident"]) - c["n_fast"], other_data.FAST_REBOUND
    print("\nCushion rebound of a rolling ball (Mathavan 2010, Fig. 7a): residuals [m/s]", end=" ")
    print(f"at {slow} speeds to {limit:g} m/s, {c['n_fast']} above")
    print(
        "  model              to: mean    rms   above: mean    rms   largest of all   rebound/incident at the fastest"
    )
    for name, m in c["models"].items():
        a, b = m["slow"], m["fast"]
        numbers = f"{a['mean']:11.3f}{a['rms']:7.3f}{b['mean']:14.3f}{b['rms']:7.3f}{m['largest']:17.3f}{m['ratio_at_largest']:20.3f}"
        print(f"  {name:18s}{numbers}")
    print(
        f"  measured at the fastest, {c['incident'][-1]:.2f} m/s: {c['ratio_at_largest']:.3f}. match was fitted to these and other data,"
    )
    print(
        "  paper's 0.98 by its authors below 1.5 m/s; restitution alone leaves out friction at nose and cloth."
    )
    above = np.array(c["incident"]) > limit
    for name, m in c["models"].items():
        off = 100 * (np.array(m["rebound"]) / c["measured"] - 1)
        ranges = [f"{part.min():+.0f} to {part.max():+.0f} %" for part in (off[~above], off[above])]
        print(f"  {name}: off by {ranges[0]} up to {limit:g} m/s, by {ranges[1]} above")


def draw(folder, figures):
    """Both pictures into ``folder``."""
    from . import pictures

    paper, data = (folder / name for name in FILES)
    pictures.paper(paper, figures)
    pictures.data(data, figures)
    print(f"\n{paper}\n{data}")


def main(argv=None):
    """Command line."""
    options = Command("paper", __doc__, pictures=FILES, redraws=True).options(argv)
    figures = options.figures
    if figures is None:
        figures = measure()
        print_tables(figures["tables"])
        print_models(figures["models"])
        print_figures(figures)
        print_throw(figures["throw_a14"], figures["throw_domenech"])
        print_cushion(figures["cushion"])
        save_figures(options, figures)
    if options.pictures:
        draw(options.folder, figures)


if __name__ == "__main__":
    run(main)
