# SPDX-License-Identifier: Apache-2.0
"""Position tags for mine tunnels: read, verify, localize.

Pictures are numpy arrays of uint8 and shape (height, width), or paths. Places are metres of the
survey's grid, angles are radians, corners are pixels with (0, 0) in the centre of the upper left one.
"""

from tagsmith import _tagsmith
from tagsmith._tagsmith import __version__

__all__ = sorted(name for name in dir(_tagsmith) if not name.startswith("_"))

for _name in __all__:
    _value = getattr(_tagsmith, _name)
    if isinstance(_value, type):
        _value.__module__ = "tagsmith"  # where people find it
    globals()[_name] = _value
del _name, _value
