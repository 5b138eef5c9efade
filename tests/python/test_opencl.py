"""Contexts, queues, buffers and events of pyopencl."""

import numpy as np
import pytest

import claray

cl = pytest.importorskip("pyopencl")


@pytest.fixture(scope="module")
def adopted():
    name = claray.default_device().name
    device = next(d for p in cl.get_platforms() for d in p.get_devices() if d.name.strip() == name)
    context = cl.Context([device])
    queue = cl.CommandQueue(context)
    return context, queue, claray.Device.adopt(context, queue)


def test_buffers_queues_and_events_are_used(adopted, soup, rays):
    context, queue, device = adopted
    vertices, triangles, own = soup
    expected = claray.closest_hit(own, *rays)
    bvh = claray.Bvh(vertices, triangles, device=device)
    assert device.queue_ptr == queue.int_ptr and device.context_ptr == context.int_ptr
    packed = np.array(claray.rays(*rays))
    flags = cl.mem_flags
    ray_buffer = cl.Buffer(context, flags.READ_WRITE, packed.nbytes)
    hit_buffer = cl.Buffer(context, flags.READ_WRITE, expected.nbytes)
    any_buffer = cl.Buffer(context, flags.READ_WRITE, len(packed))
    query = claray.Query(bvh, coherence="coherent")
    other = device.with_new_queue()
    any_query = claray.Query(bvh, "any", coherence="coherent", queue=other)
    written = cl.enqueue_copy(queue, ray_buffer, packed, is_blocking=False)
    traced = query.run(ray_buffer, hit_buffer, len(packed), wait_for=[written])
    occluded = any_query.run(ray_buffer, any_buffer, len(packed), wait_for=[traced])
    occluded.wait()
    assert traced.done and occluded.done
    hits, any_hits = np.empty(len(packed), claray.HIT), np.empty(len(packed), np.uint8)
    read = cl.enqueue_copy(queue, hits, hit_buffer, wait_for=[cl.Event.from_int_ptr(traced.int_ptr, True)])
    read.wait()
    cl.enqueue_copy(queue, any_hits, any_buffer).wait()
    assert (hits == expected).all()
    assert (any_hits.astype(bool) == (expected["primitive"] != claray.MISS)).all()


def test_wrong_buffers_are_refused_before_anything_runs(adopted, soup):
    context, queue, device = adopted
    vertices, triangles, own = soup
    query = claray.Query(claray.Bvh(vertices, triangles, device=device), coherence="coherent")
    small = cl.Buffer(context, cl.mem_flags.READ_WRITE, 64)
    large = cl.Buffer(context, cl.mem_flags.READ_WRITE, 4096)
    foreign = cl.Buffer(cl.Context(context.devices), cl.mem_flags.READ_WRITE, 4096)
    with pytest.raises(claray.UsageError, match="64 bytes"):
        query.run(small, large, 10)
    with pytest.raises(claray.UsageError, match="64 bytes"):
        query.run(large, small, 10)
    with pytest.raises(claray.UsageError, match="another context"):
        query.run(foreign, large, 10)
    with pytest.raises(claray.UsageError, match="^rays: is a ndarray"):
        query.run(np.zeros(10), large, 10)
    with pytest.raises(claray.UsageError, match="^count: "):
        query.run(large, large, -1)
    with pytest.raises(claray.UsageError, match="different contexts"):
        claray.Query(own, queue=device)
    with pytest.raises(claray.UsageError, match="another context"):
        claray.Device.adopt(cl.Context(context.devices), queue)
