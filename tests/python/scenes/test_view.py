"""The live view, served by a thread of this process."""

import gc
import json
import re
import subprocess
import sys
import time
import urllib.error
import urllib.request

import pytest

import claray
from test_bad_input import refused


def get(url, **headers):
    """Status, body and headers."""
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers)) as answer:
            return answer.status, answer.read(), answer.headers
    except urllib.error.HTTPError as error:
        return error.code, error.read(), error.headers


def state_of(view):
    return json.loads(get(view.url + "frame")[2]["View-State"])


@pytest.fixture(scope="module")
def cornell():
    with claray.view(claray.load("cornell"), spp=4, height=321) as view:
        yield view


def test_a_notebook_shows_the_page_in_a_frame(cornell):
    shown = re.fullmatch(r'<iframe src="(\S+)" title="claray view" width="100%" height="321" .*></iframe>', cornell._repr_html_())
    assert shown is not None and shown[1] == cornell.url
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", cornell.url)
    frame = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "iframe"}
    status, page, headers = get(cornell.url, **frame)
    assert status == 200 and b"<title>claray view</title>" in page
    assert "X-Frame-Options" not in headers and "frame-ancestors" not in headers["Content-Security-Policy"]
    for name in re.findall(rb'(?:src|href)="([^"]+)"', page):
        assert get(cornell.url + name.decode())[0] == 200, name


def test_requests_without_the_token_are_refused(cornell):
    start = cornell.url.rsplit("/", 2)[0]
    assert get(start + "/")[0] == get(start + "/picture.png")[0] == get(start + "/" + "0" * 32 + "/")[0] == 401


def test_the_page_shows_the_scene_and_changes_its_copy():
    scene = claray.load("cornell")
    before = tuple(scene.materials[0].albedo)
    with claray.view(scene, spp=4) as view:
        described = json.loads(get(view.url + "scene")[1])
        assert [m["name"] for m in described["materials"]] == [m.name for m in scene.materials] and described["spp"] == 4
        for line in ("edit 0", "material albedo 0.25 0.5 0.75"):
            urllib.request.urlopen(view.url + "command", line.encode())
        while json.loads(get(view.url + "scene")[1])["materials"][0]["values"]["albedo"] != [0.25, 0.5, 0.75]:
            time.sleep(0.01)
        while not state_of(view)["complete"]:
            time.sleep(0.01)
        assert get(view.url + "picture.png")[1].startswith(b"\x89PNG")
    assert tuple(scene.materials[0].albedo) == before


def test_it_renders_beside_other_work_of_the_device():
    scene = claray.load("cornell")
    with claray.view(scene, spp=64) as view:
        image = claray.render(scene, width=32, height=32, spp=4)
        assert view.is_open and state_of(view)["spp"] > 0
    assert (image == claray.render(scene, width=32, height=32, spp=4)).all()


def test_a_closed_view_is_gone():
    view = claray.view(claray.load("cornell"), spp=1)
    url = view.url
    assert view.is_open and get(url + "status")[0] == 200
    view.close()
    view.close()
    assert not view.is_open and view.url == url and repr(view) == "<claray.View: closed>"
    assert view._repr_html_() == "<p>The view is closed.</p>"
    with pytest.raises(OSError):
        urllib.request.urlopen(url)
    dropped = claray.view(claray.load("cornell"), spp=1)
    url = dropped.url
    del dropped
    gc.collect()
    with pytest.raises(OSError):
        urllib.request.urlopen(url)


def test_the_page_can_end_it():
    view = claray.view(claray.load("cornell"), spp=1)
    urllib.request.urlopen(view.url + "command", b"quit")
    while view.is_open:
        time.sleep(0.01)
    view.close()


def test_a_process_ends_with_an_open_view():
    done = subprocess.run([sys.executable, "-c", "import claray; view = claray.view(claray.load('cornell')); print(view.url)"],
                          capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("http://127.0.0.1:"), done.stderr


def test_bad_arguments_are_refused(cornell):
    scene = claray.load("cornell")
    refused("scene", lambda: claray.view("cornell"), "claray.Scene")
    refused("spp", lambda: claray.view(scene, spp=0), "1 to 16777216")
    refused("exposure", lambda: claray.view(scene, exposure=float("nan")), "stops")
    refused("height", lambda: claray.view(scene, height=0), "integer")
    refused("port", lambda: claray.view(scene, port=70000), "65535")
    refused("host", lambda: claray.view(scene, host=1), "text")
    port = int(cornell.url.split(":")[2].split("/")[0])
    with pytest.raises(claray.InputError, match=f"cannot listen at 127.0.0.1:{port}; the port may be in use"):
        claray.view(scene, port=port)


def test_a_dropped_file_is_shown_and_no_job_is_saved():
    with claray.view(claray.load("cornell"), spp=1) as view:
        assert get(view.url + "job.json")[0] == 404 and not json.loads(get(view.url + "scene")[1])["has_job"]
        triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        for path, body in (("drop", b""), ("upload?name=a.obj&at=0", triangle), ("open?name=a.obj", b"")):
            urllib.request.urlopen(view.url + path, body)
        while json.loads(get(view.url + "scene")[1])["triangles"] != 1:
            time.sleep(0.01)
