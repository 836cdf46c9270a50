import pathlib

import pytest
import stillkite

FLIGHT = pathlib.Path(__file__).parent / "flight.yaml"


class RenderedFlight:
    """Images and readings of the flight in flight.yaml."""

    def __init__(self):
        self.flight = stillkite.SimulatedFlight(FLIGHT)
        self.stamps_ns = self.flight.stamps_ns
        self.images = [self.flight.image(i) for i in range(len(self.flight))]
        log = self.flight.sensors()
        before = [self.stamps_ns[0], *self.stamps_ns[:-1]]
        self.readings = [log.between(b, now) for b, now in zip(before, self.stamps_ns)]

    def navigator(self, policy="flow", **options):
        return stillkite.Navigator(
            self.flight.camera, self.flight.body_from_camera, self.flight.initial,
            {"estimator": {"policy": policy}}, **options)

    def estimates(self, policy="flow"):
        navigator = self.navigator(policy)
        return [navigator.step(*inputs)
                for inputs in zip(self.images, self.stamps_ns, self.readings)]


@pytest.fixture(scope="session")
def rendered():
    return RenderedFlight()
