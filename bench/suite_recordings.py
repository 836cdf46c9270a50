"""Recordings and variants of bench/real_suite; makes the variants' folders."""

import dataclasses
import json
import os
import pathlib
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/release"
STILLKITE = BUILD / "app/stillkite"
MAKE_VARIANT = BUILD / "bench/bench_recording_variant"
CONFIGS = ROOT / "bench/recordings"
SOURCES = [*(ROOT / "bench").glob("recording*.cpp"), ROOT / "bench/codec_round_trip.cpp"]
DATA = pathlib.Path(os.environ.get("STILLKITE_DATA", ROOT.parent / "shared/data"))

# The last third of a recording is for judging; a simulated flight is in one part as a whole.
DEVELOPMENT, JUDGING, WHOLE = (0, 2 / 3), (2 / 3, 1), (0, 1)
PARTS = {"development": DEVELOPMENT, "judging": JUDGING}

STARTS = [f"start_{k}" for k in range(8)]  # at k/16 of the part; start_0 is the recording itself
IMAGE_CHANGES = ["gamma_0.6", "gamma_1.6", "noise", "jpeg", "exposure_steps", "h264", "hevc"]
TRANSFORMS = ["every_2nd", "every_3rd", "backwards", "mirrored", "half_size"]
# Initial tilt wrong by 1 degree, height by 2 %, and known to be: consistency only.
PRIORS = {"tilt_prior": {"pitch_deg": 1, "height_m": 1}, "height_prior": {"pitch_deg": 0, "height_m": 1.02}}
ALL = STARTS + TRANSFORMS + IMAGE_CHANGES + list(PRIORS)
PRIOR_SIGMAS = {"navigator.initial_tilt_sigma_rad": 0.0175, "fusion.height_sigma_ratio": 0.02,
                "navigator.sensors.start_height_sigma_ratio": 0.02}
WITHOUT_TRUTH = ["start_0", "start_4", "every_2nd", "every_3rd", "half_size", "noise", "jpeg", "h264"]

JUDGING_GROUNDS = {"construction", "field_weak_texture", "shore_b"}  # and even seeds over the others

# A variant's folder holds lens, mount, truth and IMU: the configuration's own are reset.
IN_FOLDER = {"source.start_s": 0, "source.end_s": None, "source.rate_hz": None, "calibration.path": None,
             "calibration.camera": None, "mount.down_deg": None, "mount.rotation_wxyz": None,
             "truth.path": None, "truth.positions": None, "truth.ground_z_m": 0, "truth.time_offset_s": 0,
             "imu.time_offset_s": None, "imu.rotation_wxyz": None}


@dataclasses.dataclass(frozen=True)
class Flight:
    """One part of a recording, or one simulated flight, with the variants that are run."""
    recording: str
    part: str
    config: pathlib.Path
    variants: tuple
    span: tuple
    name: str
    truth: str = "recorded"  # recorded, at_rest, identity_attitude, none
    settings: tuple = ()     # pairs of key and value
    imu: str = ""            # log that the configuration does not name
    label: str = ""          # of the only variant of a simulated flight


def recorded_flights(names, variants=None):
    truths = {"hover_static": "at_rest", "indoor_standing": "at_rest", "slider_depth": "identity_attitude",
              "indoor_hover": "none", "bare_h264": "none"}
    flights = []
    for name in names:
        truth = truths.get(name, "recorded")
        own = WITHOUT_TRUTH if truth == "none" else ALL
        kept = [v for v in variants or own if v in own]
        flights += [Flight(name, part, CONFIGS / f"{name}.yaml", tuple(kept), span, f"{name}-{part}", truth)
                    for part, span in PARTS.items()]
    return flights


def simulated_flights(folder, variants):
    """Flights that bench/studies/suite_flights.yaml has simulated: flight-RELIEF-GROUND-SEED."""
    flights = []
    for run in sorted(folder.glob("jobs/*/run.yaml")):
        _, relief, ground, seed = run.parent.name.split("-")
        part = "judging" if ground in JUDGING_GROUNDS or int(seed) % 2 == 0 else "development"
        flights.append(Flight(f"simulated_{relief}", part, run, tuple(variants), WHOLE, run.parent.name,
                              settings=(("fusion.flat_ground", relief == "flat"),),
                              imu=str(run.parent / "mav0/imu0/data.csv"), label=f"{ground}-{seed}"))
    return flights


def kind_of(variant):
    """Kind of folder that a variant reads: starts share the recording, priors the one at x = y = 0."""
    if variant in STARTS:
        return "recorded"
    return "from_origin" if variant in PRIORS else variant


class Variants:
    """Cache of variant folders."""

    def __init__(self, folder):
        self.folder = folder

    def path(self, flight, variant):
        return self.folder / flight.name / kind_of(variant)

    def missing(self, flight):
        """Kinds whose folder is missing or older than its sources; the program changes with every library."""
        newest = max(file.stat().st_mtime for file in (*SOURCES, flight.config))
        kinds = {kind_of(v) for v in flight.variants}
        return sorted(kind for kind in kinds if not (self.folder / flight.name / kind / "mav0").exists()
                      or (self.folder / flight.name / kind).stat().st_mtime < newest)

    def make(self, flight, kind):
        """Standard error of the program if it failed."""
        out = self.folder / flight.name / kind
        for old in (out, out.with_name(out.name + ".part")):
            shutil.rmtree(old, ignore_errors=True)
        out.parent.mkdir(parents=True, exist_ok=True)
        arguments = ["--kind", kind, "--from", str(flight.span[0]), "--to", str(flight.span[1]), "--out", out]
        if flight.truth in ("at_rest", "identity_attitude"):
            arguments.append("--" + flight.truth.replace("_", "-"))
        if flight.imu:
            arguments += ["--set", f"imu.path={flight.imu}"]
        run = subprocess.run([MAKE_VARIANT, flight.config, *map(str, arguments)], capture_output=True, text=True,
                             env={**os.environ, "STILLKITE_DATA": str(DATA)})
        return run.stderr.strip() if run.returncode else None

    def settings(self, flight, variant):
        """Keys of a run of this variant."""
        folder = self.path(flight, variant)
        keys = {**IN_FOLDER, **dict(flight.settings), "source.path": str(folder)}
        if (folder / "mav0/imu0/data.csv").exists():
            keys["imu.path"] = str(folder / "mav0/imu0/data.csv")
        if variant in STARTS:
            keys["source.start_s"] = STARTS.index(variant) / 16 * duration_s(folder)
        if flight.truth != "none":
            keys |= {"initial.from_truth": True, "initial.height_m": None}
        if variant in PRIORS:
            keys |= prior_keys(folder, PRIORS[variant])
        return keys


def prior_keys(folder, error):
    """Initial state with the prior's error; a change of pitch is a rotation about a level axis."""
    initial = json.loads((folder / "initial.json").read_text())
    initial["pitch_deg"] += error["pitch_deg"]
    initial["height_m"] *= error["height_m"]
    return {"initial.from_truth": False, **{f"initial.{key}": value for key, value in initial.items()},
            **PRIOR_SIGMAS}


def duration_s(folder):
    rows = (folder / "mav0/cam0/data.csv").read_text().split()
    stamps = [int(row.split(",")[0]) for row in rows if row[0].isdigit()]
    return (stamps[-1] - stamps[0]) * 1e-9
