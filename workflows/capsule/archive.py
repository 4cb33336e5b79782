"""The zip file of a capsule. The same files are the same bytes, and no zip file does harm where it is read.

Files are stored without compression, in the order of their names, with one time. Reasons: versions of zlib write different bytes, and a stored
file cannot grow when it is unpacked (zip bomb). The file is written here and not by zipfile, whose headers differ between versions of Python.
There is one way to write a set of files, so a reader compares each header with the one it would write: a changed byte has no place to hide.
"""
import hashlib
import os
import re
import stat
import struct
import zipfile
import zlib

MOST_BYTES = 0xFFFFFFFE   # of a zip file without the extension zip64
MOST_FILES = 0xFFFE
BLOCK = 1 << 20
DATE = (1 << 5) | 1       # 1 January 1980, the first date of the format
UTF8 = 0x800
VERSION = 20
UNIX = 3


class Bad(Exception):
    """The capsule cannot be used: which file, what was found, what was expected."""


class Entry:
    """A file to be written: its name in the zip, and its bytes or the path of the file that has them."""

    def __init__(self, name, content):
        if reason := wrong_name(name):
            raise Bad(f"{name!r} cannot be the name of a file in a capsule: {reason}")
        self.name, self.content = name, content
        self.size, self.crc, digest = 0, 0, hashlib.sha256()
        for block in self.blocks():
            self.size += len(block)
            self.crc = zlib.crc32(block, self.crc)
            digest.update(block)
        self.sha256 = digest.hexdigest()

    def blocks(self):
        if isinstance(self.content, bytes):
            yield self.content
            return
        with open(self.content, "rb") as file:
            while block := file.read(BLOCK):
                yield block


def wrong_name(name):
    """Why a file of this name is not unpacked; empty if nothing is wrong."""
    if not name or len(name.encode(errors="replace")) > 1000:
        return "it is empty or too long"
    if re.search(r"[\x00-\x1f\x7f\\]", name) or re.search("[\ud800-\udfff]", name):
        return "it has a control character, a backslash or a byte that is no text"
    if name.startswith("/") or re.match("[A-Za-z]:", name):
        return "it is an absolute path"
    parts = name.split("/")
    if ".." in parts:
        return "it leads out of the folder"
    if parts[-1] == "":
        return "it is a folder; a capsule has files only"
    if "" in parts or "." in parts or any(len(part.encode()) > 255 for part in parts):
        return "it has a part that is empty, '.' or too long"
    return ""


def local_header(name, size, crc):
    encoded = name.encode()
    return struct.pack("<4s5H3L2H", b"PK\3\4", VERSION, UTF8, 0, 0, DATE, crc, size, size, len(encoded), 0) + encoded


def directory_entry(name, size, crc, offset):
    encoded = name.encode()
    return struct.pack("<4s6H3L5H2L", b"PK\1\2", UNIX << 8 | VERSION, VERSION, UTF8, 0, 0, DATE, crc, size, size, len(encoded), 0, 0, 0, 0,
                       (stat.S_IFREG | 0o644) << 16, offset) + encoded


def end_of(count, directory_size, directory_offset):
    return struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, count, count, directory_size, directory_offset, 0)


def write(path, entries):
    entries = sorted(entries, key=lambda entry: entry.name)
    if len(entries) > MOST_FILES or sum(entry.size + 2 * len(entry.name.encode()) + 100 for entry in entries) > MOST_BYTES:
        raise Bad(f"{path}: {len(entries)} files of {sum(entry.size for entry in entries)} bytes are too many for a zip file; give a smaller --capsule-limit")
    with open(path, "wb") as file:
        directory = b""
        for entry in entries:
            directory += directory_entry(entry.name, entry.size, entry.crc, file.tell())
            file.write(local_header(entry.name, entry.size, entry.crc))
            begin = file.tell()
            for block in entry.blocks():
                file.write(block)
            if file.tell() - begin != entry.size:
                raise Bad(f"{entry.name} changed while the capsule was written; run the command again")
        offset = file.tell()
        file.write(directory + end_of(len(entries), len(directory), offset))


