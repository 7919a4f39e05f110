# SPDX-License-Identifier: LGPL-2.1-or-later
"""Intervals of fits, on curves that are linear in two parameters with noise that is drawn."""
import math

import numpy as np
import pytest

from hexaplast_study.confidence import confidence_of, student_quantile


def coverage_of(deviations, correlations, num_rows=60, num_fits=600):
    """Shares of fits that cover the truth, half-widths over scatter, and means of deviation and correlation of the first curve."""
    draw = np.random.default_rng(7)
    t = np.arange(num_rows) / num_rows
    weights = [0.03 / deviation for deviation in deviations]  # as a fit gives them: the inverse of the noise
    J = np.vstack([w * np.column_stack([1 + t, np.exp(-3 * t) - 0.3 * c]) for c, w in enumerate(weights)])
    rows = [num_rows] * len(deviations)
    errors, half_widths, noises = [], [], []
    for _ in range(num_fits):
        noise = []
        for w, deviation, correlation in zip(weights, deviations, correlations):
            value = draw.normal()
            for _ in range(num_rows):
                noise.append(w * deviation * value)
                value = correlation * value + math.sqrt(1 - correlation**2) * draw.normal()
        error = np.linalg.lstsq(J, noise, rcond=None)[0]
        found = confidence_of(J, J @ error - noise, rows, [0, 1], math.inf)
        errors.append(error)
        half_widths.append(found.half_width)
        noises.append((found.noise[0].deviation, found.noise[0].correlation))
    errors, half_widths = np.array(errors), np.array(half_widths)
    scatter = np.sqrt(np.mean(errors**2, axis=0))
    return np.mean(np.abs(errors) <= half_widths, axis=0), half_widths.mean(axis=0) / scatter, np.mean(noises, axis=0)


@pytest.mark.parametrize("level, degrees, value", [(0.95, 1, 12.706), (0.95, 2, 4.303), (0.95, 10, 2.228), (0.9, 30, 1.697),
                                                   (0.99, 120, 2.617), (0.95, 1e6, 1.960)])
def test_students_quantiles_are_those_of_the_tables(level, degrees, value):
    assert abs(student_quantile(level, degrees) - value) < 1e-3


def test_intervals_cover_the_truth_in_nineteen_of_twenty_fits():
    covered, ratio, (deviation, _) = coverage_of([0.03], [0])
    assert (covered > 0.935).all() and (covered < 0.98).all()  # a correlation that chance shows widens some
    assert (abs(ratio - 2) < 0.3).all() and abs(deviation - 0.03) < 0.001


def test_noise_that_correlates_from_row_to_row_widens_them():
    covered, _, (deviation, correlation) = coverage_of([0.03], [0.7])
    assert (covered > 0.9).all() and (covered < 0.98).all()
    assert abs(correlation - 0.7) < 0.1 and abs(deviation - 0.03) < 0.003


def test_each_curve_has_its_own_noise():
    covered, _, (deviation, _) = coverage_of([0.01, 0.2], [0, 0.5], num_fits=500)
    assert (covered > 0.9).all() and (covered < 0.98).all()
    assert abs(deviation - 0.03) < 0.002


def test_few_rows_have_wide_intervals():
    covered, _, _ = coverage_of([0.03], [0], num_rows=4)
    assert (covered > 0.93).all() and (covered < 0.97).all()


def test_what_curves_do_not_determine_is_named():
    J = np.array([[row, 2 * row, 1] for row in range(6)], float)
    r = np.array([0.1, -0.2, 0.15, -0.15, 0.2, -0.1])
    found = confidence_of(J, r, [6], [0, 1, 2], 10)
    assert [math.isinf(width) for width in found.half_width] == [True, True, False]
    (step,) = found.undetermined
    assert abs(step[0] / step[1] + 2) < 1e-9 and abs(step[2]) < 1e-9

    # the second one known, the first is
    known = confidence_of(J, r, [6], [0, 2], 10)
    assert math.isfinite(known.half_width[0]) and not known.undetermined
    # lines through six points: what every table of linear regression says
    assert known.noise[0].correlation == 0  # they alternate
    assert abs(known.half_width[0] - student_quantile(0.95, 4) * math.sqrt(r @ r / 4 / 17.5)) < 1e-6
    # rows for a line and no more tell nothing of the noise
    assert not confidence_of(J[:2], r[:2], [2], [0, 2], 10).has_noise
