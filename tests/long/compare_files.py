"""Compares the output files of two runs value by value: pixels, datasets, attributes, values of JSON, TOML and CSV."""

import csv
import json
import math
import os
import re
import struct
import tomllib
from typing import NamedTuple

import h5py
import numpy

# Names of values that differ between two runs or two programs although the results are equal. settings_sha256 includes
# the version of the program; REFERENCE_LIST is the inverse of DIMENSION_LIST.
UNCOMPARED = re.compile(
    r"(.*[/.@])?(date_and_time|software_version|git_sha1|settings_sha256|seconds_\w+|REFERENCE_LIST)")
PROGRAM_VERSION = re.compile(r"\d+\.\d+\.\d+ \([0-9a-f]{7,40}[^)]*\)")
TIFF_TYPES = {3: ("H", 2), 4: ("I", 4)}


class Difference(NamedTuple):
    """A value that differs; absolute and relative are NaN if it is not a number."""

    file: str
    dataset: str
    absolute: float
    relative: float
    text: str


def read_tiff(path):
    """Returns the pixels of an uncompressed grey image of one page, as the program writes it."""
    with open(path, "rb") as file:
        data = file.read()
    order = {b"II*\0": "<", b"MM\0*": ">"}[data[:4]]
    (start,) = struct.unpack_from(order + "I", data, 4)
    tags = {}
    for i in range(struct.unpack_from(order + "H", data, start)[0]):
        place = start + 2 + 12 * i
        tag, kind, count = struct.unpack_from(order + "HHI", data, place)
        if kind in TIFF_TYPES:
            code, size = TIFF_TYPES[kind]
            if size * count > 4:
                (place,) = struct.unpack_from(order + "I", data, place + 8)
            else:
                place += 8
            tags[tag] = struct.unpack_from(f"{order}{count}{code}", data, place)
    if tags.get(259, (1,)) != (1,):
        raise ValueError(f"{path} is compressed")
    columns, rows, bits = tags[256][0], tags[257][0], tags[258][0]
    pixels = b"".join(data[at:at + size] for at, size in zip(tags[273], tags[279]))
    return {"pixels": numpy.frombuffer(pixels, f"{order}u{bits // 8}").reshape(rows, columns)}


def read_hdf5(path):
    """Returns all datasets by their path, and all attributes as PATH@NAME; references become names of their targets."""
    values = {}
    with h5py.File(path) as file:

        def convert(value):
            if isinstance(value, h5py.Reference):
                return file[value].name
            if isinstance(value, numpy.ndarray) and value.dtype == object:
                return str([convert(one) for one in value.ravel()])
            return value.decode() if isinstance(value, bytes) else value

        def collect(name, item):
            if isinstance(item, h5py.Dataset):
                values[name] = convert(item[()])
            for key, value in item.attrs.items():
                values[f"{name}@{key}"] = convert(value)

        collect("", file)
        file.visititems(collect)
    return values


def flatten(value, name=""):
    """Returns the values of nested tables and lists by their path; a list of numbers is one array."""
    if isinstance(value, dict):
        parts = [(f"{name}.{key}" if name else key, part) for key, part in value.items()]
    elif isinstance(value, list) and not all(is_number(part) for part in value):
        parts = [(f"{name}[{i}]", part) for i, part in enumerate(value)]
        if not parts:
            return {name: "[]"}
    elif isinstance(value, list):
        return {name: numpy.array([math.nan if part is None else part for part in value], float)}
    else:
        return {name: value}
    return {key: one for path, part in parts for key, one in flatten(part, path).items()}


def is_number(value):
    return value is None or isinstance(value, (int, float)) and not isinstance(value, bool)


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return flatten(json.load(file))


def read_toml(path):
    with open(path, "rb") as file:
        return flatten(tomllib.load(file))