class Archive:
    """A capsule that was read and checked from its first byte to its last. files: name -> (offset, size, sha256)."""

    def __init__(self, path):
        self.path, self.files = path, {}
        infos = self.listed()
        self.check_names(infos)
        with open(path, "rb") as file:
            self.check_bytes(file, infos)

    def listed(self):
        size = os.path.getsize(self.path)
        if size > MOST_BYTES:
            raise Bad(f"{self.path}: has {size} bytes; a capsule has at most {MOST_BYTES}")
        try:
            with zipfile.ZipFile(self.path) as archive:
                return archive.infolist()
        except (zipfile.BadZipFile, zipfile.LargeZipFile, NotImplementedError, ValueError, struct.error, EOFError, OverflowError) as error:
            raise Bad(f"{self.path}: is no zip file, or is damaged or cut short: {error}") from None

    def check_names(self, infos):
        names = set()
        for info in infos:
            name = info.orig_filename
            if reason := wrong_name(name):
                raise Bad(f"{self.path}: {name!r}: {reason}; nothing was unpacked")
            if name in names:
                raise Bad(f"{self.path}: two files have the name {name!r}; nothing was unpacked")
            names.add(name)
            kind = stat.S_IFMT(info.external_attr >> 16)
            if kind not in (0, stat.S_IFREG):
                what = "a link" if kind == stat.S_IFLNK else "no regular file"
                raise Bad(f"{self.path}: {name!r} is {what}; nothing was unpacked")
            if info.flag_bits & 1:
                raise Bad(f"{self.path}: {name!r} is encrypted; nothing was unpacked")
            if info.compress_type != zipfile.ZIP_STORED or info.compress_size != info.file_size:
                raise Bad(f"{self.path}: {name!r} is compressed: {info.compress_size} bytes would become {info.file_size}. A capsule has files without "
                          "compression only; take the zip file that workflows/run wrote; nothing was unpacked")
        for name in names:
            if any(folder in names for folder in folders_of(name)):
                raise Bad(f"{self.path}: {name!r} is in a folder whose name is also that of a file; nothing was unpacked")

    def check_bytes(self, file, infos):
        directory = b""
        if [info.orig_filename for info in infos] != sorted(info.orig_filename for info in infos):
            raise Bad(f"{self.path}: its files are not in the order of their names; it was not written by workflows/run, or was changed")
        for info in infos:
            name = info.orig_filename
            directory += directory_entry(name, info.file_size, info.CRC, file.tell())
            self.expect(file, local_header(name, info.file_size, info.CRC), f"the header of {name!r}")
            offset, left, crc, digest = file.tell(), info.file_size, 0, hashlib.sha256()
            while left > 0 and (block := file.read(min(left, BLOCK))):
                left -= len(block)
                crc = zlib.crc32(block, crc)
                digest.update(block)
            if left > 0:
                raise Bad(f"{self.path}: {name!r} is cut short: {left} of {info.file_size} bytes are missing")
            if crc != info.CRC:
                raise Bad(f"{self.path}: {name!r} has other bytes than the capsule was made with: its checksum (CRC-32) is {crc:08x}, expected {info.CRC:08x}")
            self.files[name] = (offset, info.file_size, digest.hexdigest())
        offset = file.tell()
        self.expect(file, directory, "the directory of the zip file")
        self.expect(file, end_of(len(infos), len(directory), offset), "the end of the zip file")
        if file.read(1):
            raise Bad(f"{self.path}: has bytes after its end; it was not written by workflows/run, or was changed")

    def expect(self, file, expected, where):
        begin = file.tell()
        found = file.read(len(expected))
        if found != expected:
            at = begin + next((place for place, (a, b) in enumerate(zip(found, expected)) if a != b), len(found))
            raise Bad(f"{self.path}: byte {at}, in {where}, is not as workflows/run writes it: the file was changed, damaged or packed by another program")

    def read(self, name):
        offset, size, _ = self.files[name]
        with open(self.path, "rb") as file:
            file.seek(offset)
            return file.read(size)

    def unpack(self, folder):
        """Writes all files under a folder that is new or empty."""
        with open(self.path, "rb") as file:
            for name, (offset, size, _) in self.files.items():
                target = os.path.join(folder, name)
                os.makedirs(os.path.dirname(target), exist_ok=True)
                file.seek(offset)
                with open(target, "xb") as out:
                    left = size
                    while left > 0 and (block := file.read(min(left, BLOCK))):
                        left -= len(block)
                        out.write(block)


def folders_of(name):
    parts = name.split("/")
    return ["/".join(parts[:count]) for count in range(1, len(parts))]
