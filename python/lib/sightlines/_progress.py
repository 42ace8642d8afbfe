"""Progress of long calls."""

from __future__ import annotations

from collections.abc import Callable
from types import TracebackType
from typing import Any, Union

ProgressFunction = Callable[[str, int, int], object]
Progress = Union[bool, ProgressFunction]


class Reporter:
    """Makes of ``progress=`` what the compiled part calls: nothing, a function of the user, or bars of tqdm."""

    def __init__(self, progress: Progress) -> None:
        self.call: ProgressFunction | None = None
        self._bar: Any = None
        self._phase: tuple[str, int] | None = None
        if callable(progress):
            self.call = progress
        elif progress:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self._tqdm = tqdm
            self.call = self._show

    def _show(self, phase: str, done: int, total: int) -> None:
        if self._phase != (phase, total):
            self._close()
            self._phase = (phase, total)
            # Nothing is shown of calls that are over at once.
            self._bar = self._tqdm(desc=phase, total=total, leave=False, delay=0.5)
        self._bar.n = min(done, total)
        self._bar.update(0)

    def _close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None

    def __enter__(self) -> ProgressFunction | None:
        return self.call

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._close()
