"""What all tests share: the folder of recordings that may lie beside the checkout."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from threadpoolctl import threadpool_limits

SHARED = Path(__file__).resolve().parents[2] / "shared"


if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell lets what it runs in the background ignore Ctrl-C, and so would all that tests start.
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def cache_of_its_own(tmp_path_factory: pytest.TempPathFactory) -> None:
    """No test finds what an earlier one, or a user, has kept."""
    os.environ["LOOPGAP_CACHE"] = str(tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="session", autouse=True)
def one_thread_each() -> Iterator[None]:
    """Tests run side by side: threads of small matrix products would only wait for each other."""
    with threadpool_limits(1):
        yield


@pytest.fixture
def concealed_recordings() -> list[Path]:
    folders = sorted((SHARED / "concealed").glob("case-*")) if SHARED.is_dir() else []
    if not folders:
        pytest.skip("no recordings beside the checkout")
    return folders


@pytest.fixture
def published_recordings() -> Path:
    """The public recordings that conf/importing has mappings for."""
    if not (SHARED / "recordings").is_dir():
        pytest.skip("the published recordings are not beside the checkout")
    return SHARED / "recordings"
