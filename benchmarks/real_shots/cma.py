"""How is a rough function of a few numbers minimised? By CMA-ES (Hansen 2016, arXiv:1604.00772): ask for candidates, then
report their costs; mean, step size and covariance follow the better half."""

import numpy as np


class Cma:
    """A search from ``start`` (n,), in units of ``scale`` (n,), with step size ``sigma``."""

    def __init__(self, rng, start, scale, sigma, population):
        n = len(start)
        self._rng, self._start, self._scale, self.sigma, self.population = (
            rng,
            start,
            scale,
            sigma,
            population,
        )
        weights = np.log(population / 2 + 0.5) - np.log(np.arange(1, population // 2 + 1))
        self._weights = weights / weights.sum()
        self._mu = mu = 1.0 / (self._weights**2).sum()
        self._cc, self._cs = (4 + mu / n) / (n + 4 + 2 * mu / n), (mu + 2) / (n + mu + 5)
        self._c1 = 2 / ((n + 1.3) ** 2 + mu)
        self._cmu = min(1 - self._c1, 2 * (mu - 2 + 1 / mu) / ((n + 2) ** 2 + mu))
        self._damps = 1 + 2 * max(0, np.sqrt((mu - 1) / (n + 1)) - 1) + self._cs
        self._chi = np.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n))
        self._mean, self._C, self._pc, self._ps = np.zeros(n), np.eye(n), np.zeros(n), np.zeros(n)
        self._told = 0

    def ask(self):
        """Return candidates (population, n)."""
        d, self._B = np.linalg.eigh(self._C)
        self._d = np.sqrt(np.maximum(d, 1e-14))
        y = (self._rng.normal(size=(self.population, len(self._mean))) * self._d) @ self._B.T
        return self._start + (self._mean + self.sigma * y) * self._scale

    @property
    def spread(self):
        """The longest axis of the candidates, in units of ``scale``."""
        return self.sigma * self._d.max()

    @property
    def mean(self):
        """The centre of the candidates."""
        return self._start + self._mean * self._scale

    def tell(self, candidates, costs):
        """Report the costs of candidates, which may have moved since ``ask``."""
        n, mu, cs, cc = len(self._mean), self._mu, self._cs, self._cc
        self._told += 1
        best = np.argsort(costs)[: len(self._weights)]
        y = (((candidates - self._start) / self._scale - self._mean) / self.sigma)[best]
        step = self._weights @ y
        self._mean = self._mean + self.sigma * step
        self._ps = (1 - cs) * self._ps + np.sqrt(cs * (2 - cs) * mu) * (
            self._B @ ((self._B.T @ step) / self._d)
        )
        length = np.linalg.norm(self._ps)
        short = length / np.sqrt(1 - (1 - cs) ** (2 * self._told)) < (1.4 + 2 / (n + 1)) * self._chi
        self._pc = (1 - cc) * self._pc + short * np.sqrt(cc * (2 - cc) * mu) * step
        self._C = (1 - self._c1 - self._cmu) * self._C + self._c1 * np.outer(self._pc, self._pc)
        self._C += self._cmu * (y.T * self._weights) @ y
        self.sigma *= np.exp(min((cs / self._damps) * (length / self._chi - 1), 0.6))
