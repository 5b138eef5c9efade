"""What newer versions of Python have in `typing`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing_extensions import Unpack, dataclass_transform
elif sys.version_info >= (3, 11):
    from typing import Unpack, dataclass_transform
else:
    Unpack = Any

    def dataclass_transform(**_):
        return lambda cls: cls

__all__ = ["Unpack", "dataclass_transform"]
