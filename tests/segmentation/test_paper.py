"""The methods of [B], each against a slow plain twin, and its figures."""

from dataclasses import replace

import numpy as np
import pytest

from roundelay.base.errors import RoundelayWarning
from roundelay.reproduction.matrices import mahalanobis_matrix, projection_error_matrix
from roundelay.segmentation import (
    GMMOptions,
    OnlinePCA,
    OnlinePPCA,
    PCAOptions,
    PPCAOptions,
)
from roundelay.segmentation.gmm import fit_mixture, gmm_labels, merge_short
from roundelay.segmentation.pca import intrinsic_dimension
from roundelay.segmentation.ppca import PPCAModel, ppca_cuts


def poses(capture):
    return capture.motion.rotations[:, 1:].reshape(len(capture.motion), -1)


def naive_pca(x, k=240, lag=60, first=300, energy=0.9, deviations=3.0, two_sided=False):
    """[B] 3.1 word for word: one SVD a frame."""
    cuts, start = [], 0
    while True:
        errors, derivatives, rank, cut = {}, [], 0, None
        part = x[start:]
        for i in range(k - lag, len(part) + 1):
            centred = part[:i] - part[:i].mean(axis=0)
            errors[i] = np.linalg.svd(centred, compute_uv=False) ** 2
            if i == k:
                rank = intrinsic_dimension(errors[i], energy)
            if i < k:
                continue
            d = errors[i][rank:].sum() - errors[i - lag][rank:].sum()
            if i > first:
                away = d - np.mean(derivatives)
                away = abs(away) if two_sided else away
                if away > deviations * np.std(derivatives):
                    cut = i - 1
                    break
            derivatives.append(d)
        if cut is None:
            return cuts
        start += cut
        cuts.append(start)


@pytest.mark.parametrize("options", [PCAOptions(), PCAOptions.paper()])
def test_pca_is_the_papers(capture, options):
    x = poses(capture)[:1500, :12]
    online = OnlinePCA(120.0, options)
    online.push(x)
    assert online.cuts == naive_pca(x, two_sided=options.two_sided)
    assert len(online.cuts) >= 1


def test_two_sided_cuts_where_growth_falls_too():
    """Something lively, then rest: the error stops to grow."""
    x = np.random.default_rng(0).normal(0.0, 1.0, (900, 5))
    x[600:] *= 0.01
    found = {}
    for two_sided in (False, True):
        online = OnlinePCA(120.0, PCAOptions(energy=0.1, deviations=4.0, two_sided=two_sided))
        online.push(x)
        found[two_sided] = online.cuts
    assert found[False] == []
    assert len(found[True]) > 0
    assert abs(found[True][0] - 600) < 60


def test_pca_frame_by_frame_is_the_same(capture):
    x = poses(capture)[:1800]
    whole, single = OnlinePCA(120.0), OnlinePCA(120.0)
    whole.push(x)
    told = [cut for frame in x for cut in single.push(frame)]
    assert told == whole.cuts == single.cuts
    assert whole.growth == single.growth


def test_pca_skips_coordinates_that_depend_on_others(capture):
    x = poses(capture)[:1200, :10]
    doubled = np.hstack([x, x[:, :3] * 2.0, np.ones((len(x), 2))])
    plain, wide = OnlinePCA(120.0), OnlinePCA(120.0)
    plain.push(np.hstack([x, x[:, :3] * 2.0]))
    wide.push(doubled)
    assert plain.cuts == wide.cuts
    assert len(wide._basis) <= 12


def test_energy_rule():
    assert intrinsic_dimension(np.array([8.0, 1.0, 0.6, 0.4]), 0.9) == 3
    assert intrinsic_dimension(np.array([9.1, 0.9]), 0.9) == 1
    assert intrinsic_dimension(np.zeros(3), 0.9) == 1


def test_ppca_covariance_is_eq_9():
    x = np.random.default_rng(0).normal(size=(200, 6)) * [9, 5, 3, 1, 1, 1]
    model = PPCAModel.of(len(x), x.sum(axis=0), x.T @ x, 0.9)
    _, singular, v = np.linalg.svd(x - x.mean(axis=0))
    squares = singular**2
    r = intrinsic_dimension(squares, 0.9)
    squares[r:] = squares[r:].mean()
    expected = v.T @ np.diag(squares) @ v / (len(x) - 1)
    np.testing.assert_allclose(model.axes * model.variances @ model.axes.T, expected, atol=1e-10)
    other = np.random.default_rng(1).normal(2.0, 3.0, (50, 6))
    gap = other - x.mean(axis=0)
    squared = np.einsum("ni,ij,nj->n", gap, np.linalg.inv(expected), gap)
    distance = model.distance(len(other), other.sum(axis=0), other.T @ other)
    assert distance == pytest.approx(np.sqrt(squared.mean()), rel=1e-9)


def test_ppca_online_forward_frame_by_frame(capture):
    x = poses(capture)
    whole, single = OnlinePPCA(120.0), OnlinePPCA(120.0)
    whole.push(x)
    told = [cut for frame in x for cut in single.push(frame)]
    assert told == whole.cuts
    assert single.curve == whole.curve


