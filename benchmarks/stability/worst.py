"""How is an extreme judged? The worst figure of each invariant, at every exact fidelity, against what is
allowed.

Used by ``python -m benchmarks.stability``. Figures and limits are dicts by the name of the invariant.
"""

import numpy as np

EXACT_FIDELITIES = ("fast", "standard", "reference")


def note(worst, name, figure):
    """Keep the worst; what is not a number is the worst of all."""
    worst[name] = max(worst[name], np.inf if np.isnan(figure) else float(figure))


def merge(figures):
    """The worst of several."""
    return {
        name: sum(f[name] for f in figures) if name in ("unsolved", "lost") else max(f[name] for f in figures)
        for name in figures[0]
    }


def verdict(figures, limits):
    """Names of the invariants that fail."""
    return [name for name, limit in limits.items() if not figures[name] <= limit]
