"""Files that a film is written to: WebP, AVIF and GIF by Pillow, MP4 by PyAV."""

from collections.abc import Callable
from fractions import Fraction
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import IO, Any

import PIL
from PIL import Image, features

from ryusa.errors import CaseError, ResultsError

Draw = Callable[[int], Image.Image]  # picture number k

SUFFIXES = (".webp", ".avif", ".gif", ".mp4")
QUALITY = {".webp": 82, ".avif": 70}  # of 100
# of x264: a lower factor is better and larger. Its macroblock tree reads memory that nobody wrote (seen
# with AVX-512): the same pictures would give other bytes from one film to the next
_X264 = {"crf": "22", "mbtree": "0", "preset": "medium"}
_PALETTE = 4  # pictures whose colours a GIF takes
_GIF = 2.0e9  # pixels of a GIF in all: Pillow holds one byte of each until the end
_SMALLEST = {".webp": 1, ".avif": 1, ".gif": 10}  # unit of a picture's duration [ms]


def check(path: Path, size: tuple[int, int], pictures: int) -> None:
    """Raise an error that says what is allowed for a file that cannot be written here."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise CaseError("output", str(path), f"must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    if suffix == ".mp4":
        if find_spec("av") is None:
            raise CaseError(
                "output", str(path),
                f"MP4 needs PyAV: pip install 'ryusa[film]'. Without it: {', '.join(writable())}",
            )  # fmt: skip
        if size[0] % 2 or size[1] % 2:
            raise CaseError("size", f"{size[0]}x{size[1]}", "must be even in both numbers for MP4")
    elif suffix not in writable():
        raise CaseError(
            "output", str(path), f"Pillow {PIL.__version__} does not write {suffix} here; it writes "
            f"{', '.join(writable())}",
        )  # fmt: skip
    if suffix == ".gif" and pictures * size[0] * size[1] > _GIF:
        most = int(_GIF / (size[0] * size[1]))
        raise CaseError(
            "frames", pictures, f"must be at most {most} for a GIF of {size[0]}x{size[1]}, which is held in "
            "memory until it is written; other formats are not",
        )  # fmt: skip


def writable() -> tuple[str, ...]:
    """Suffixes that the Pillow installed here can write."""
    return tuple(one for one in SUFFIXES[:-1] if one == ".gif" or features.check(one[1:]))


def write(path: Path, draw: Draw, pictures: int, fps: float) -> None:
    """Write a film; the file has its name once it is whole.

    Parameters
    ----------
    draw : gives picture k, 0 .. pictures - 1, each of one size. Each is asked for in turn.
    fps : pictures a second.
    """
    suffix = path.suffix.lower()
    part = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:
            if suffix == ".mp4":
                _mp4(file, draw, pictures, fps)
            else:
                _pillow(file, suffix, draw, pictures, fps)
        part.replace(path)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from None
    finally:
        part.unlink(missing_ok=True)


class _Pictures(Image.Image):
    """Pictures that are drawn when a writer of Pillow comes to them: a list would hold all at once."""

    is_animated = True

    def __init__(self, draw: Draw, pictures: int) -> None:
        super().__init__()
        self._draw, self.n_frames, self._k = draw, pictures, -1
        self.seek(0)

    def seek(self, frame: int) -> None:
        """Go to a picture."""
        if frame >= self.n_frames:
            raise EOFError
        if frame == self._k or (frame == 0 and self._k == self.n_frames - 1):  # writers return at the end
            return
        one = self._draw(frame)
        self.im, self._mode, self._size, self.palette = one.im, one.mode, one.size, one.palette
        self._k = frame

    def tell(self) -> int:
        """Number of the picture."""
        return self._k


def _pillow(file: IO[bytes], suffix: str, draw: Draw, pictures: int, fps: float) -> None:
    unit = _SMALLEST[suffix]
    ends = [unit * round(k * 1000.0 / (unit * fps)) for k in range(pictures + 1)]
    how: dict[str, Any] = {"duration": [b - a for a, b in pairwise(ends)]}
    if suffix == ".gif":
        draw = _few_colours(draw, pictures)
        how |= {"loop": 0, "optimize": False}
    else:
        how |= {"quality": QUALITY[suffix]}
    if suffix == ".webp":
        how |= {"loop": 0, "method": 2, "kmin": 0, "kmax": 1}  # each whole: differences leave faint ghosts
    elif suffix == ".avif":
        how |= {"speed": 8}
    _Pictures(draw, pictures).save(file, suffix[1:].upper(), save_all=True, **how)


def _few_colours(draw: Draw, pictures: int) -> Draw:
    """The same pictures in the 256 colours that suit a few of them best: no flicker from one to the next."""
    some = [draw(k * (pictures - 1) // (_PALETTE - 1)) for k in range(_PALETTE)]
    wide, high = some[0].size
    beside = Image.new("RGB", (wide, _PALETTE * high))
    for k, one in enumerate(some):
        beside.paste(one, (0, k * high))
    colours = beside.quantize(256, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    return lambda k: draw(k).quantize(palette=colours, dither=Image.Dither.NONE)


def _mp4(file: IO[bytes], draw: Draw, pictures: int, fps: float) -> None:
    import av

    with av.open(file, "w", format="mp4", options={"movflags": "faststart"}) as film:
        first = draw(0)
        stream = film.add_stream("libx264", Fraction(fps).limit_denominator(1000), options=_X264)
        stream.width, stream.height, stream.pix_fmt = *first.size, "yuv420p"
        # said aloud, or players guess the colours by the size of the picture: 1 is BT.709, and its range
        codec: Any = stream.codec_context
        codec.colorspace = codec.color_primaries = codec.color_trc = codec.color_range = 1
        for k in range(pictures):
            frame = av.VideoFrame.from_image(first if k == 0 else draw(k))
            frame = frame.reformat(format="yuv420p", dst_colorspace="ITU709", dst_color_range="MPEG")
            frame.pts = k
            film.mux(stream.encode(frame))
        film.mux(stream.encode())