def read_csv(path):
    """Returns the columns of a table by their names; a column that is not numeric is text."""
    with open(path, newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    columns = {}
    for i, name in enumerate(head):
        cells = [row[i] if i < len(row) else "" for row in rows]
        try:
            columns[name] = numpy.array([math.nan if cell == "" else float(cell) for cell in cells])
        except ValueError:
            columns[name] = "\n".join(cells)
    return columns


def read_bytes(path):
    with open(path, "rb") as file:
        return {"bytes": file.read().hex()}


READERS = {".tif": read_tiff, ".h5": read_hdf5, ".json": read_json, ".toml": read_toml, ".csv": read_csv}


def compare_arrays(old, new):
    """Returns largest absolute and relative difference and a text, or None if all bits are equal (NaN equals NaN).

    Values of different sign that are zero differ by 0. A number instead of NaN, or the reverse, differs by infinity."""
    if old.shape != new.shape:
        return math.nan, math.nan, f"shape {old.shape} -> {new.shape}"
    if old.dtype != new.dtype:
        return math.nan, math.nan, f"{old.dtype} -> {new.dtype}"
    if old.dtype.kind not in "biuf":
        return None if old.tobytes() == new.tobytes() else (math.nan, math.nan, f"{old.dtype} differs")
    equal = old == new
    if old.dtype.kind == "f":
        equal = (equal & (numpy.signbit(old) == numpy.signbit(new))) | (numpy.isnan(old) & numpy.isnan(new))
    if equal.all():
        return None
    a, b = old[~equal].astype(float), new[~equal].astype(float)
    with numpy.errstate(invalid="ignore", divide="ignore"):
        absolute = numpy.abs(a - b)
        relative = absolute / numpy.maximum(numpy.abs(a), numpy.abs(b))
    relative[absolute == 0] = 0.0
    absolute[numpy.isnan(absolute)] = relative[numpy.isnan(relative)] = math.inf
    worst = numpy.argmax(absolute)
    return absolute.max(), relative.max(), f"{a[worst]:.9g} -> {b[worst]:.9g} ({(~equal).sum()} of {equal.size})"


def compare_values(old, new):
    """Like compare_arrays, for arrays, numbers and texts."""
    if isinstance(old, (numpy.ndarray, numpy.generic)) and isinstance(new, (numpy.ndarray, numpy.generic)):
        return compare_arrays(numpy.asarray(old), numpy.asarray(new))
    if is_number(old) and is_number(new) and type(old) is type(new) and old is not None:
        return compare_arrays(numpy.asarray(old), numpy.asarray(new))
    a, b = (PROGRAM_VERSION.sub("VERSION", str(value)) for value in (old, new))
    if a == b:
        return None
    at = len(os.path.commonprefix([a, b]))
    return math.nan, math.nan, f'"{a[max(at - 8, 0):at + 24]}" -> "{b[max(at - 8, 0):at + 24]}"'


def compare_contents(file, old, new):
    """Returns the differences between two tables of values by name."""
    differences = []
    for name in sorted(old.keys() | new.keys()):
        if UNCOMPARED.fullmatch(name):
            continue
        if name not in old or name not in new:
            found = math.nan, math.nan, "only new" if name in new else "only old"
        else:
            found = compare_values(old[name], new[name])
        if found:
            differences.append(Difference(file, name, *found))
    return differences


def list_files(folder):
    return {os.path.relpath(os.path.join(at, name), folder) for at, _, files in os.walk(folder) for name in files}


def compare_folders(old, new):
    """Returns the differences between all files of two folders."""
    differences = []
    files = list_files(old), list_files(new)
    for file in sorted(files[0] | files[1]):
        if file not in files[0] or file not in files[1]:
            text = "only new" if file in files[1] else "only old"
            differences.append(Difference(file, "", math.nan, math.nan, text))
            continue
        read = READERS.get(os.path.splitext(file)[1], read_bytes)
        differences += compare_contents(file, read(os.path.join(old, file)), read(os.path.join(new, file)))
    return differences


def summarize(differences):
    """Combines differences of (setup, difference) that concern one dataset; indices of lists become []."""
    rows = {}
    for setup, one in differences:
        key = one.file, re.sub(r"\[\d+\]", "[]", one.dataset)
        rows.setdefault(key, []).append((setup, one))
    table = []
    for (file, dataset), found in rows.items():
        setup, worst = max(found, key=lambda pair: (pair[1].absolute == pair[1].absolute, pair[1].absolute))
        relative = max((one.relative for _, one in found), key=lambda value: (value == value, value))
        number = len({name for name, _ in found})
        table.append((file, dataset, number, worst.absolute, relative, f"{setup}: {worst.text}"))
    return table
