"""Images to estimates to a plot: position error of a rendered flight."""
import matplotlib.pyplot as plt
import stillkite

flight = stillkite.SimulatedFlight("""
camera: {width_px: 640, height_px: 480, focal_x_px: 480, focal_y_px: 480,
         centre_x_px: 319.5, centre_y_px: 239.5}
flight: {duration_s: 4, height_m: 20, forward_m: 12, left_m: 2, climb_m: -1, sway_m: 0.3}""")
navigator = stillkite.Navigator(flight.camera, flight.body_from_camera, flight.initial)
estimates = [navigator.step(flight.image(i), t) for i, t in enumerate(flight.stamps_ns)]
path = stillkite.Trajectory.from_estimates(estimates)
print(f"ATE {1000 * stillkite.evaluate(path, flight.truth).position_rmse_m:.1f} mm")

error_mm = 1000 * (path.positions_m - flight.truth.positions_m)
plt.plot(path.stamps_ns * 1e-9, error_mm, label=["x", "y", "z"])
plt.gca().set(xlabel="time, s", ylabel="position error, mm")
plt.legend()
plt.savefig("position_error.png")
