#!/usr/bin/env python3
"""Writes the wheel: the Python package, the tools and every shared library that they need. usage: wheel.py TREE OUT

TREE is an installation whose programs and libraries look for libraries in $ORIGIN/../lib. The wheel puts

    scree/                          the Python package
    bin/scree-X                     packaging/tool, once for each program
    lib/scree/bin, lib, lib/plugins programs; libraries, among them libscree_engine.so for scree.Engine; plug-ins of Open MPI
    share/                          manual pages, shell completion

into the environment. As in manylinux wheels, the C and C++ libraries (kSystem) are those of the system; unlike there, X11 and GL are in the wheel,
so that scree-post also starts on machines without a screen. The tag names the C library of this machine: pip refuses the wheel where it is older.
"""
import base64
import glob
import hashlib
import os
import re
import shutil
import subprocess
import sys
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
TOOLS = ("scree-mesher", "scree-decomposer", "scree-solver", "scree-post")
kSystem = re.compile(r"(ld-linux-x86-64|lib(c|m|dl|pthread|rt|resolv|util|stdc\+\+|gcc_s))\.so\.\d+$")


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def needed(file):
    """Names of the shared libraries that a file asks for itself."""
    return re.findall(r"\(NEEDED\).*\[(.+)\]", output_of("readelf", "-dW", file))


def libraries_of(programs):
    """Name -> file of all shared libraries of the programs, without those of the system."""
    found = {}
    for program in programs:
        for name, path in re.findall(r"^\s*(\S+) => (.+) \(0x", output_of("ldd", program), flags=re.M):
            if not kSystem.match(name):
                found[name] = os.path.realpath(path)
        missing = re.findall(r"^\s*(\S+) => not found", output_of("ldd", program), flags=re.M)
        assert not missing, f"{program}: the system has no {', '.join(missing)}"
    return found


def plugins_of_open_mpi(libraries):
    """Those that need nothing that is not in the wheel: not those for networks and queues, which one rank has no use for."""
    folder = re.search(r"Pkglibdir: (.+)", output_of("ompi_info", "--path", "pkglibdir"))[1]
    return [plugin for plugin in sorted(glob.glob(f"{folder}/mca_*.so")) if all(kSystem.match(name) or name in libraries for name in needed(plugin))]


def licences(files):
    """Package -> file of its copyright, of the Debian packages that the files are from."""
    # a package may call a file of /usr/lib by its place in /lib
    names = {file: {file, file.removeprefix("/usr")} for file in files}
    said = subprocess.run(["dpkg-query", "-S", *sorted(set().union(*names.values()))], capture_output=True, text=True).stdout
    owners = {file: owner for owner, file in re.findall(r"^([\w.+-]+)(?::\w+)?: (.+)$", said, flags=re.M)}
    unknown = [file for file in files if not names[file] & set(owners)]
    assert not unknown, f"of no Debian package, so that their licence is unknown: {', '.join(unknown)}"
    return {owners[name]: f"/usr/share/doc/{owners[name]}/copyright" for file in files for name in names[file] if name in owners}


def main():
    tree, out = sys.argv[1:3]
    tools = [f"{tree}/bin/{tool}" for tool in TOOLS]
    version = re.search(r"\d+\.\d+\.\d+", output_of(tools[0], "--version"))[0]
    engine = os.path.realpath(glob.glob(f"{tree}/lib/**/libscree_engine.so", recursive=True)[0])
    assert "(RPATH)" in output_of("readelf", "-dW", engine), f"{engine}: has no RPATH, which also holds for what its libraries need"
    libraries = libraries_of([*tools, engine])
    plugins = plugins_of_open_mpi(libraries)
    # a RUNPATH of a library would be searched instead of the RPATH of the program
    shutil.rmtree(f"{tree}/bundled", ignore_errors=True)
    os.makedirs(f"{tree}/bundled/plugins")
    for name, file in [*libraries.items(), *((f"plugins/{os.path.basename(plugin)}", plugin) for plugin in plugins)]:
        shutil.copyfile(file, f"{tree}/bundled/{name}")
        if "(RUNPATH)" in output_of("readelf", "-dW", file):
            subprocess.run(["patchelf", "--remove-rpath", f"{tree}/bundled/{name}"], check=True)

    glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
    tag = f"py3-none-manylinux_{glibc}_{os.uname().machine}"
    data, info = f"scree-{version}.data", f"scree-{version}.dist-info"
    python = f"{tree}/lib/python3/dist-packages"
    files = {f"{data}/scripts/{tool}": os.path.join(HERE, "tool") for tool in TOOLS}  # place in the wheel -> file, or its text as bytes
    for folder, place in ((python, ""), (f"{tree}/bundled", f"{data}/data/lib/scree/lib/"), (f"{tree}/share/man", f"{data}/data/share/man/"),
                          (f"{tree}/share/bash-completion", f"{data}/data/share/bash-completion/")):
        for path in glob.glob(f"{folder}/**", recursive=True):
            if os.path.isfile(path) and "__pycache__" not in path:
                files[place + os.path.relpath(path, folder)] = path
    files |= {f"{data}/data/lib/scree/bin/{tool}": f"{tree}/bin/{tool}" for tool in TOOLS}
    files[f"{data}/data/lib/scree/lib/libscree_engine.so"] = engine
    files |= {f"{info}/licenses/{package}": text for package, text in licences([*libraries.values(), *plugins]).items()}
    files[f"{info}/licenses/scree"] = f"{HERE}/../LICENSE"
    files[f"{info}/METADATA"] = (f"Metadata-Version: 2.1\nName: scree\nVersion: {version}\n"
        "Summary: Discrete element method with rigid particles of any triangulated shape\nLicense: BSD-3-Clause; libraries: see licenses\n"
        # an extra: the tools need neither, and pip does not see the h5py of Debian, whose entry has the name h5py._debian_h5py_serial
        "Requires-Python: >=3.11\nProvides-Extra: python\nRequires-Dist: numpy; extra == 'python'\nRequires-Dist: h5py; extra == 'python'\n").encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: scree packaging\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()

    record = ""
    target = f"{out}/scree-{version}-{tag}.whl"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as wheel:
        def write(place, content):
            entry = zipfile.ZipInfo(place, (1980, 1, 1, 0, 0, 0))  # the same files make the same wheel
            entry.compress_type = zipfile.ZIP_DEFLATED
            program = "/scripts/" in place or "/lib/scree/" in place
            entry.external_attr = (0o100755 if program else 0o100644) << 16
            wheel.writestr(entry, content)

        for place in sorted(files):
            content = files[place]
            if isinstance(content, str):
                with open(content, "rb") as file:
                    content = file.read()
            write(place, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record += f"{place},sha256={digest},{len(content)}\n"
        write(f"{info}/RECORD", f"{record}{info}/RECORD,,\n")
    size = sum(os.path.getsize(f"{tree}/bundled/{name}") for name in libraries)
    print(f"{target}: {len(libraries)} libraries with {size / 1e6:.0f} MB, {len(plugins)} plug-ins of Open MPI")


main()
