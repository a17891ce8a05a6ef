"""Jobs of a sweep that ask for the same simulated recording share the first one made.

A recording of a real robot is never shared: each job's acquisition is another experiment.
"""

import hashlib
import json
from dataclasses import asdict
from pathlib import Path

from pipeline.config import Config
from pipeline.recording import write_atomically

KEY_FILE = "recorded.json"
SHARED_STAGES = ("acquisition", "vision")
SHAPED_BY = ("seed", "acquisition", "robot", "camera", "twin", "vision")


def recording_key(config: Config) -> str:
    """Hash of all the configuration that shapes what acquisition and vision leave."""
    settings = asdict(config)
    text = json.dumps({name: settings[name] for name in SHAPED_BY}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def note_recording(config: Config, folder: Path) -> None:
    """Say in a job's folder that its recording is complete, and what shaped it."""
    if config.robot.kind == "emulated" and set(SHARED_STAGES) <= set(config.stages):
        entry = {"key": recording_key(config), "shaped_by": SHAPED_BY}
        write_atomically(folder / KEY_FILE, json.dumps(entry, indent=1))


def same_recording(config: Config, sweep: Path) -> Path | None:
    """A finished job of this sweep whose recording is the one that `config` would make."""
    if config.robot.kind != "emulated" or not set(SHARED_STAGES) <= set(config.stages):
        return None
    key = recording_key(config)
    for file in sorted(sweep.glob(f"*/{KEY_FILE}")):
        if json.loads(file.read_text()).get("key") == key:
            return file.parent
    return None
