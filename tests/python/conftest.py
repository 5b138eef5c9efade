"""What the tests share. The package is that of PYTHONPATH."""

import numpy as np
import pytest

import claray


@pytest.fixture(scope="session")
def soup():
    """Vertices, triangles and a structure of 300 triangles."""
    rng = np.random.default_rng(1)
    corners = rng.uniform(-1, 1, (300, 1, 3)) + rng.uniform(-0.3, 0.3, (300, 3, 3))
    vertices = corners.reshape(-1, 3).astype(np.float32)
    triangles = np.arange(900).reshape(-1, 3)
    return vertices, triangles, claray.Bvh(vertices, triangles)


@pytest.fixture(scope="session")
def rays():
    rng = np.random.default_rng(2)
    return rng.uniform(-2, 2, (777, 3)).astype(np.float32), rng.normal(size=(777, 3)).astype(np.float32)
