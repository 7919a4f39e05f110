# SPDX-License-Identifier: LGPL-2.1-or-later
"""How well measured curves determine parameters, by the noise that a fit leaves and the slopes of the residuals
(docs/calibration.md)."""

import dataclasses
import math

import numpy as np

LEVEL = 0.95
NO_EFFECT = 1e-9  # of the largest singular value: rounding
NO_SLOPE = 1e-9  # per range: rounding
MAX_CORRELATION = 0.99  # what short curves can tell from a drift
FEW_ROWS = 3  # beyond those that the parameters use up: too few for a noise of its own
SWEEPS, HALVINGS = 3, 20
TAKES_PART = 1e-6  # of a direction of length 1


@dataclasses.dataclass
class Noise:
    """Of one curve: a first-order autoregressive process. degrees: of freedom; rows as many as independent ones would tell as
    much, less parameters."""

    deviation: float = 0.0
    correlation: float = 0.0
    degrees: float = 1.0


@dataclasses.dataclass
class Confidence:
    noise: list  # per curve
    half_width: list  # of the 95 % interval per parameter; inf where it is not determined
    correlation: np.ndarray  # of the estimates; zeros for those that are not estimated
    undetermined: list  # directions (per parameter, of length 1) that the curves do not determine
    has_noise: bool  # False: there are not more rows than parameters, and nothing is known of the noise


def student_quantile(level, degrees):
    """The value that Student's t exceeds with the probability (1 - level) / 2."""
    from scipy.special import stdtrit
    return float(stdtrit(degrees, (1 + level) / 2))


def correlated(correlation, X):
    """Omega X of a first-order autoregressive process: Omega_ij = correlation^|i - j|."""
    from scipy.linalg import solve_banded
    bands = np.ones((2, len(X)))
    bands[1] = -correlation
    forward = solve_banded((1, 0), bands, X)
    backward = solve_banded((1, 0), bands, X[::-1])[::-1]
    return forward + backward - X


def _moments(A, B):
    """Sums of a_i b_i and a_i b_{i+1} over rows."""
    return np.array([np.sum(A * B), np.sum(A[:-1] * B[1:])])


class _Curve:
    """A curve's part of a fit: its residuals, and its rows of an orthonormal basis Q of the slopes."""

    def __init__(self, residuals, Q):
        self.residuals, self.Q = residuals, Q
        self.leverage = np.sum(Q * Q)  # parameters' worth of its rows that the fit has used up
        self.noise = None

    def spread(self, correlation):
        return self.Q.T @ correlated(correlation, self.Q)

    def expected(self, correlation, others):
        """Moments that a noise of deviation 1 leaves on average when a fit has taken out what it can, and what the noise of the
        other curves adds through the parameters."""
        Q, W, n = self.Q, correlated(correlation, self.Q), len(self.residuals)
        own = _moments(Q @ (Q.T @ W), Q) + [n, (n - 1) * correlation]
        own -= [2 * np.sum(W * Q), np.sum(Q[:-1] * W[1:]) + np.sum(W[:-1] * Q[1:])]
        return own, _moments(Q @ others, Q)

    def find_noise(self, others):
        """Deviation and correlation with which the residuals are as large, and as much alike from row to row, as they are.
        Residuals are less correlated than the noise: a fit takes out what is slow."""
        observed = _moments(self.residuals, self.residuals)

        def variance(own, of_others):
            return max(observed[0] - of_others[0], 0.0) / max(own[0], NO_EFFECT)

        def excess(correlation):
            own, of_others = self.expected(correlation, others)
            return variance(own, of_others) * own[1] + of_others[1] - observed[1]

        # rows that alternate are no reason for narrow intervals: 0 at least
        low, high = 0.0, MAX_CORRELATION
        if excess(0) < 0:
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                low, high = (middle, high) if excess(middle) < 0 else (low, middle)
        independent = (1 - low) / (1 + low)  # rows that tell as much, per row
        self.noise = Noise(math.sqrt(variance(*self.expected(low, others))), low,
                           max(len(self.residuals) * independent - self.leverage, 1.0))


