"""The live view of a scene: a page in a cell of a notebook, or in a browser."""

from __future__ import annotations

import atexit
import contextlib
import html
import weakref
from typing import Any

from . import _native
from ._arrays import integer, number, text
from ._device import AnyDevice, device_of
from ._handle import Handle
from ._render import native_scene
from ._scene import Scene
from .errors import Error, UsageError


class View(Handle):
    """A page that shows a scene while it is sampled, and changes it; view() makes one. Notebooks show it in their cell.

    It is open until close(), until the page ends it, or until the object is gone. `with claray.view(scene) as view:` closes it at
    the end of the block.
    """

    __slots__ = ("_height", "_native")
    _native: Any
    _instead_of_pickling = "make it in each process"

    def __init__(self, native: Any, height: int) -> None:
        self._native, self._height = native, height

    @property
    def url(self) -> str:
        """The address of the page for a browser. It has the token without which requests are refused."""
        return str(self._native.url())

    @property
    def is_open(self) -> bool:
        return bool(self._native.is_open())

    def close(self) -> None:
        """Ends the view. Closing it again has no effect. Raises DeviceError if the device has ended it before."""
        self._native.close()

    def __enter__(self) -> View:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<claray.View: {self.url if self.is_open else 'closed'}>"

    def _repr_html_(self) -> str:
        if not self.is_open:
            return "<p>The view is closed.</p>"
        return (f'<iframe src="{html.escape(self.url)}" title="claray view" width="100%" height="{self._height}" style="border: 0" '
                'allow="clipboard-write"></iframe>')


_views: weakref.WeakSet[View] = weakref.WeakSet()


def view(scene: Scene, *, spp: int = 256, exposure: float = 0.0, height: int = 560, host: str = "127.0.0.1", port: int = 0,
         device: AnyDevice = None) -> View:
    """Shows a scene live: a notebook shows the page in the cell, elsewhere open the `url` of the result in a browser.

    The page is that of the program's `claray view` (docs/view.md), served by a thread of this process. It has a copy of the scene: what
    the page changes does not change `scene`. spp: samples per pixel at which a still view stops. exposure: in stops. height: of the cell,
    in pixels of the page. host: the address to listen at; "0.0.0.0" serves the page to all computers that reach this one. port: 0: any
    that is free. device: as of Bvh. Raises UsageError; InputError for an invalid scene, a port in use, or a claray without its server;
    DeviceError.
    """
    native = native_scene(scene)
    scene._warn_of_added_light()
    scene._warn_of_lamps()
    stops = number("exposure", exposure)
    if not -64 <= stops <= 64:
        raise UsageError(f"exposure: is {exposure!r}; use -64 to 64 stops")
    made = View(_native.NativeView.serve(device_of(device)._native, native, integer("spp", spp, 1, 2**24),
                                         stops, text("host", host), integer("port", port, 0, 2**16 - 1)),
                integer("height", height, 1, 2**14))
    _views.add(made)
    return made


@atexit.register
def _close() -> None:
    """Before drivers end."""
    if not _native.is_forked():
        for one in list(_views):
            with contextlib.suppress(Error):
                one.close()
