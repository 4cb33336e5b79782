"""Packings as VTK's XML PolyData (.vtp): a point for each sphere, with arrays.

Source: the VTK File Formats page of VTK's documentation. Written inline as base64 without compression, which every VTK reads;
read in all encodings: ascii, base64 and raw, inline or appended, plain or compressed by zlib.
"""
from __future__ import annotations

import base64
import binascii
import re
import zlib
from typing import IO, TYPE_CHECKING, Any
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np

from .errors import InputError

if TYPE_CHECKING:
    from .packings import Packing

_TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8",
          "Float32": "f4", "Float64": "f8"}
_NAMES = {np.dtype(code): name for name, code in _TYPES.items()}
# names that programs give the arrays: Scree, Yade ("radii", "angVel", "linVel"), LIGGGHTS's post-processors ("f", "omega", "v")
_RADII = ("radius", "radii", "Radius", "r")
_VELOCITIES = ("velocity", "v", "linVel", "Velocity")
_SPINS = ("angular_velocity", "omega", "angVel")


class _Arrays:
    """The data arrays of one file, decoded when asked for."""

    def __init__(self, path: str) -> None:
        self.path = path
        try:
            with open(path, "rb") as file:
                text = file.read()
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from error
        self._appended, self._raw = b"", False
        opening = re.search(rb"<AppendedData[^>]*>", text)
        if opening:  # raw bytes are no XML
            self._raw = b'encoding="raw"' in opening[0]
            start = text.find(b"_", opening.end()) + 1
            end = text.rfind(b"</AppendedData>")
            if start == 0 or end < start:
                raise self.error("the appended data have no beginning or no end; the file is cut off", text[: opening.start()].count(b"\n") + 1)
            self._appended = text[start:end] if self._raw else b"".join(text[start:end].split())
            text = text[: opening.end()] + text[end:]
        try:
            self.root = ElementTree.fromstring(text)
        except ElementTree.ParseError as error:
            raise self.error(f"no XML, or cut off: {error.msg if hasattr(error, 'msg') else error}", error.position[0]) from None
        if self.root.tag != "VTKFile" or self.root.get("type") != "PolyData":
            raise self.error(f"a VTKFile of type PolyData expected, {self.root.get('type') or self.root.tag} found")
        self._order = "<" if self.root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self._head = np.dtype(self._order + {"UInt64": "u8"}.get(self.root.get("header_type", "UInt32"), "u4"))
        compressor = self.root.get("compressor", "")
        if compressor not in ("", "vtkZLibDataCompressor"):
            raise self.error(f"compressed by {compressor}; only vtkZLibDataCompressor can be read")
        self._compressed = bool(compressor)

    def error(self, message: str, line: int | None = None) -> InputError:
        return InputError(f"{self.path}{'' if line is None else f':{line}'}: {message}")

    def values(self, element: ElementTree.Element, points: int) -> np.ndarray:
        """A DataArray, points x components, or points alone for one component."""
        name, kind = element.get("Name") or "Points", element.get("type", "")
        components = int(element.get("NumberOfComponents") or 1)
        if kind not in _TYPES:
            raise self.error(f"array {name}: type '{kind}' is no number")
        dtype = np.dtype(self._order + _TYPES[kind])
        try:
            if element.get("format") == "ascii":
                flat = np.array((element.text or "").split(), dtype=_TYPES[kind])
            else:
                flat = np.frombuffer(self._bytes(element), dtype).astype(_TYPES[kind])
            return flat.reshape((points, components) if components > 1 else (points,))
        except (ValueError, IndexError, zlib.error, binascii.Error) as error:
            raise self.error(f"array {name}: {points} x {components} numbers expected: {error}") from None

    def _bytes(self, element: ElementTree.Element) -> bytes:
        if element.get("format") == "appended":
            source, raw = self._appended[int(element.get("offset") or 0) :], self._raw
        else:
            source, raw = "".join((element.text or "").split()).encode("ascii", "replace"), False
        width = self._head.itemsize

        def head(count: int) -> tuple[list[int], bytes]:
            """The numbers before the data, and what follows them."""
            size = count * width if raw else 4 * -(-count * width // 3)
            part = source[:size] if raw else base64.b64decode(source[:size])
            return np.frombuffer(part[: count * width], self._head).tolist(), source[size:]

        if not self._compressed:
            if raw:
                (size,), rest = head(1)
                return rest[:size]
            plain = base64.b64decode(source[: 4 * -(-(width + int(head(1)[0][0])) // 3)])  # head and data are one piece of base64
            return plain[width:]
        (blocks,), _ = head(1)
        numbers, rest = head(3 + blocks)
        data = rest if raw else base64.b64decode(rest[: 4 * -(-sum(numbers[3:]) // 3)])
        out, at = [], 0
        for size in numbers[3:]:
            out.append(zlib.decompress(data[at : at + size]))
            at += size
        return b"".join(out)


def read_vtp(path: str, need_radius: bool, _: int | None = None) -> dict[str, Any]:
    """Points with an array `radius` (Yade: `radii`) or `diameter`; `velocity`, `angular_velocity`, `id`, `kind`, `quaternion`, `density` where there."""
    file = _Arrays(path)
    parts: dict[str, list[np.ndarray]] = {}
    pieces = file.root.findall("PolyData/Piece")
    for piece in pieces:
        count = int(piece.get("NumberOfPoints") or 0)
        points = piece.find("Points/DataArray")
        if points is None:
            raise file.error("a piece without points")
        arrays = {element.get("Name"): element for element in piece.findall("PointData/DataArray")}

        def first(*names: str) -> np.ndarray | None:
            found = [name for name in names if name in arrays]
            return file.values(arrays[found[0]], count) if found else None

        diameter, radius = first("diameter"), first(*_RADII)
        if radius is None and diameter is not None:
            radius = diameter / 2
        if radius is None and need_radius:
            raise file.error(f"no array radius, radii or diameter among those of the points ({', '.join(map(str, arrays)) or 'none'}); give the radius of all")
        kind = first("kind", "type")
        if kind is None and (material := first("material", "matId", "materialId")) is not None:
            kind = material + 1  # counted from 0 there
        for name, values in (("position", file.values(points, count)), ("radius", radius), ("id", first("id")), ("kind", kind),
                             ("velocity", first(*_VELOCITIES)), ("angular_velocity", first(*_SPINS)), ("quaternion", first("quaternion", "quat")),
                             ("density", first("density"))):
            if values is not None:
                parts.setdefault(name, []).append(values)
    if not pieces or any(len(values) != len(pieces) for values in parts.values()):
        raise file.error("no piece of points" if not pieces else "the pieces have different arrays")
    return {name: np.concatenate(values) for name, values in parts.items()}


def write_vtp(file: IO[str], p: Packing) -> None:
    """A vertex for each sphere; glyphs of diameter 2 x `radius` show them."""
    def array(name: str, values: np.ndarray) -> str:
        data = np.ascontiguousarray(values)
        data = data.astype(data.dtype.newbyteorder("<"))
        components = f' NumberOfComponents="{data.shape[1]}"' if data.ndim > 1 else ""
        text = base64.b64encode(np.uint64(data.nbytes).astype("<u8").tobytes() + data.tobytes()).decode("ascii")
        return f'<DataArray type="{_NAMES[np.dtype(values.dtype)]}" Name={quoteattr(name)}{components} format="binary">{text}</DataArray>\n'

    count = len(p)
    file.write(f'<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n<PolyData>\n'
               f'<Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">\n<PointData Scalars="radius">\n')
    for name in ("radius", "id", "kind", "velocity", "angular_velocity", "quaternion", "density"):
        values = getattr(p, name)
        if values is not None:
            file.write(array(name, values))
    file.write("</PointData>\n<Points>\n" + array("Points", p.position) + "</Points>\n<Verts>\n" + array("connectivity", np.arange(count, dtype=np.int64))
               + array("offsets", np.arange(1, count + 1, dtype=np.int64)) + "</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n")
