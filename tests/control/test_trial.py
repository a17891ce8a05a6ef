import numpy as np

from pipeline.control.trial import trial_path


def test_path_goes_once_back_and_forth_in_equal_steps() -> None:
    path = trial_path(100, 38.0)
    assert path.shape == (100,)
    np.testing.assert_allclose(np.abs(np.diff(path, prepend=0.0)), 4 * 38.0 / 100)
    assert (path.max(), path.min()) == (38.0, -38.0)
    assert (path[24], path[74]) == (38.0, -38.0)
    assert abs(path[-1]) < 1e-12