def test_ppca_backward_pass_adds_what_forward_misses(capture):
    x = poses(capture)
    forward = OnlinePPCA(120.0, PPCAOptions.paper())
    forward.push(x)
    for converge in (False, True):
        options = replace(PPCAOptions.paper(), converge=converge)
        both, strengths, curve = ppca_cuts(x, 120.0, options)
        assert curve == forward.curve
        assert set(forward.cuts) <= set(both)
        assert len(both) == len(strengths)
        assert min(strengths) >= 1.0


def naive_passes(x, options):
    """[B] 3.2: forward and backward in turn, new cuts added, until two passes bring none."""
    cuts, rest, backward = [], 2, False
    while rest:
        new = []
        for a, b in zip([0, *cuts], [*cuts, len(x)], strict=True):
            online = OnlinePPCA(120.0, options)
            online.push(x[a:b][::-1] if backward else x[a:b])
            new += [b - cut if backward else a + cut for cut in online.cuts]
        rest = 2 if new else rest - 1
        cuts, backward = sorted(cuts + new), not backward
    return cuts


def test_passes_to_and_fro_end_where_none_is_new(capture):
    x, options = poses(capture), PPCAOptions(converge=True, threshold=1.5)
    found = ppca_cuts(x, 120.0, options)[0]
    assert found == naive_passes(x, options)
    assert min(np.diff([0, *found, len(x)])) >= options.frames(120.0)[0]


def test_a_narrow_behaviour_inside_a_wide_one_is_found_by_the_backward_pass():
    rng = np.random.default_rng(1)
    x = np.concatenate([rng.normal(0.0, 1.0, (900, 6)), rng.normal(0.0, 0.02, (900, 6))])
    options = PPCAOptions.paper()
    forward = OnlinePPCA(120.0, options)
    forward.push(x)
    assert forward.cuts == []
    with pytest.warns(RoundelayWarning, match="hardly fits 6 coordinates"):
        found = ppca_cuts(x, 120.0, options)[0]
    assert len(found) >= 1
    assert min(abs(cut - 900) for cut in found) <= 160


def test_eq_10_as_printed_is_the_square(capture):
    x = poses(capture)[:1500]
    root, square = OnlinePPCA(120.0), OnlinePPCA(120.0, PPCAOptions(squared=True, threshold=9.0))
    root.push(x)
    square.push(x)
    shared = min(len(root.curve), len(square.curve), 40)
    (_, h), (_, h2) = (np.array(one.curve[:shared]).T for one in (root, square))
    np.testing.assert_allclose(h2, h**2, rtol=1e-12)
    # Literally: eq. 9's covariance of the first 150 frames, averaged over the next 150.
    gap = x[150:300] - x[:150].mean(axis=0)
    _, s, v = np.linalg.svd(x[:150] - x[:150].mean(axis=0))
    squares = np.append(s**2, np.zeros(x.shape[1] - len(s)))
    rank = intrinsic_dimension(squares, 0.95)
    squares[rank:] = squares[rank:].mean()
    inverse = v.T @ np.diag(149.0 / squares) @ v
    literal = np.mean([row @ inverse @ row for row in gap])
    assert h2[0] == pytest.approx(literal, rel=1e-6)


@pytest.mark.parametrize(
    ("options", "dimension", "fits"),
    [
        (PPCAOptions.paper(), 56, True),
        (PPCAOptions.paper(), 4, False),
        (PPCAOptions.paper(), 300, False),
        (replace(PPCAOptions.paper(), squared=True), 56, False),
        (replace(PPCAOptions.paper(), squared=True, threshold=112.0), 56, True),
        (PPCAOptions(), 4, True),
    ],
)
def test_a_threshold_that_does_not_fit_the_dimension_is_told(options, dimension, fits):
    if fits:
        options.check_threshold(dimension)
        return
    with pytest.warns(RoundelayWarning, match=f"hardly fits {dimension} coordinates"):
        options.check_threshold(dimension)


def test_papers_windows_at_120_frames_a_second():
    assert PPCAOptions.paper().frames(120.0) == (150, 10)
    assert PPCAOptions().frames(30.0) == (38, 2)
    online = OnlinePCA(120.0)
    assert (online._window, online._lag, online._start) == (240, 60, 300)


def test_figure_6_diagonal_is_the_root_of_the_dimension():
    clouds = [np.random.default_rng(s).normal(size=(240, 56)) for s in range(3)]
    matrix = mahalanobis_matrix(clouds)
    np.testing.assert_allclose(np.diagonal(matrix), np.sqrt(56 * 239 / 240), rtol=0.02)
    np.testing.assert_array_equal(matrix, matrix.T)
    assert (matrix >= np.diagonal(matrix)[:, None] - 0.2).all()


def test_figure_5_is_smallest_on_the_diagonal(capture):
    x, bounds = poses(capture), [s[0] for s in capture.truth.segments]
    parts = [x[start + 120 : start + 360] for start in bounds]
    errors = projection_error_matrix(parts)
    np.testing.assert_allclose(errors.min(axis=1), np.diagonal(errors), rtol=1e-6)
    # Plan "abacdb": joining the two a, or the two b, costs no more than each with itself.
    alike = np.isclose(errors, np.diagonal(errors)[:, None], rtol=0.1)
    assert [tuple(row) for row in np.argwhere(np.triu(alike, 1))] == [(0, 2), (1, 5)]


