"""RO-Crate 1.1 metadata of a capsule (https://w3id.org/ro/crate/1.1), and what it is read from: CITATION.cff, licences, Debian packages."""
import json
import mimetypes
import os
import re
import subprocess
from urllib.parse import quote

METADATA = "ro-crate-metadata.json"
PROFILE = "https://w3id.org/ro/crate/1.1"
# sha256 came to schema.org after the context of RO-Crate 1.1
CONTEXT = [f"{PROFILE}/context", {"sha256": "https://schema.org/sha256"}]
KINDS = {".toml": "application/toml", ".md": "text/markdown", ".csv": "text/csv", ".py": "text/x-python", ".smk": "text/plain", ".json": "application/json", ".h5": "application/x-hdf5",
         ".stl": "model/stl", ".obj": "model/obj"}
NO_LICENCE = "#no-licence"


def id_of(name):
    """A file name as the identifier of its entity: a relative path as in a URL."""
    return quote(name, safe="/-_.~")


def kind_of(name):
    return KINDS.get(os.path.splitext(name)[1].lower()) or mimetypes.guess_type(name)[0] or "text/plain" * name.startswith("licences/") or "application/octet-stream"


def cited(path):
    """authors and licence of a CITATION.cff: the lines of these two keys, without a reader of YAML."""
    authors, licence, inside = [], None, False
    if not os.path.isfile(path):
        return authors, licence
    with open(path, encoding="utf-8") as file:
        for line in file:
            key = re.match(r"([A-Za-z-]+):\s*(.*?)\s*$", line)
            if key:
                inside = key[1] == "authors"
                if key[1] == "license":
                    licence = key[2].strip("\"'")
            elif inside and (item := re.match(r"\s*(-?)\s*([A-Za-z-]+):\s*(.*?)\s*$", line)):
                if item[1]:
                    authors.append({})
                authors[-1][item[2]] = item[3].strip("\"'")
    return authors, licence


def author_entities(authors):
    for number, author in enumerate(authors, 1):
        person = " ".join(author[part] for part in ("given-names", "name-particle", "family-names", "name-suffix") if author.get(part))
        entity = {"@id": author.get("orcid") or f"#author-{number}", "@type": "Person" if person else "Organization", "name": person or author.get("name", "")}
        if author.get("affiliation"):
            entity["affiliation"] = author["affiliation"]
        yield entity


def package_of(path):
    """Name and version of the Debian package that a file comes from, and its text of copyright; None without one."""
    if not path.startswith("/usr/"):   # dpkg takes a second to know no owner
        return None
    try:
        owner = subprocess.run(["dpkg", "-S", path], capture_output=True, text=True, check=True).stdout
        name = owner.split(":")[0].split(",")[0]
        version = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", name], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None
    return name, version, f"/usr/share/doc/{name}/copyright"


def metadata(capsule, entries, authors, licence, mesh_licences):
    """The text of ro-crate-metadata.json. capsule: content of capsule.json; entries: the files; licence: an entity; mesh_licences: file -> its licence."""
    names = {entry.name for entry in entries}
    people = list(author_entities(authors))
    software = [{"@id": f"#{tool}", "@type": "SoftwareApplication", "name": tool, "softwareVersion": versions[0].removeprefix(tool).strip(),
                 "description": "; ".join(re.sub(r"\s+", " ", line) for line in versions[1:])} for tool, versions in capsule["versions"]["tools"].items()]
    files = [{"@id": id_of(entry.name), "@type": "File", "name": os.path.basename(entry.name), "contentSize": str(entry.size), "encodingFormat": kind_of(entry.name),
              "sha256": entry.sha256, **({"license": {"@id": mesh_licences[entry.name]}} if entry.name in mesh_licences else {})} for entry in entries]
    runs = [{"@id": f"#run-{quote(run['name'], safe='')}", "@type": "CreateAction", "name": run["name"], "description": f"{run['title']}: {run['steps']} steps of {run['bodies']} bodies; "
             f"state hash {run['state_hash']}", "instrument": {"@id": "#scree-solver"}, "object": [{"@id": id_of(run["case"])}],
             "result": [{"@id": id_of(run[key])} for key in ("record", "log") if run[key] in names], "actionStatus": "http://schema.org/CompletedActionStatus"} for run in capsule["runs"]]
    root = {"@id": "./", "@type": "Dataset", "name": capsule["title"], "description": f"A simulation by the discrete element method, made with: {' '.join(capsule['command'])}. "
            "The command workflows/verify of Scree computes its runs again and compares the bits of their final states.",
            "datePublished": capsule["date"], "license": {"@id": licence["@id"]}, "hasPart": [{"@id": file["@id"]} for file in files],
            "mentions": [{"@id": entity["@id"]} for entity in (*runs, *software)]}
    if people:
        root["author"] = [{"@id": person["@id"]} for person in people]
    describes = {"@id": METADATA, "@type": "CreativeWork", "conformsTo": {"@id": PROFILE}, "about": {"@id": "./"}}
    known = {file["@id"]: file for file in files}
    if licence["@id"] in known:   # the text of the licence is a file of the capsule
        known[licence["@id"]].update(licence, **{"@type": ["File", "CreativeWork"]})
        licence = None
    graph = [describes, root, *files, *([licence] if licence else []), *people, *software, *runs]
    return json.dumps({"@context": CONTEXT, "@graph": graph}, indent=1, ensure_ascii=False) + "\n"
