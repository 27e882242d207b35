"""Which noise samples does the lookahead use? Five representative ones; ``python -m agents.noise_samples``.

The outcome of a shot is an expectation over five errors (speed, side, top, aim, elevation), for which a few
random draws may lie on one side. ``EVEN_SAMPLES`` are keys of random streams (``game.philox``) whose errors of
each kind are close to five equally likely values (-1.28, -0.52, 0, 0.52, 1.28 standard deviations; scaled to
variance 1 they would overstate misses) and nearly uncorrelated. All positions and strokes use the same ones
(common random numbers), so strokes are compared under equal luck.
"""

from statistics import NormalDist

from commands.lifecycle import command, needs, parser_of

with needs("agents.noise_samples"):
    import numpy as np

    from snooker_env.planning.sobol import EVEN_SAMPLES
    from snooker_env.tasks.noise import errors_of

WEIGHTS = np.array([1.0, 0.5, 0.5, 1.0, 0.1])
"""Importance of an even spread of the errors of speed, side, top, aim and elevation."""


def first_of(keys):
    """The streams with these ``keys``, at their beginnings: uint64 (n, 2)."""
    return np.stack([np.asarray(keys, np.uint64), np.zeros(len(keys), np.uint64)], axis=1)


def unevenness(errors):
    """How unevenly sets of errors (..., k, 5) are spread: weighted squares of the distances from k equally
    likely values, plus weighted squares of the correlations between kinds."""
    k = errors.shape[-2]
    even = np.array([NormalDist().inv_cdf((i + 0.5) / k) for i in range(k)])
    apart = np.sort(errors, axis=-2) - even[:, None]
    products = np.einsum("...ki,...kj->...ij", errors, errors) / k * (1.0 - np.eye(5))
    together = (np.outer(WEIGHTS, WEIGHTS) * products**2).sum((-1, -2))
    return (WEIGHTS * (apart**2).mean(-2)).sum(-1) + 0.5 * together


def find(k, keys=5_000, starts=20, seed=0):
    """(k of the first ``keys`` keys, their unevenness, the median one of random sets): the best of so many
    random ``starts`` of a search that exchanges one key at a time."""
    errors, rng = errors_of(first_of(np.arange(1, keys + 1))), np.random.default_rng(seed)
    best, least = np.zeros(k, np.int64), np.inf
    for _ in range(starts):
        some, uneven, before = rng.choice(keys, k, replace=False), np.inf, None
        while uneven != before:
            before = uneven
            for i in range(k):
                sets = np.repeat(some[None], keys, 0)
                sets[:, i] = np.arange(keys)
                all_of = unevenness(errors[sets])
                some[i], uneven = all_of.argmin(), float(all_of.min())
        if uneven < least:
            best, least = some + 1, uneven
    return best, least, float(np.median(unevenness(errors[rng.integers(keys, size=(1000, k))])))


@command("agents.noise_samples")
def main(argv=None):
    """Find the samples and print them; takes seconds. Exit code 0."""
    parser_of("python -m agents.noise_samples", __doc__).parse_args(argv)
    best, least, median = find(len(EVEN_SAMPLES))
    compared = f"unevenness {least:.3f}, of a set drawn at random {median:.2f} (median)"
    print(f"EVEN_SAMPLES = {tuple(map(int, best))}: {compared}")
    print(errors_of(first_of(best)).round(2))
    return 0
