"""Import in a test: a mapping as a user would write it, the files, and what comes out."""

from pathlib import Path

import yaml
from omegaconf import OmegaConf

from pipeline.config_importing import ImportingConfig
from pipeline.foreign.read import read_table
from pipeline.recording import load_recording, save_recording
from pipeline.stages.importing import Imported, assemble

TWO_CHANNELS = """
tables:
  samples:
    time: {column: t}
    channels:
      command_deg: {column: cmd, role: command, unit: deg}
      angle_deg: {column: ang, role: measurement, from_unit: rad, unit: deg}
"""


def mapping(text: str = TWO_CHANNELS, **samples: object) -> ImportingConfig:
    """The mapping of some YAML; `samples` are further settings of its table `samples`."""
    content = yaml.safe_load(text)
    if samples:
        content = OmegaConf.merge(content, {"tables": {"samples": samples}})
    found = OmegaConf.to_object(OmegaConf.merge(OmegaConf.structured(ImportingConfig), content))
    assert isinstance(found, ImportingConfig)
    return found


def import_from(path: Path, config: ImportingConfig) -> Imported:
    """Read, assemble, save and load again; the recording is the loaded one."""
    tables = {name: read_table(path, name, table) for name, table in config.tables.items()}
    imported = assemble(config, tables)
    folder = path.parent / "imported"
    save_recording(imported.recording, folder)
    return Imported(load_recording(folder), imported.account, imported.frames)
