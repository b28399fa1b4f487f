"""catalogues.py DATABASE FOLDER: writes the glass catalogues of data/glasses, MAKER.agf, from a copy of the
refractiveindex.info database (https://github.com/polyanskiy/refractiveindex.info-database). Needs PyYAML.

Formulas and coefficients are copied as printed. The internal transmittance is that of 10 mm,
exp(-4 pi k 10 mm / lambda), at the wavelengths of the formula's range and the nearest one on either side of it."""
import math
import pathlib
import sys

import yaml

# folders of database/data/specs; the first line of the catalogue
MAKERS = {
    "schott": (["schott/optical"], "SCHOTT optical glass: the maker's catalogue of 2017-01-20"),
    "ohara": (["ohara/optical"], "OHARA optical glass: the maker's catalogue of 2017-11-30"),
    "hoya": (["hoya/optical"], "HOYA optical glass: the maker's catalogue of 2017-04-01"),
    "hikari": (["hikari/optical", "hikari/CaF", "hikari/SiO2", "hikari/i-line"],
               "HIKARI (NIKON) optical and i-line glass, calcium fluoride, silica: the maker's catalogue of 2017-11"),
    "cdgm": (["cdgm/optical"], "CDGM optical glass: the maker's catalogue of 2022-06"),
    "sumita": (["sumita/optical"], "SUMITA optical glass: the maker's catalogue of 2017-02-02"),
}
SOURCE = ("as collected in the refractiveindex.info database (M. N. Polyanskiy, Sci. Data 11 (2024) 94), "
          "public domain, CC0 1.0")
SELLMEIER = {3: 2, 4: 6, 5: 11}  # number of terms: formula of the AGF format
POWERS = {  # formula of the AGF format: powers of the wavelength
    1: [0, 2, -2, -4, -6, -8],
    10: [0, 2, -2, -4, -6, -8, -10, -12],
    12: [0, 2, -2, -4, -6, -8, 4, 6],
    13: [0, 2, 4, -2, -4, -6, -8, -10, -12],
}


def without_zeros(words):
    """Returns the coefficients without trailing zeros."""
    while words and float(words[-1]) == 0:
        words = words[:-1]
    return words


def dispersion(formula, words):
    """Returns the number of the dispersion formula in the AGF format, and its coefficients; None if the format lacks
    the formula."""
    if formula == "formula 2" and float(words[0]) == 0:  # n^2 - 1 = c1 + sum of B L^2 / (L^2 - C)
        terms = max(3, (len(words) - 1) // 2)
        return (SELLMEIER[terms], words[1:]) if terms in SELLMEIER else None
    if formula == "formula 3":  # n^2 = c1 + sum of c L^power
        given = {0: words[0]}
        for value, power in zip(words[1::2], words[2::2]):
            if float(power) in given:
                return None
            given[float(power)] = value
        for number, powers in POWERS.items():
            if set(given) <= set(powers):
                return number, without_zeros([given.get(power, "0") for power in powers])
    return None


def transmittance(lines, shortest, longest):
    """Lines IT of 10 mm from lines "wavelength [um], extinction coefficient"."""
    table = sorted({float(line[0]): float(line[1]) for line in lines}.items())
    inside = [i for i, (wavelength, _) in enumerate(table) if shortest <= wavelength <= longest]
    if not inside:
        return []
    shown = table[max(inside[0] - 1, 0):inside[-1] + 2]
    return [f"IT {wavelength:g} {share:.6f}".rstrip("0").rstrip(".") + " 10"
            for wavelength, k in shown
            if 0 <= (share := math.exp(-4 * math.pi * k * 1e4 / wavelength)) <= 1]


def glass(path):
    """Lines of a glass; None if the AGF format lacks its formula."""
    page = yaml.safe_load(path.read_text())
    data = {item["type"].split()[0]: item for item in page["DATA"]}
    if "formula" not in data:
        return None
    found = dispersion(data["formula"]["type"], str(data["formula"]["coefficients"]).split())
    if not found:
        return None
    known = page.get("PROPERTIES") or {}
    shortest, longest = str(data["formula"]["wavelength_range"]).split()
    name = path.stem.replace("star", "*")
    lines = [f"NM {name} {found[0]} 0 {known.get('nd', 0)} {known.get('Vd', 0)} 0 0", "CD " + " ".join(found[1]),
             f"LD {shortest} {longest}"]
    if "tabulated" in data:
        table = [line.split() for line in data["tabulated"]["data"].splitlines()]
        lines += transmittance(table, float(shortest), float(longest))
    return lines


def main(database, folder):
    for maker, (folders, title) in MAKERS.items():
        text, count = f"CC {title}\nCC {SOURCE}\n", 0
        pages = [page for name in folders for page in (database / "database/data/specs" / name).glob("*.yml")]
        for page in sorted(pages, key=lambda page: page.stem):
            if page.stem == "about":
                continue
            lines = glass(page)
            if lines:
                text += "\n".join(lines) + "\n"
                count += 1
            else:
                print(f"{maker}: {page.stem} is left out: the AGF format lacks its formula")
        (folder / f"{maker}.agf").write_text(text)
        print(f"{maker}: {count} glasses")


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:]))
