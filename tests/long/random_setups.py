"""Draws small random setups of all kinds: BOS, PIV with one or two cameras, calibration.

Words such as methods and kinds of fields are those that the programs under test offer (`gladstone keys`), so that a new
one is drawn without a change here; a new kind of density or velocity field needs its parameters."""

import json
import math
import os

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FIELDS = os.path.join(ROOT, "data/fields")
LENSES = os.path.join(ROOT, "data/lenses")

GLADSTONE_DALE = 2.26e-4  # [m^3/kg]
# Focal length [mm], f-numbers, and object distance from the first vertex [mm] of a lens that requires one.
PRESCRIPTIONS = {
    "achromat.toml": (210.9, [8, 16], None),
    "double_gauss.toml": (100.0, [5.6, 8], None),
    "double_gauss_patent.toml": (100.5, [5.6, 11], None),
    "wide_angle.toml": (28.0, [5.6, 11], None),
    "telecentric.toml": (180.0, [None], 1160.0),
}
CORRELATIONS = ("scc", "rpc", "spc", "zncc", "mqd")  # methods with a correlation plane


def write_value(value):
    """Returns a value in TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {write_value(one)}" for key, one in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(write_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def write_setup(setup, path=""):
    """Returns a setup, a dict of dicts, in TOML."""
    lines = [f"{key} = {write_value(value)}" for key, value in setup.items() if not isinstance(value, dict)]
    for key, value in setup.items():
        if isinstance(value, dict):
            name = f"{path}.{key}" if path else key
            lines += ["", f"[{name}]", write_setup(value, name)]
    return "\n".join(lines)


def short(value):
    """Rounds to four digits, so that setups are readable."""
    return float(f"{value:.4g}")


class Draw:
    """Random choices of one setup. `offers` maps keys to the words that both programs accept."""

    def __init__(self, rng, offers, inputs):
        self.rng, self.offers, self.inputs = rng, offers, inputs

    def chance(self, probability):
        return self.rng.random() < probability

    def pick(self, values):
        return self.rng.choice(values)

    def number(self, low, high):
        return short(self.rng.uniform(low, high))

    def log(self, low, high):
        return short(math.exp(self.rng.uniform(math.log(low), math.log(high))))

    def word(self, key, excluded=()):
        return self.pick([word for word in self.offers[key] if word not in excluded])

    def write_input(self, name, content):
        """Writes a file that the setup names, and returns its path."""
        path = os.path.join(self.inputs, name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path


def draw_lens(draw, thin_only=False):
    """Returns the table [lens], the focal length [mm], and the required object distance [mm] or None."""
    lens, required = {}, None
    if thin_only or draw.chance(0.7):
        focal = draw.pick([50.0, 85.0, 105.0, 200.0])
        lens.update(focal_length_mm=focal, f_number=draw.pick([4, 5.6, 8, 11, 16, 22]))
        lens["psf"] = draw.word("lens.psf") if draw.chance(0.3) else "gaussian"
    else:
        name = draw.pick(sorted(PRESCRIPTIONS))
        focal, f_numbers, required = PRESCRIPTIONS[name]
        lens.update(model="prescription", file=os.path.join(LENSES, name))
        f_number = draw.pick(f_numbers)
        if f_number:
            lens["f_number"] = f_number
        if draw.chance(0.3):
            lens["transmittance"] = draw.word("lens.transmittance")
    return lens, focal, required


def draw_camera(draw, least=64, most=128):
    """Returns the table [camera] without its pose: sensor size, bit depth, noise, background."""
    camera = {"pixels": [draw.rng.randrange(least, most + 1, 8) for _ in range(2)],
              "pixel_pitch_um": draw.number(5, 11), "bit_depth": draw.pick([8, 10, 12, 16]),
              "offset_dn": draw.pick([0, 8, 20])}
    if draw.chance(0.5):
        camera["noise"] = {"full_well_e": draw.log(2000, 50000), "read_noise_e": draw.number(0, 8),
                           "seed": draw.rng.randrange(1000)}
        for key, value in (("dark_current_e", draw.number(0, 50)), ("prnu_percent", draw.number(0, 2)),
                           ("dsnu_e", draw.number(0, 5)), ("hot_pixel_share", draw.log(1e-4, 1e-2)),
                           ("shot_noise", False), ("quantum_efficiency", draw.number(0.3, 0.9))):
            if draw.chance(0.25):
                camera["noise"][key] = value
        if draw.chance(0.2):
            camera["background"] = {"level_e": short(0.05 * camera["noise"]["full_well_e"])}
    return camera


def draw_elements(draw, z_a, z_d):
    """Returns windows and wedges on either side of the medium; z_d is None if there is no target behind it."""
    elements = []
    for side, z in (("camera", 0.5 * z_a), ("target", None if z_d is None else -0.6 * z_d)):
        if z is None or not draw.chance(0.12):
            continue
        kind = draw.word("element.kind", excluded=("lenslets",))
        element = {"kind": kind, "side": side, "thickness_mm": draw.number(3, 8), "position_mm": [0.0, 0.0, short(z)],
                   "tilt_deg": [draw.number(-8, 8), draw.number(-8, 8)], "glass": draw.pick(["N-BK7", "SCHOTT:F5"])}
        if kind == "wedge":
            element["wedge_deg"] = [draw.number(-0.3, 0.3), draw.number(-0.3, 0.3)]
        elements.append(element)
    return elements


def draw_density(draw, kind, gradient, view, deepest):
    """Returns [medium.field] with about this gradient [kg/m^4].

    @param view    width that the camera sees in the medium [mm]
    @param deepest largest radius of a plume or blob [mm]
    """
    sign, radius = draw.pick([-1, 1]), short(min(draw.number(0.15, 0.4) * view, deepest))
    wave = draw.number(0.3, 2) * view
    files = {
        "hbdt512_late_slice.h5": {"spacing_mm": [0.0625] * 3, "extrude": True},
        "hbdt512_kepeak_slice.h5": {"spacing_mm": [0.0625] * 3, "extrude": True},
        "hbdt512_kepeak_slab128.h5": {"spacing_mm": [0.25] * 3},
    }
    name = draw.pick(sorted(files))
    bump = {"amplitude_kg_m3": short(sign * min(0.6, gradient * radius * 1e-3)), "radius_mm": radius}
    parameters = {
        "none": {},
        "uniform_gradient": {"gradient_kg_m4": [short(min(gradient, 500 / view)), draw.number(-20, 20), 0.0]},
        "sinusoid": {"amplitude_kg_m3": short(min(0.6, gradient * wave * 1e-3 / (2 * math.pi))), "wavelength_mm": wave,
                     "direction": [draw.number(-1, 1), 1.0], "phase_rad": draw.number(0, 6)},
        "gaussian_plume": bump,
        "gaussian_blob": bump,
        "normal_shock": {"mach": draw.number(1.02, 1.2), "upstream_density_kg_m3": draw.number(0.6, 1.2),
                         "shock_thickness_mm": short(draw.number(0.2, 0.5) * view), "tilt_deg": draw.number(-4, 4),
                         "position_mm": short(draw.number(-0.2, 0.2) * view)},
        "file": {"file": os.path.join(FIELDS, name), "dataset": "Density_0001", "quantity": "density", "scale": 1.225,
                 "periodic": [True, True, False], **files[name]},
    }  # fmt: skip
    if kind not in parameters:
        raise KeyError(f'random_setups.py has no parameters for density fields of kind "{kind}"; add them')
    return {"kind": kind, **parameters[kind]}


def draw_medium(draw, field):
    medium = {"field": field}
    if draw.chance(0.2):
        medium["gladstone_dale"] = draw.pick(["ciddor", "merzkirch", 2.3e-4])
    elif draw.chance(0.15):
        medium["gas"] = {"air": 0.75, draw.pick(["helium", "argon", "carbon_dioxide"]): 0.25}
    if draw.chance(0.3):
        medium["integrator"] = draw.word("medium.integrator")
    if draw.chance(0.2):
        medium["step_mm"] = draw.number(0.5, 2)
    if field["kind"] == "file":
        medium["interpolation"] = draw.word("medium.interpolation")
        if "extrude" not in field and draw.chance(0.3):
            medium["faces"] = draw.word("medium.faces")
    return medium


def draw_correlation(draw, pixels, bits):
    """Returns the table [correlate] for frames of this size."""
    method = draw.word("correlate.method") if draw.chance(0.6) else "scc"
    windows = draw.pick([[32, 16], [32, 24], [24, 16], [32], [24], [48, 24, 16]])
    correlate = {"window_px": windows, "overlap": draw.pick([0.0, 0.5, 0.6, 0.75]), "method": method}
    choices = [("subpixel", draw.word("correlate.subpixel")), ("weighting", draw.word("correlate.weighting")),
               ("deformation", draw.word("correlate.deformation")), ("final_passes", draw.pick([1, 2, 3])),
               ("steep_passes", draw.pick([0, 2])), ("replace", False), ("median_threshold", "off"),
               ("max_displacement_px", 6.0)]
    if method in CORRELATIONS:
        choices.append(("uncertainty", draw.word("correlate.uncertainty")))
    correlate.update({key: value for key, value in choices if draw.chance(0.35)})
    if method == "tracking" and draw.chance(0.5):
        correlate["tracking"] = {"output": draw.word("correlate.tracking.output"),
                                 "shape": draw.word("correlate.tracking.shape")}
    columns, rows = pixels
    if draw.chance(0.25):
        kind = draw.word("correlate.mask.kind")
        masks = {
            "polygon": {"x_px": [5.0, short(columns / 3), 5.0], "y_px": [5.0, 5.0, short(rows / 3)]},
            "intensity": {"above_dn": short(0.85 * 2**bits), "blur_px": 1.0},
            "image": {"file": draw.write_input("mask.pgm", b"P5\n%d %d\n255\n" % (columns, rows) + b"".join(
                (bytes(columns) if row < 12 else b"\xff" * columns) for row in range(rows)))},
        }  # fmt: skip
        correlate["mask"] = [{"kind": kind, **masks.get(kind, {})}]
    if draw.chance(0.25):
        kind = draw.word("correlate.preprocess.kind", excluded=("background",))
        correlate["preprocess"] = [{"kind": kind}]
    return correlate


def draw_rays(draw, methods):
    render = {"seed": draw.rng.randrange(1000), "method": draw.pick(methods)}
    render["rays_per_dot"] = draw.pick([16, 32, 64]) if draw.chance(0.9) else "auto"
    if render["method"] in ("auto", "rays") and draw.chance(0.15):
        render["sampling"] = draw.word("render.sampling")
    return render


def draw_target(draw, width):
    """Returns the table [target]; width [mm] is the larger side of the view at the dots."""
    kind = draw.word("target.kind") if draw.chance(0.5) else "dots"
    target = {"kind": kind, "seed": draw.rng.randrange(1000), "dots_per_32px_window": draw.number(5, 14),
              "dot_diameter_px": draw.number(1.5, 3.5), "polarity": draw.word("target.polarity")}
    if kind == "points":
        points = (f"{draw.number(-0.6, 0.6) * width:.6g},{draw.number(-0.6, 0.6) * width:.6g}" for _ in range(150))
        target["file"] = draw.write_input("points.csv", "x_mm,y_mm\n" + "\n".join(dict.fromkeys(points)) + "\n")
        del target["dots_per_32px_window"], target["seed"]
    elif kind == "image":
        grey = bytes(draw.rng.choices([0, 60, 255], [6, 1, 1], k=48 * 48))
        target = {"kind": kind, "file": draw.write_input("target.pgm", b"P5\n48 48\n255\n" + grey),
                  "extent_mm": [short(1.4 * width)] * 2}
    elif kind == "dots" and draw.chance(0.2):
        target["arrangement"] = draw.word("target.arrangement")
    return target


def draw_bos(draw):
    camera = draw_camera(draw)
    oblique = draw.chance(0.1)
    lens, focal, required = draw_lens(draw, thin_only=oblique)
    total = required or short(focal * draw.number(5.5, 9))
    z_d = short(draw.number(0.2, 0.45) * total)
    z_a = short(total - z_d)
    magnification = 0.2 if required else focal / (total - focal)
    width = max(camera["pixels"]) * camera["pixel_pitch_um"] * 1e-3 / magnification
    view = width * (1.0 if required else z_a / total)
    kind = draw.word("medium.field.kind")
    # Deflection in a medium of 10 mm that displaces the image by 0.2 to 3 px.
    angle = draw.log(0.2, 3) * camera["pixel_pitch_um"] * 1e-6 / (magnification * z_d * 1e-3)
    field = draw_density(draw, kind, angle / (GLADSTONE_DALE * 0.01), view, z_d / 6)
    plain = not oblique and "model" not in lens
    geometry = {("z_front_mm" if required else "z_a_mm"): z_a, "z_d_mm": z_d}
    if oblique:
        turn = math.radians(draw.number(3, 15))
        camera["pose"] = {"position_mm": [short(z_a * math.sin(turn)), 0.0, short(z_a * math.cos(turn))]}
        del geometry["z_a_mm"]
    elif plain and draw.chance(0.15):
        camera["sensor"] = {"distortion": [draw.number(-0.2, 0.2), 0.0, 0.0, 0.0]}
        plain = False
    elements = [] if required else draw_elements(draw, z_a, z_d)
    if not required and draw.chance(0.1):
        lens["focus"], plain = "medium", False
    target = draw_target(draw, width)
    plain = plain and not elements and target["kind"] != "image"
    setup = {"experiment": "bos", "camera": camera, "lens": lens, "geometry": geometry,
             "medium": draw_medium(draw, field), "target": target,
             "render": draw_rays(draw, [m for m in draw.offers["render.method"]
                                        if m != "formula" and (plain or m != "focused_dots")]),
             "correlate": draw_correlation(draw, camera["pixels"], camera["bit_depth"])}
    return ({"element": elements} if elements else {}) | setup


def draw_flow(draw, kind, step, view):
    """Returns [flow] that moves particles by about `step` [mm] between the pulses, in a view of this width [mm]."""
    dt_us = draw.pick([5.0, 10.0, 50.0])
    speed = short(step * 1e-3 / (dt_us * 1e-6))  # [m/s]
    rate = short(speed / (0.5e-3 * view))
    core = short(view / 4)
    parameters = {
        "uniform": {"velocity_m_s": [speed, draw.number(-0.5, 0.5) * speed, draw.pick([0.0, 0.3]) * speed]},
        "shear": {"rate_1_s": rate},
        "stagnation": {"rate_1_s": rate},
        "rotation": {"rate_rad_s": rate},
        "lamb_oseen": {"circulation_m2_s": short(2 * math.pi * core * 1e-3 * speed), "core_radius_mm": core},
        "rankine": {"circulation_m2_s": short(2 * math.pi * core * 1e-3 * speed), "core_radius_mm": core},
        "taylor_green": {"amplitude_m_s": speed, "wavelength_mm": short(view)},
        "jet": {"peak_m_s": speed, "half_width_mm": core, "direction": [1.0, draw.number(-1, 1)]},
        "normal_shock": {"velocity_m_s": [0.0, speed, 0.0]},
    }
    if kind == "file":
        spacing = short(view / 8)
        values = "".join(f"{(x - 15) * spacing:.6g},{(y - 15) * spacing:.6g},{(z - 15) * spacing:.6g},"
                         f"{speed * math.cos(x / 5):.6g},{speed * math.sin(y / 5):.6g},0\n"
                         for z in range(31) for y in range(31) for x in range(31))
        parameters["file"] = {"file": draw.write_input("flow.csv", "x_mm,y_mm,z_mm,u_m_s,v_m_s,w_m_s\n" + values)}
    if kind not in parameters:
        raise KeyError(f'random_setups.py has no parameters for flows of kind "{kind}"; add them')
    return {"kind": kind, "dt_us": dt_us, **parameters[kind]}


def draw_particles(draw, scattering, width, height, depth):
    particles = {"per_pixel": draw.number(0.01, 0.03), "volume_mm": [short(width), short(height), short(depth)],
                 "scattering": scattering, "seed": draw.rng.randrange(1000)}
    distribution = draw.pick([None, "lognormal", "normal"])
    if distribution == "lognormal":
        particles["diameter_um"] = {"kind": distribution, "median_um": draw.number(0.5, 2), "sigma": 0.2}
    elif distribution == "normal":
        particles["diameter_um"] = {"kind": distribution, "mean_um": draw.number(1, 2), "std_um": 0.2}
    if scattering == "mie":
        particles["material"] = draw.word("particles.material")
    if draw.chance(0.15):
        particles["density_kg_m3"] = 900.0
    return particles


def draw_piv(draw):
    """Particles in a laser sheet, seen by one camera on the axis, an oblique one, or two."""
    camera = draw_camera(draw, 64, 104)
    scattering = draw.word("particles.scattering")
    ideal = scattering == "gaussian"  # without rays: a thin lens on the axis, no field
    oblique, two = (not ideal and draw.chance(probability) for probability in (0.25, 0.12))
    lens, focal, required = draw_lens(draw, thin_only=oblique or two or ideal)
    if ideal:
        lens["psf"] = "gaussian"
    z_a = required or short(focal * draw.number(5.5, 9))
    magnification = 0.2 if required else focal / (z_a - focal)
    pixel = camera["pixel_pitch_um"] * 1e-3 / magnification  # [mm] in the sheet
    width, height = (short(1.3 * pixel * count) for count in camera["pixels"])
    view, depth = max(width, height), draw.number(0.5, 2)
    turn = math.radians(draw.number(15, 35)) if oblique or two else 0.0
    particles = draw_particles(draw, scattering, width / math.cos(turn), height, depth)
    if draw.chance(0.1):
        camera["exposure"] = "absolute"
    laser = {"thickness_mm": short(depth * draw.number(0.5, 0.9)), "height_mm": short(2 * view),
             "pulse_energy_mj": draw.log(1, 50), "profile": draw.word("laser.profile")}
    if draw.chance(0.2):
        laser["offset_mm"] = [0.0, short(0.1 * depth)]
    kind = draw.word("flow.kind", excluded=("normal_shock",) if ideal else ())
    field = "none"
    if kind == "normal_shock":  # of flow and medium
        field = kind
    elif not ideal and draw.chance(0.5):
        field = draw.word("medium.field.kind")
    density = draw_density(draw, field, draw.log(20, 200), view, z_a / 10)
    valid = ("auto", "formula") if ideal else ("auto", "rays")
    methods = [method for method in draw.offers["render.method"] if method in valid]
    setup = {"experiment": "piv", "camera": camera, "lens": lens, "geometry": {}, "particles": particles,
             "laser": laser, "flow": draw_flow(draw, kind, draw.number(1, 4) * pixel, view),
             "medium": draw_medium(draw, density), "render": draw_rays(draw, methods),
             "correlate": draw_correlation(draw, camera["pixels"], camera["bit_depth"])}
    if oblique or two:
        cameras = []
        for name, side in (("left", -1), ("right", 1)):
            position = [short(side * z_a * math.sin(turn)), 0.0, short(z_a * math.cos(turn))]
            pose = {"pose": {"position_mm": position}, "sensor": {"scheimpflug": "auto"}}
            cameras.append({"name": name, **camera, **pose})
        if two:
            return {key: value for key, value in ({**setup, "camera": cameras}).items() if key != "geometry"}
        setup["camera"] = {key: value for key, value in cameras[0].items() if key != "name"}
        del setup["geometry"]
        return setup
    setup["geometry"] = {("z_front_mm" if required else "z_a_mm"): z_a}
    elements = [] if required or ideal else draw_elements(draw, z_a, None)
    return ({"element": elements} if elements else {}) | setup


def draw_calibration(draw):
    """A grid of dots of some 14 px on three planes."""
    camera = draw_camera(draw, 128, 160)
    camera.pop("background", None)
    focal = draw.pick([25.0, 35.0, 50.0])
    z_a = short(focal * draw.number(6, 9))
    pixel = camera["pixel_pitch_um"] * 1e-3 * (z_a - focal) / focal
    spacing, step = short(draw.number(13, 16) * pixel), short(0.03 * z_a)
    if draw.chance(0.5):
        camera["sensor"] = {"distortion": [draw.number(-0.2, 0.2), 0.0, 0.0, 0.0]}
    extent = short(1.3 * pixel * max(camera["pixels"]))
    return {"experiment": "calibration", "camera": camera, "lens": {"focal_length_mm": focal, "f_number": 11},
            "geometry": {"z_a_mm": z_a},
            "calibration": {"planes_mm": [-step, 0.0, step], "spacing_mm": spacing,
                            "dot_diameter_mm": short(0.4 * spacing), "extent_mm": [extent, extent]},
            "render": {"rays_per_dot": draw.pick([16, 32]), "seed": draw.rng.randrange(1000)}}


def draw_setup(draw):
    """Returns a setup as nested dicts."""
    return draw.rng.choices([draw_bos, draw_piv, draw_calibration], [10, 8, 2])[0](draw)
