"""What all tests share: the folder of recordings that may lie beside the checkout."""

from pathlib import Path

import pytest

SHARED = Path(__file__).resolve().parents[2] / "shared"


@pytest.fixture
def concealed_recordings() -> list[Path]:
    folders = sorted((SHARED / "concealed").glob("case-*")) if SHARED.is_dir() else []
    if not folders:
        pytest.skip("no recordings beside the checkout")
    return folders
