"""Driver and emulator byte for byte against the published and computed RS232 conversations."""

import json
from pathlib import Path
from typing import Any

import pytest
import serial
from scripted_device import ScriptedDevice

from pipeline.clock import SimulatedClock
from pipeline.errors import LoopgapError
from pipeline.hardware import epos2_frames as frames
from pipeline.hardware.epos2_emulator import Epos2Emulator
from pipeline.hardware.epos2_frames import Entry
from pipeline.hardware.epos2_line import Epos2Line

FILE = Path(__file__).resolve().parents[3] / "shared" / "epos2" / "epos2_vectors.json"
SIZES = {"8": 1, "16": 2, "32": 4}

pytestmark = pytest.mark.skipif(not FILE.is_file(), reason=f"{FILE} is not there")


def vectors(kind: str = "vectors") -> list[dict[str, Any]]:
    return json.loads(FILE.read_text())[kind] if FILE.is_file() else []


def transactions() -> list[dict[str, Any]]:
    """Reads and writes; over RS232 an unknown opcode is refused before there is a frame."""
    return [v for v in vectors() if v["opcode"] in ("0x10", "0x11")]


def script_of(vector: dict[str, Any]) -> list[tuple[bytes, bytes]]:
    line = vector["rs232"]
    turns = sorted(int(key.removeprefix("host_")) for key in line if key.startswith("host_"))
    return [
        (bytes.fromhex(line[f"host_{n}"]), bytes.fromhex(line.get(f"device_{n}", "")))
        for n in turns
    ]


def entry_of(vector: dict[str, Any]) -> Entry:
    kind = vector["type"] or "UINT32"
    size = SIZES[kind.lstrip("UINT")]
    return Entry(int(vector["index"], 16), vector["sub"], size, not kind.startswith("U"))


class OneValue:
    """A node that holds one value, whatever is read."""

    def __init__(self, error: int, dword: int) -> None:
        self._answer = error, dword

    def read(self, _index: int, _subindex: int) -> tuple[int, int]:
        return self._answer


@pytest.mark.parametrize("vector", vectors(), ids=lambda v: v["name"])
def test_frames(vector: dict[str, Any]) -> None:
    line = vector["rs232"]
    opcode = int(vector["opcode"], 16)
    request = frames.frame_body(opcode, bytes.fromhex(vector["request_data"]))
    answer = frames.frame_body(frames.ANSWER, bytes.fromhex(vector["response_data"]))
    assert request == bytes.fromhex(line["host_2"])
    assert answer == bytes.fromhex(line["device_3"])


@pytest.mark.parametrize("vector", transactions(), ids=lambda v: v["name"])
def test_driver(vector: dict[str, Any]) -> None:
    entry, node = entry_of(vector), vector["node"]
    error = int.from_bytes(bytes.fromhex(vector["response_data"])[:4], "little")
    with ScriptedDevice(script_of(vector)) as device:
        line = Epos2Line(device.port, 115200)
        if error:
            with pytest.raises(LoopgapError, match=f"0x{error:08X}"):
                _perform(line, vector, node, entry)
        elif vector["opcode"] == "0x10":
            assert line.read(node, entry) == entry.decode(vector["value"])
        else:
            _perform(line, vector, node, entry)
        line.close()
    assert device.wrong == []


def _perform(line: Epos2Line, vector: dict[str, Any], node: int, entry: Entry) -> None:
    if vector["opcode"] == "0x10":
        line.read(node, entry)
    else:
        line.write(node, entry, entry.decode(vector["value"]))


@pytest.fixture(scope="module")
def emulator() -> Any:
    with Epos2Emulator({"yaw": 1, "pitch": 2}, SimulatedClock(), junk=lambda: 0) as emulator:
        yield emulator


@pytest.fixture(scope="module")
def port(emulator: Epos2Emulator) -> Any:
    with serial.Serial(emulator.port, 115200, timeout=1.0, exclusive=True) as port:
        yield port


def _converse(port: serial.Serial, script: list[tuple[bytes, bytes]]) -> None:
    for said, expected in script:
        port.write(said)
        assert port.read(len(expected)) == expected
    assert port.in_waiting == 0


@pytest.mark.parametrize("vector", transactions(), ids=lambda v: v["name"])
def test_emulator(vector: dict[str, Any], emulator: Epos2Emulator, port: serial.Serial) -> None:
    """Writes and refusals by the emulated controller itself; reads of a value that is laid in."""
    answer = bytes.fromhex(vector["response_data"])
    own = emulator.nodes[vector["node"]]
    if vector["opcode"] == "0x10" and answer[:4] == bytes(4):
        dword = int.from_bytes(answer[4:], "little")
        emulator.nodes[vector["node"]] = OneValue(0, dword)  # type: ignore[assignment]
    _converse(port, script_of(vector))
    emulator.nodes[vector["node"]] = own


@pytest.mark.parametrize("vector", vectors("nmt"), ids=lambda v: v["name"])
def test_emulator_obeys_network_commands(vector: dict[str, Any], port: serial.Serial) -> None:
    """A node that resets itself says no more, as the file's notes tell."""
    (opcode, ready), (request, accepted) = script_of(vector)
    _converse(port, [(opcode, ready), (request, b"" if "reset" in vector["name"] else accepted)])
    _converse(port, [(b"\x7f", b"F")])
