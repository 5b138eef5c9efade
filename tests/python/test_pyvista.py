"""claray.pyvista against closed forms, and against PyVista's own rays."""

import copy

import numpy as np
import pytest

pyvista = pytest.importorskip("pyvista")
pytest.importorskip("trimesh")

import claray  # noqa: E402
import claray.pyvista as own  # noqa: E402


def rays_from_within(count):
    directions = np.random.default_rng(1).normal(size=(count, 3))
    return np.zeros((count, 3)), directions


def test_results_are_those_of_pyvista():
    pytest.importorskip("embreex")  # which PyVista's own function needs
    mesh, (origins, directions) = pyvista.Sphere(), rays_from_within(300)
    origins[150:] = -3 * directions[150:]
    for first_point in (True, False):
        for retry in (True, False):
            theirs = mesh.multi_ray_trace(origins, directions, first_point=first_point, retry=retry)
            ours = mesh.claray.multi_ray_trace(origins, directions, first_point=first_point, retry=retry)
            assert [(a.shape, a.dtype) for a in ours] == [(a.shape, a.dtype) for a in theirs]
            keys = [np.lexsort((np.einsum("ij,ij->i", a[0] - origins[a[1]], directions[a[1]]), a[1])) for a in (theirs, ours)]
            np.testing.assert_allclose(ours[0][keys[1]], theirs[0][keys[0]], atol=1e-12)
            assert (ours[1][keys[1]] == theirs[1][keys[0]]).all() and (ours[2][keys[1]] == theirs[2][keys[0]]).all()
            assert not retry or (np.diff(ours[1]) >= 0).all()


def test_segments_are_those_of_pyvista():
    mesh = pyvista.Sphere()
    for begin, end in (((-2, 0.01, 0.02), (2, 0, 0.01)), ((0, 0, 0), (0.1, 0.7, 0.2)), ((0, 0, 0), (0.1, 0.1, 0.1)), ((2, 0, 0), (-2, 0.2, 0.1))):
        points, cells = mesh.claray.ray_trace(begin, end)
        theirs, their_cells = mesh.ray_trace(begin, end)
        order = np.argsort(np.linalg.norm(theirs - begin, axis=1))  # PyVista's order is not that of the segment
        np.testing.assert_allclose(points, theirs[order], atol=1e-6)
        assert cells.tolist() == their_cells[order].tolist()
        first, _ = mesh.claray.ray_trace(begin, end, first_point=True)
        assert first.shape == ((3,) if len(points) else (0, 3)) and (not len(points) or (first == points[0]).all())
    assert len(pyvista.Cube().claray.ray_trace([0.1, 0.2, 2], [0.1, 0.2, 0.5])[1]) == 1  # which ends on the surface


def test_cells_of_polygons_strips_and_lines():
    cube = pyvista.Cube()
    points, cells = cube.claray.ray_trace([0.1, 0.2, 5], [0.1, 0.2, -5])
    assert points[:, 2].tolist() == [0.5, -0.5] and cells.tolist() == [5, 4]
    sphere = pyvista.Sphere()
    strips = sphere.strip()
    origins, directions = rays_from_within(100)
    expected = sphere.claray.multi_ray_trace(origins, directions, retry=True)
    found = strips.claray.multi_ray_trace(origins, directions, retry=True)
    np.testing.assert_allclose(found[0], expected[0], atol=1e-6)
    for i in (0, 50, 99):
        assert found[2][i] == strips.ray_trace(origins[i], directions[i] * 9)[1][0]
    with_line = pyvista.PolyData([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], lines=[2, 0, 1, 2, 1, 2], faces=[4, 0, 1, 2, 3])
    assert with_line.n_cells == 3
    for place in ([0.7, 0.2], [0.2, 0.7]):
        assert with_line.claray.ray_trace([*place, 1], [*place, -1])[1].tolist() == [2]


def test_changes_empty_meshes_and_vertices_that_are_no_numbers():
    cube = pyvista.Cube()
    heights = [cube.claray.ray_trace([0.1, 0.2, 9], [0.1, 0.2, -9])[0][0, 2]]
    cube.points[:, 2] += 1
    heights.append(own.ray_trace(cube, [0.1, 0.2, 9], [0.1, 0.2, -9])[0][0, 2])
    cube.translate([0, 0, 1], inplace=True)
    heights += [mesh.claray.ray_trace([0.1, 0.2, 9], [0.1, 0.2, -9])[0][0, 2] for mesh in (cube, copy.deepcopy(cube))]
    assert heights == [0.5, 1.5, 2.5, 2.5]
    points, rays, cells = own.multi_ray_trace(pyvista.PolyData(), *rays_from_within(5))
    assert points.shape == (0, 3) and rays.shape == cells.shape == (0,)
    spoiled = pyvista.PolyData([[np.nan, 0, 0], [1.0, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0]], faces=[3, 0, 1, 2, 3, 4, 1, 3])
    assert spoiled.claray.ray_trace([0.2, 0.3, 1], [0.2, 0.3, -1])[1].tolist() == [1]


def test_wrong_arguments_are_named():
    cube = pyvista.Cube()
    for name, call in (("mesh", lambda: own.multi_ray_trace("cube", *rays_from_within(2))),
                       ("origins", lambda: cube.claray.multi_ray_trace([0, 0, 0], [[0, 0, 1]])),
                       ("origins", lambda: cube.claray.multi_ray_trace([[0, np.inf, 0]], [[0, 0, 1]])),
                       ("directions", lambda: cube.claray.multi_ray_trace([[0, 0, 0]], [[0, 0, 1]] * 2)),
                       ("first_point", lambda: cube.claray.multi_ray_trace([[0, 0, 0]], [[0, 0, 1]], first_point="no")),
                       ("retry", lambda: cube.claray.multi_ray_trace([[0, 0, 0]], [[0, 0, 1]], retry=2)),
                       ("end_point", lambda: cube.claray.ray_trace([0, 0, 0], [0, 0])),
                       ("origin", lambda: cube.claray.ray_trace(None, [0, 0, 1]))):
        with pytest.raises(claray.UsageError, match=f"^{name}: "):
            call()


def test_pyvista_finds_the_accessor_by_itself(tmp_path):
    """By the entry point of pyproject.toml, in a process that does not import claray."""
    import os
    import subprocess
    import sys
    from pathlib import Path
    project = (Path(__file__).resolve().parents[2] / "pyproject.toml").read_text()
    section = project.split('[project.entry-points."pyvista.accessors"]\n')[1].split("\n\n")[0]
    installed = tmp_path / "claray-0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: claray\nVersion: 0\n")
    (installed / "entry_points.txt").write_text("[pyvista.accessors]\n" + section.replace('"', "") + "\n")
    code = "import pyvista; print(len(pyvista.Cube().claray.ray_trace([0.1, 0.2, 5], [0.1, 0.2, -5])[1]))"
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})
    assert result.stdout.strip() == "2", result.stderr