def test_mixture_agrees_with_scikit_learn():
    sklearn = pytest.importorskip("sklearn.mixture")
    rng = np.random.default_rng(0)
    x = np.concatenate([rng.normal(m, 1.0, (400, 2)) for m in (0.0, 6.0, 12.0)])
    ours = fit_mixture(x, GMMOptions(clusters=3, starts=5), rng)
    theirs = sklearn.GaussianMixture(3, n_init=5, random_state=0, tol=1e-6).fit(x)
    assert ours.likelihood == pytest.approx(theirs.score(x), abs=1e-3)
    np.testing.assert_allclose(np.sort(ours.means[:, 0]), np.sort(theirs.means_[:, 0]), atol=0.02)


@pytest.mark.parametrize("guess", ["parts", "frames"])
def test_the_number_of_clusters_by_the_information_criterion(guess):
    rng = np.random.default_rng(0)
    x = np.concatenate([rng.normal(m, 1.0, (300, 2)) for m in (0.0, 8.0, 16.0)])
    options = GMMOptions(most=5, starts=4, guess=guess)
    mixture = fit_mixture(x, options, rng)
    assert len(mixture.weights) == 3
    # p log n - 2 log L: two weights, three means and three symmetric covariances in the plane.
    literal = (2 + 3 * 2 + 3 * 3) * np.log(900) - 2 * 900 * mixture.likelihood
    assert mixture.criterion(900) == pytest.approx(literal)


def test_mixture_labels_separate_clouds():
    rng = np.random.default_rng(0)
    x = np.concatenate([rng.normal(m, 1.0, (300, 3)) for m in (0.0, 9.0, 0.0)])
    labels, certainty = gmm_labels(x, 120.0, GMMOptions(clusters=2), rng)
    assert np.flatnonzero(np.diff(labels)).tolist() == [299, 599]
    assert labels[0] == labels[-1]
    assert certainty.min() > 0.5


def test_short_runs_go_to_both_neighbours_shortest_first():
    labels = np.repeat([0, 1, 2, 3, 0], [20, 4, 20, 6, 20])
    merged = merge_short(labels, 10)
    np.testing.assert_array_equal(merged, np.repeat([0, 2, 0], [22, 25, 23]))


def test_short_runs_at_the_ends_go_to_their_neighbour():
    np.testing.assert_array_equal(merge_short(np.repeat([1, 0, 2], [3, 20, 4]), 10), np.zeros(27))
    np.testing.assert_array_equal(merge_short(np.zeros(5, dtype=int), 10), np.zeros(5))


@pytest.mark.parametrize(
    ("kind", "arguments"),
    [
        (PCAOptions, {"energy": 1.0}),
        (PCAOptions, {"lag": 3.0}),
        (PCAOptions, {"deviations": 0.0}),
        (PPCAOptions, {"rule": "product"}),
        (PPCAOptions, {"energy": 0.0}),
        (PPCAOptions, {"step": 2.0}),
        (PPCAOptions, {"threshold": 0.0}),
        (GMMOptions, {"clusters": 0}),
        (GMMOptions, {"guess": "best"}),
        (GMMOptions, {"most": 0}),
        (GMMOptions, {"energy": 2.0}),
        (GMMOptions, {"shortest": -1.0}),
    ],
)
def test_options_out_of_range(kind, arguments):
    with pytest.raises(ValueError, match="expected"):
        kind(**arguments)


@pytest.mark.parametrize("options", [PPCAOptions(), PPCAOptions.paper()])
def test_online_ppca_forgets_what_cannot_be_cut_any_more(capture, options):
    """The same cuts as with all blocks kept; of one behaviour without end it keeps a few."""
    values = capture.motion.rotations[:, 1:].reshape(len(capture.motion), -1)
    online, hoarding = OnlinePPCA(120.0, options), Hoarding(120.0, options)
    online.push(values)
    hoarding.push(values)
    assert online.cuts == hoarding.cuts
    assert online.curve == hoarding.curve
    assert len(online.cuts) > 2
    time = np.arange(6 * 7200)[:, None] / 120.0
    walk = np.sin(2 * np.pi * time / 1.1 + np.arange(6.0))
    walk += np.random.default_rng(0).normal(0.0, 0.01, walk.shape)
    online = OnlinePPCA(120.0, options)
    kept = []
    for minute in range(6):
        online.push(walk[7200 * minute : 7200 * (minute + 1)])
        kept.append(len(online._blocks))
    assert online.cuts == []
    assert max(kept) == min(kept) < 2 * online.window


class Hoarding(OnlinePPCA):
    """Keeps every block since the last cut."""

    def _forget(self, blocks):
        if blocks == self._peak_blocks and self._kept_cuts != len(self.cuts):
            self._kept_cuts = len(self.cuts)
            super()._forget(blocks)

    _kept_cuts = 0
