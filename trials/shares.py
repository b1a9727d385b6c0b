"""A share and how well it is known."""

from dataclasses import dataclass
from math import nan, sqrt

NORMAL95 = 1.959963984540054


@dataclass(frozen=True)
class Share:
    """count of n."""

    count: int
    n: int

    @property
    def value(self) -> float:
        """The share, nan when n is 0."""
        return self.count / self.n if self.n else nan

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval (Wilson 1927)."""
        if not self.n:
            return 0.0, 1.0
        z2, p = NORMAL95**2, self.value
        centre = (p + z2 / (2 * self.n)) / (1 + z2 / self.n)
        half = NORMAL95 / (1 + z2 / self.n) * sqrt(p * (1 - p) / self.n + z2 / (4 * self.n**2))
        return max(centre - half, 0.0), min(centre + half, 1.0)

    def text(self) -> str:
        """Return such as "97 % (58/60; 89-99)"."""
        if not self.n:
            return "- (0)"
        low, high = self.interval
        return f"{100 * self.value:.0f} % ({self.count}/{self.n}; {100 * low:.0f}-{100 * high:.0f})"

    def data(self) -> dict[str, object]:
        """Return count, n, share and interval for JSON."""
        return {"count": self.count, "n": self.n, "share": self.value if self.n else None,
                "interval95": list(self.interval)}  # fmt: skip
