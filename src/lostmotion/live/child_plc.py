"""A PLC in a child process: the exported Structured Text of a supervised block, run by whatever the command starts.

Lines of JSON on its standard input and output. The first says what is to run, ``{"st": text, "inputs": [names],
"parameters": [names], "outputs": [names]}``, and is answered by ``{"ready": true}``. Each scan is ``{"cold": bool,
"inputs": [numbers], "parameters": [numbers]}``, answered by ``{"outputs": [numbers]}``; flags are 0 and 1, a cold scan
begins with an empty memory. ``{"error": text}`` answers what cannot be done. The end of its input ends it.
"""

from __future__ import annotations

import json
import queue
import subprocess
import threading
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.errors import FileAccessError
from lostmotion.export import TARGETS
from lostmotion.export.source import Source
from lostmotion.live.virtual_plc import VirtualPlc

BEGIN, ANSWER, END = 120.0, 10.0, 5.0  # s for a compiler, a scan, a farewell
NAME, DATE = "FY_DEMO", "2026-01-31"
REMEDY = "see `lostmotion.live.child_plc` for what is said"


class ChildPlc(VirtualPlc):
    """The block in the dialect ST, LREAL, in a process of its own.

    Parameters
    ----------
    block : SupervisedBlock
    command : sequence of str
        Starts the process.

    Raises
    ------
    FileAccessError
        It cannot be started, does not take the text, or does not answer.
    """

    def __init__(self, block: SupervisedBlock, command: Sequence[str]) -> None:
        try:
            self._child = subprocess.Popen(  # noqa: S603  the user names it
                list(command), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
            )
        except OSError as error:
            raise FileAccessError(f"expected a PLC to start, got {error.strerror}; check --plc") from error
        self._answers: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._listen, daemon=True)
        self._reader.start()
        super().__init__(block)
        text = "".join(TARGETS["st"].files(Source(block, NAME, DATE, "lreal")).values())
        try:
            self._load(text)
        except BaseException:
            self.close()
            raise

    def restart(self) -> None:
        """See :meth:`VirtualPlc.restart`; from the next scan on."""
        super().restart()
        self._cold = True

    def close(self) -> None:
        """End the process."""
        with suppress(OSError):
            self._pipe("stdin").close()
        try:
            self._child.wait(END)
        except subprocess.TimeoutExpired:
            self._child.kill()
            self._child.wait()
        self._reader.join(END)
        self._pipe("stdout").close()

    def _load(self, text: str) -> None:
        if self._ask({"st": text, **self._names_of_sections()}, BEGIN) != {"ready": True}:
            raise FileAccessError(f"expected a PLC that says ready, got another answer; {REMEDY}")

    def _execute(self) -> None:
        cold, self._cold = self._cold, False
        row = {"cold": cold, "inputs": self.inputs[0].tolist(), "parameters": self.settings.tolist()}
        outputs = self._ask(row, ANSWER).get("outputs")
        if not isinstance(outputs, list) or len(outputs) != self.outputs.shape[1]:
            raise FileAccessError(f"expected {self.outputs.shape[1]} outputs of the PLC, got another answer; {REMEDY}")
        self.outputs[0] = outputs

    def _names_of_sections(self) -> dict[str, list[str]]:
        return {f"{section}s": list(names) for section, names in self._names.items()}

    def _pipe(self, name: str) -> Any:
        pipe = getattr(self._child, name)
        assert pipe is not None  # noqa: S101  asked for
        return pipe

    def _listen(self) -> None:
        with suppress(ValueError, OSError):  # closed
            for line in self._pipe("stdout"):
                self._answers.put(line)
        self._answers.put("")

    def _ask(self, said: dict[str, Any], seconds: float) -> dict[str, Any]:
        with suppress(OSError):  # it has ended: what it said last, or its end, is the answer
            self._pipe("stdin").write(json.dumps(said) + "\n")
            self._pipe("stdin").flush()
        try:
            answer = json.loads(self._answers.get(timeout=seconds) or "null")
        except ValueError as error:
            raise FileAccessError(f"expected an answer of the PLC, got {error}; {REMEDY}") from error
        except queue.Empty as error:
            raise FileAccessError(f"expected an answer of the PLC within {seconds:g} s, got none; {REMEDY}") from error
        if not isinstance(answer, dict) or "error" in answer:
            got = answer.get("error") if isinstance(answer, dict) else "its end"
            raise FileAccessError(f"expected an answer of the PLC, got {str(got)[:300]}; {REMEDY}")
        return answer
