"""Jobs of a study that `stillkite batch` has written."""

import json
import pathlib
import sys


def finished_jobs(folder):
    """(job of study.json, folder of its results), in the order of configuration and seed."""
    folder = pathlib.Path(folder)
    jobs = json.loads((folder / "study.json").read_text(encoding="utf-8"))["jobs"]
    missing = [job["id"] for job in jobs if job["status"] != "finished"]
    if missing:
        print(f"not finished: {', '.join(missing)}", file=sys.stderr)
    jobs = [job for job in jobs if job["status"] == "finished"]
    jobs.sort(key=lambda job: (job["configuration"], job["seed"] or 0))
    return [(job, folder / "jobs" / job["id"]) for job in jobs]
