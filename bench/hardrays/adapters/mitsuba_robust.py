"""Mitsuba 3 with its flag for robust intersections."""

from functools import partial

from adapters import mitsuba

PACKAGE, LIMITS = mitsuba.PACKAGE, mitsuba.LIMITS
make = partial(mitsuba.make, embree_use_robust_intersections=True)
closest_hit, occluded = mitsuba.closest_hit, mitsuba.occluded
