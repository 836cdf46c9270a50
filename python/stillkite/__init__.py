"""Visual motion estimation and position hold from one camera.

Frames: world z up, ground at z = 0; body x forward, y left, z up; camera x right, y down, z forward.
Names carry frame and unit; stamps are integer nanoseconds; quaternions are (w, x, y, z).

    navigator = stillkite.Navigator(camera, body_from_camera, stillkite.InitialState.at_height(20))
    estimate = navigator.step(image, stamp_ns)
    estimate.metric.position_in_world_m
"""

from stillkite import _stillkite
from stillkite._stillkite import *  # noqa: F403
from stillkite._stillkite import __version__  # noqa: F401

__all__ = sorted(name for name in vars(_stillkite) if not name.startswith("_"))
for _name in __all__:
    if isinstance(getattr(_stillkite, _name), type):
        getattr(_stillkite, _name).__module__ = __name__
