"""The residual that the simple peers look at, with the baseline taken out of it and of every candidate."""

from dataclasses import dataclass

import numpy as np

from .columns import Group, load

RIDGE = 1e-6


@dataclass(frozen=True)
class Problem:
    """Per joint: residual (n,) and candidates (n, C), divided by the residual's rms; groups; row count."""

    residual: list[np.ndarray]
    columns: list[np.ndarray]
    groups: list[Group]
    recordings: np.ndarray  # (n,) which recording a row is from


def problem(files, flexible: bool = False) -> Problem:
    """With a reference: less what a model fitted to it predicts. Without: less the published one and friction.

    flexible: the model fitted to the reference also has curves of speed and position.
    """
    seen = [load(path, files.robot) for path in files.recordings]
    before = [load(path, files.robot)[0] for path in files.reference]
    groups, tracks = seen[0][1], [track for track, _ in seen]
    which = np.concatenate([np.full(len(t.torque), k) for k, t in enumerate(tracks)])
    residual, columns = [], []
    for j in range(6):
        keep = np.concatenate([t.moving[:, j] for t in tracks])
        y = np.concatenate([t.torque[:, j] for t in tracks])
        x = np.vstack([t.candidates[j] for t in tracks])
        base = np.vstack([explained(t, j, flexible) for t in tracks])
        if before:
            theta = ridge(
                np.vstack([explained(t, j, flexible) for t in before]),
                np.concatenate([t.torque[:, j] for t in before]),
                np.concatenate([t.moving[:, j] for t in before]),
            )
            r = y - base @ theta
        else:
            f = np.vstack([t.friction[j][:, :2] for t in tracks])
            y = y - np.concatenate([t.nominal[:, j] for t in tracks])
            r = y - f @ ridge(f, y, keep)
            x = x - f @ ridge(f, x, keep)
        r, x = r * keep, x * keep[:, None]
        scale = max(np.sqrt((r**2).sum() / max(keep.sum(), 1)), 1e-9)
        residual.append(r / scale)
        columns.append(x / scale)
    return Problem(residual, columns, groups, which)


def explained(track, j, flexible):
    x = np.hstack([track.base[j], track.friction[j]])
    if not flexible:
        return x
    speed = track.friction[j][:, 1]
    knots = np.linspace(-2.0, 2.0, 13)
    return np.hstack([x, np.exp(-(((speed[:, None] - knots) / 0.3) ** 2))])


def ridge(x, y, keep):
    x, y = x[keep], y[keep]
    size = np.sqrt((x**2).mean(0)) + 1e-12
    z = x / size
    solved = np.linalg.solve(z.T @ z + RIDGE * len(z) * np.eye(z.shape[1]), z.T @ y)
    return solved / (size if y.ndim == 1 else size[:, None])


def gain(p: Problem, residual, group: Group):
    """Drop of the sum of squares over all joints when a group's columns are fitted, and the fit by joint."""
    total, fits = 0.0, {}
    for j, places in enumerate(group.places):
        if places:
            x = p.columns[j][:, list(places)]
            theta = ridge(x, residual[j], np.ones(len(x), bool))
            rest = residual[j] - x @ theta
            total += float(residual[j] @ residual[j] - rest @ rest)
            fits[j] = rest
    return total, fits


def width(group: Group) -> int:
    """Free parameters: a column that several joints share counts once."""
    return max(len(places) for places in group.places) or 1


def stepwise(p: Problem, effective: list[float], most: int = 4) -> list[Group]:
    """Forward selection by BIC over groups; effective: number of independent rows of each joint."""
    residual, chosen = list(p.residual), []
    for _ in range(most):
        best = (0.0, None, {})
        for group in p.groups:
            if group in chosen:
                continue
            _, fits = gain(p, residual, group)
            drop = -width(group) * np.log(sum(effective[j] for j in fits) or 1.0)
            for j, rest in fits.items():
                was, now = residual[j] @ residual[j], rest @ rest
                if was > 0:
                    drop += effective[j] * np.log(was / max(now, 1e-12))
            if drop > best[0]:
                best = (drop, group, fits)
        if best[1] is None:
            break
        chosen.append(best[1])
        for j, rest in best[2].items():
            residual[j] = rest
    return chosen


def effective_rows(p: Problem, j: int) -> float:
    """Rows over twice the autocorrelation time of the residual of joint j (initial positive sequence)."""
    r = p.residual[j]
    n = len(r)
    spectrum = np.abs(np.fft.rfft(r - r.mean(), 2 * n)) ** 2
    rho = np.fft.irfft(spectrum)[:n]
    rho = rho / max(rho[0], 1e-12)
    end = np.argmax(rho < 0.05) or n
    return n / max(1.0, 1.0 + 2.0 * float(rho[1:end].sum()))
