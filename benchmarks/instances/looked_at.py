"""Which motions of an archive were looked at in an instance, and which of them solve it."""

import zlib
from base64 import b64decode, b64encode
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class LookedAt:
    """Which motions of an archive were looked at in an instance, and which of them solve it.

    The elites are in the order of their evaluation numbers, the lowest first. Bits are packed, the
    first into the highest of a byte, compressed by zlib and written in base64.

    Attributes:
        elites: How many elites the archive has, whatever any condition says of them.
        motions: How many of them were looked at.
        solving: How many of those solve the instance.
        which: A bit for each elite: whether it was looked at.
        which_solve: A bit for each that was looked at: whether it solves the instance.
    """

    elites: int
    motions: int
    solving: int
    which: str
    which_solve: str

    @classmethod
    def of(
        cls, rows: NDArray[np.intp], solved: NDArray[np.bool_], *, evaluation: NDArray[np.int64]
    ) -> "LookedAt":
        """Return them in this form.

        Args:
            rows: (n,) the distinct elites that were looked at.
            solved: (m,) for each elite of the archive, whether it solves the instance; where it was
                not looked at, it does not matter.
            evaluation: (m,) their evaluation numbers.
        """
        order = np.argsort(evaluation, kind="stable")
        looked = np.zeros(len(order), dtype=bool)
        looked[rows] = True
        which = looked[order]
        which_solve = solved[order][which]
        return cls(
            elites=len(order),
            motions=len(rows),
            solving=int(which_solve.sum()),
            which=_text(which),
            which_solve=_text(which_solve),
        )

    def masks(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return (elites,) which were looked at, and (elites,) which of these solve the instance.

        Raises:
            ValueError: The texts are damaged, or do not have as many bits as the numbers say.
        """
        which = _bits(self.which, self.elites, count=self.motions)
        solve = np.zeros(self.elites, dtype=bool)
        solve[which] = _bits(self.which_solve, self.motions, count=self.solving)
        return which, solve


def _text(bits: NDArray[np.bool_]) -> str:
    return b64encode(zlib.compress(np.packbits(bits).tobytes(), 9)).decode()


def _bits(text: str, n: int, *, count: int) -> NDArray[np.bool_]:
    try:
        packed = np.frombuffer(zlib.decompress(b64decode(text, validate=True)), np.uint8)
    except zlib.error as error:
        raise ValueError(f"bits cannot be unpacked: {error}") from error
    bits = np.unpackbits(packed).astype(bool)
    if len(packed) != (n + 7) // 8 or bits.sum() != count or bits[n:].any():
        raise ValueError(f"expected {count} of {n} bits to be set, but got others")
    return bits[:n]
