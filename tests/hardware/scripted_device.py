"""A far end of a serial line that says given bytes after it heard given bytes."""

import os
import select
import threading
import tty
from types import TracebackType


class ScriptedDevice:
    """Plays (bytes to hear, bytes to say) pairs; `wrong` holds what was heard instead."""

    def __init__(self, script: list[tuple[bytes, bytes]]) -> None:
        self._line, self._far_end = os.openpty()
        tty.setraw(self._far_end)
        self.port = os.ttyname(self._far_end)
        self.wrong: list[bytes] = []
        self._thread = threading.Thread(target=self._play, args=(script,), daemon=True)
        self._thread.start()

    def _play(self, script: list[tuple[bytes, bytes]]) -> None:
        for expected, answer in script:
            heard = b""
            while len(heard) < len(expected) and select.select([self._line], [], [], 1.0)[0]:
                heard += os.read(self._line, len(expected) - len(heard))
            if heard != expected:
                self.wrong.append(heard)
                return
            os.write(self._line, answer)

    def __enter__(self) -> "ScriptedDevice":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._thread.join()
        os.close(self._line)
        os.close(self._far_end)