def _find_noise(curves, num_parameters):
    degrees = sum(len(curve.residuals) for curve in curves) - num_parameters
    deviation = math.sqrt(sum(curve.residuals @ curve.residuals for curve in curves) / degrees)
    for curve in curves:
        curve.noise = Noise(deviation, 0.0, degrees)
    if any(len(curve.residuals) - curve.leverage < FEW_ROWS for curve in curves):
        return  # all have the same noise then
    for _ in range(SWEEPS if len(curves) > 1 else 1):
        for curve in curves:
            others = np.zeros((curve.Q.shape[1], curve.Q.shape[1]))
            for other in curves:
                if other is not curve:
                    others += other.noise.deviation**2 * other.spread(other.noise.correlation)
            curve.find_noise(others)


def _half_width(variances, curves):
    """Of an interval whose variance is a sum of estimates with degrees of freedom of their own (Satterthwaite)."""
    total = sum(variances)
    squares = sum(variance**2 / curve.noise.degrees for variance, curve in zip(variances, curves))
    return student_quantile(LEVEL, max(total**2 / squares, 1.0)) * math.sqrt(total) if total > 0 and squares > 0 else 0.0


def confidence_of(slopes, residuals, num_rows, estimated, too_wide):
    """Of a least-squares fit, linear in the parameters; curves are independent of one another.

    slopes (rows, parameters), residuals (rows,): at the solution, the curves one after another, with `num_rows` rows each.
    estimated: parameters that the fit has chosen freely; the others are taken to be known. A direction is undetermined where
    its half-width exceeds `too_wide`."""
    size = slopes.shape[1]
    found = Confidence([Noise() for _ in num_rows], [math.inf] * size, np.zeros((size, size)), [], False)
    J = slopes[:, estimated]
    rank, U, s, Vt = 0, None, None, np.zeros((0, 0))
    if estimated:
        U, s, Vt = np.linalg.svd(J, full_matrices=len(J) < len(estimated))  # all directions, also of few rows
        rank = int(np.sum(s > NO_EFFECT * max(s[0], 1)))
    found.has_noise = len(residuals) > rank

    def name(direction):
        step = [0.0] * size
        for place, part in zip(estimated, direction):
            step[place] = float(part)
        found.undetermined.append(step)

    for direction in Vt[rank:]:
        name(direction)
    if not found.has_noise:
        return found
    cuts = np.cumsum(num_rows)[:-1]
    bases = np.split(U[:, :rank] if rank else np.zeros((len(residuals), 1)), cuts)
    curves = [_Curve(part, Q) for part, Q in zip(np.split(residuals, cuts), bases)]
    _find_noise(curves, rank)
    found.noise = [curve.noise for curve in curves]
    if rank == 0:
        return found

    # covariance = V S^-1 (sum of deviation^2 Q^T Omega Q) S^-1 V^T, curve by curve
    scale = np.diag(1 / s[:rank])
    parts = [curve.noise.deviation**2 * scale @ curve.spread(curve.noise.correlation) @ scale for curve in curves]

    def half_width_along(along):
        return _half_width([float(along @ part @ along) for part in parts], curves)

    for k in range(rank):
        if half_width_along(np.eye(rank)[k]) > too_wide:
            name(Vt[k])
    V = Vt[:rank].T
    covariance = V @ sum(parts) @ V.T
    for p, place in enumerate(estimated):
        if np.linalg.norm(Vt[rank:, p]) > TAKES_PART:
            continue
        found.half_width[place] = half_width_along(V[p])
        for q, other in enumerate(estimated):
            product = covariance[p, p] * covariance[q, q]
            if product > 0:
                found.correlation[place, other] = covariance[p, q] / math.sqrt(product)
    return found


def leeways(slopes, distance):
    """How far each parameter can move before the residuals move by `distance` (root mean square): alone, and with the others
    adjusted as well as possible; inf where it does not matter."""
    reach = distance * math.sqrt(len(slopes))
    lengths = np.linalg.norm(slopes, axis=0)

    def leeway(slope):
        length = np.linalg.norm(slope)
        return reach / length if length > NO_SLOPE else math.inf

    found = []
    for p in range(slopes.shape[1]):
        # the direction of a column that is rounding says nothing
        others = slopes[:, [q for q in range(slopes.shape[1]) if q != p and lengths[q] > NO_SLOPE]]
        rest = slopes[:, p]
        if others.shape[1]:
            rest = rest - others @ np.linalg.lstsq(others, rest, rcond=None)[0]
        found.append((leeway(slopes[:, p]), leeway(rest)))
    return found
