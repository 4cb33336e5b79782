"""What each key of the case language measures, so that a case can be told in other units of length, mass and time.

A new key that holds a number joins with one line here; selftest.py compares the lines with the schema of the case language.
"""

# key: exponents of length, mass, time
DIMENSIONS = {
    "gravity": (1, 0, -2),
    "time.duration": (0, 0, 1), "time.step": (0, 0, 1), "time.sleep_tolerance": (0, 0, 0),
    "domain.min": (1, 0, 0), "domain.max": (1, 0, 0),
    "fluid.density": (-3, 1, 0), "fluid.viscosity": (-1, 1, -1), "fluid.velocity": (1, 0, -1),
    "shapes.*.cell_size": (1, 0, 0), "shapes.*.sphere.radius": (1, 0, 0),
    "materials.*.density": (-3, 1, 0), "materials.*.young": (-1, 1, -2),
    "pairs.*.stiffness": (0, 1, -2), "pairs.*.restitution_speed": (1, 0, -1), "pairs.*.contact_radius": (1, 0, 0),
    "pairs.*.layer_modulus": (-1, 1, -2),
    "pairs.*.modulus": (-1, 1, -2),
    "pairs.*.pull_off": (1, 1, -2), "pairs.*.adhesion": (0, 1, -2), "pairs.*.adhesion_range": (1, 0, 0), "pairs.*.separation_energy": (2, 1, -2),
    "pairs.*.surface_tension": (0, 1, -2), "pairs.*.contact_angle": (0, 0, 0), "pairs.*.bridge_volume": (3, 0, 0),
    "contact.margin": (1, 0, 0), "contact.margin_ratio": (0, 0, 0), "contact.impact_speed": (1, 0, -1),
    "bodies.*.position": (1, 0, 0), "bodies.*.velocity": (1, 0, -1), "bodies.*.angular_velocity": (0, 0, -1),
    "bodies.*.force": (1, 1, -2),
    "bonds.*.young": (-1, 1, -2), "bonds.*.tension": (-1, 1, -2), "bonds.*.cohesion": (-1, 1, -2), "bonds.*.fracture_energy": (0, 1, -2),
    "bonds.*.friction_angle": (0, 0, 0), "bonds.*.distance": (1, 0, 0),
    "populations.*.mass": (0, 1, 0), "populations.*.velocity": (1, 0, -1), "populations.*.angular_velocity": (0, 0, -1),
    "populations.*.size": (1, 0, 0), "populations.*.size.diameter": (1, 0, 0), "populations.*.size.mean": (1, 0, 0),
    "populations.*.size.median": (1, 0, 0), "populations.*.size.scale": (1, 0, 0), "populations.*.size.min": (1, 0, 0),
    "populations.*.size.max": (1, 0, 0),
    "populations.*.region.box": (1, 0, 0), "populations.*.region.cylinder.start": (1, 0, 0), "populations.*.region.cylinder.end": (1, 0, 0),
    "populations.*.region.cylinder.radius": (1, 0, 0), "populations.*.region.sphere.centre": (1, 0, 0),
    "populations.*.region.sphere.radius": (1, 0, 0),
    "start.leave_out.box": (1, 0, 0), "start.leave_out.cylinder.start": (1, 0, 0), "start.leave_out.cylinder.end": (1, 0, 0),
    "start.leave_out.cylinder.radius": (1, 0, 0), "start.leave_out.sphere.centre": (1, 0, 0), "start.leave_out.sphere.radius": (1, 0, 0),
    "inlets.*.size": (1, 0, 0), "inlets.*.size.diameter": (1, 0, 0), "inlets.*.size.mean": (1, 0, 0),
    "inlets.*.size.median": (1, 0, 0), "inlets.*.size.scale": (1, 0, 0), "inlets.*.size.min": (1, 0, 0),
    "inlets.*.size.max": (1, 0, 0), "inlets.*.region.box": (1, 0, 0), "inlets.*.region.cylinder.start": (1, 0, 0),
    "inlets.*.region.cylinder.end": (1, 0, 0), "inlets.*.region.cylinder.radius": (1, 0, 0), "inlets.*.region.sphere.centre": (1, 0, 0),
    "inlets.*.region.sphere.radius": (1, 0, 0), "outlets.*.region.box": (1, 0, 0), "outlets.*.region.cylinder.start": (1, 0, 0),
    "outlets.*.region.cylinder.end": (1, 0, 0), "outlets.*.region.cylinder.radius": (1, 0, 0), "outlets.*.region.sphere.centre": (1, 0, 0),
    "outlets.*.region.sphere.radius": (1, 0, 0), "inlets.*.velocity": (1, 0, -1), "inlets.*.angular_velocity": (0, 0, -1),
    "inlets.*.rate": (0, 1, -1), "inlets.*.rate.time": (0, 0, 1), "inlets.*.rate.rate": (0, 1, -1),
    "inlets.*.number_rate": (0, 0, -1), "inlets.*.number_rate.time": (0, 0, 1), "inlets.*.number_rate.rate": (0, 0, -1),
    "inlets.*.start": (0, 0, 1), "inlets.*.stop": (0, 0, 1), "inlets.*.limit": (0, 1, 0),
    "walls.*.wear.coefficient": (1, -1, 2), "walls.*.wear.every": (0, 0, 1), "walls.*.cell_size": (1, 0, 0), "walls.*.triangle_size": (1, 0, 0), "walls.*.position": (1, 0, 0),
    "walls.*.motion.oscillate.amplitude": (1, 0, 0), "walls.*.motion.oscillate.frequency": (0, 0, -1),
    "walls.*.motion.rotate.centre": (1, 0, 0), "walls.*.motion.rotate.rate": (0, 0, -1),
    "walls.*.motion.start": (0, 0, 1), "walls.*.motion.stop": (0, 0, 1),
    "walls.*.motion.table.time": (0, 0, 1), "walls.*.motion.table.position": (1, 0, 0), "walls.*.motion.translate.velocity": (1, 0, -1),
    "walls.*.motion.servo.centre": (1, 0, 0), "walls.*.motion.servo.force": (1, 1, -2), "walls.*.motion.servo.stress": (-1, 1, -2),
    "walls.*.motion.servo.area": (2, 0, 0), "walls.*.motion.servo.torque": (2, 1, -2), "walls.*.motion.servo.max_speed": (1, 0, -1),
    "walls.*.motion.servo.max_rate": (0, 0, -1), "walls.*.motion.servo.stroke": (1, 0, 0),
    "walls.*.motion.outer.centre": (1, 0, 0), "walls.*.motion.outer.max_speed": (1, 0, -1), "walls.*.motion.outer.max_rate": (0, 0, -1),
    "walls.*.motion.outer.stroke": (1, 0, 0),
    "walls.*.motion.free.centre": (1, 0, 0), "walls.*.motion.free.mass": (0, 1, 0), "walls.*.motion.free.inertia": (2, 1, 0),
    "walls.*.motion.free.mass_centre": (1, 0, 0), "walls.*.motion.free.force": (1, 1, -2), "walls.*.motion.free.torque": (2, 1, -2),
    "walls.*.motion.free.damping": (0, 1, -1), "walls.*.motion.free.turn_damping": (2, 1, -1), "walls.*.motion.free.stroke": (1, 0, 0),
    "walls.*.motion.motor.centre": (1, 0, 0), "walls.*.motion.motor.torque": (2, 1, -2), "walls.*.motion.motor.inertia": (2, 1, 0),
    "walls.*.motion.motor.max_rate": (0, 0, -1),
    "walls.*.surface.velocity": (1, 0, -1), "walls.*.surface.rate": (0, 0, -1), "walls.*.surface.centre": (1, 0, 0),
    "walls.*.surface.start": (0, 0, 1), "walls.*.surface.stop": (0, 0, 1),
    "walls.*.shape.box.corners": (1, 0, 0), "walls.*.shape.box_inside": (1, 0, 0),
    "walls.*.shape.cone.start": (1, 0, 0), "walls.*.shape.cone.end": (1, 0, 0), "walls.*.shape.cone.radius_start": (1, 0, 0),
    "walls.*.shape.cone.radius_end": (1, 0, 0),
    "walls.*.shape.cylinder.start": (1, 0, 0), "walls.*.shape.cylinder.end": (1, 0, 0), "walls.*.shape.cylinder.radius": (1, 0, 0),
    "walls.*.shape.cylinder_inside.start": (1, 0, 0), "walls.*.shape.cylinder_inside.end": (1, 0, 0),
    "walls.*.shape.cylinder_inside.radius": (1, 0, 0),
    "walls.*.shape.disc.centre": (1, 0, 0), "walls.*.shape.disc.radius": (1, 0, 0), "walls.*.shape.disc.hole": (1, 0, 0),
    "walls.*.shape.drum.start": (1, 0, 0), "walls.*.shape.drum.end": (1, 0, 0), "walls.*.shape.drum.radius": (1, 0, 0),
    "walls.*.shape.drum.lifters.height": (1, 0, 0), "walls.*.shape.drum.lifters.width": (1, 0, 0),
    "walls.*.shape.drum.lifters.top_width": (1, 0, 0),
    "walls.*.shape.trough.start": (1, 0, 0), "walls.*.shape.trough.end": (1, 0, 0), "walls.*.shape.trough.radius": (1, 0, 0),
    "walls.*.shape.trough.height": (1, 0, 0),
    "walls.*.shape.screw.start": (1, 0, 0), "walls.*.shape.screw.end": (1, 0, 0), "walls.*.shape.screw.radius": (1, 0, 0),
    "walls.*.shape.screw.shaft": (1, 0, 0), "walls.*.shape.screw.pitch": (1, 0, 0), "walls.*.shape.screw.thickness": (1, 0, 0),
    "walls.*.shape.paddles.start": (1, 0, 0), "walls.*.shape.paddles.end": (1, 0, 0), "walls.*.shape.paddles.radius": (1, 0, 0),
    "walls.*.shape.paddles.shaft": (1, 0, 0), "walls.*.shape.paddles.width": (1, 0, 0), "walls.*.shape.paddles.thickness": (1, 0, 0),
    "walls.*.shape.hopper.outlet": (1, 0, 0), "walls.*.shape.hopper.bin": (1, 0, 0), "walls.*.shape.hopper.funnel_height": (1, 0, 0),
    "walls.*.shape.hopper.bin_height": (1, 0, 0), "walls.*.shape.hopper.stub": (1, 0, 0),
    "walls.*.shape.plane.point": (1, 0, 0),
    "walls.*.shape.plate.corner": (1, 0, 0), "walls.*.shape.plate.side_a": (1, 0, 0), "walls.*.shape.plate.side_b": (1, 0, 0),
    "walls.*.shape.sphere_inside.centre": (1, 0, 0), "walls.*.shape.sphere_inside.radius": (1, 0, 0),
    **{f"cell.strain_rate.{part}": (0, 0, -1) for part in ("x", "y", "z", "yz", "xz", "xy")},
    **{f"cell.stress.{part}": (-1, 1, -2) for part in ("x", "y", "z", "yz", "xz", "xy")},
    **{f"cell.strain_rate.{part}.{key}": (0, 0, power) for part in ("x", "y", "z", "yz", "xz", "xy") for key, power in (("time", 1), ("rate", -1))},
    "output.every": (0, 0, 1), "output.checkpoint": (0, 0, 1),
    # temperatures keep their unit
    "materials.*.heat_capacity": (2, 0, -2), "materials.*.conductivity": (1, 1, -3), "materials.*.real_young": (-1, 1, -2),
    "pairs.*.contact_conductance": (0, 1, -3), "bodies.*.heat_source": (2, 1, -3), "populations.*.heat_source": (2, 1, -3),
    "bodies.*.heat_source.time": (0, 0, 1), "bodies.*.heat_source.power": (2, 1, -3), "populations.*.heat_source.time": (0, 0, 1),
    "populations.*.heat_source.power": (2, 1, -3), "walls.*.heat_flux.time": (0, 0, 1), "walls.*.heat_flux.power": (2, 1, -3),
    "walls.*.temperature.time": (0, 0, 1), "walls.*.exchange.temperature.time": (0, 0, 1),
    "walls.*.heat_flux": (2, 1, -3), "heat.gas_conductivity": (1, 1, -3), "heat.gas_range": (1, 0, 0), "walls.*.exchange.coefficient": (0, 1, -3),
}

# numbers that are the same in all units
PLAIN = {
    "seed", "start.checkpoint", "start.frame", "time.steps_per_contact", "contact.barrier", "materials.*.poisson",
    "pairs.*.restitution", "pairs.*.plasticity", "pairs.*.adhesive_ratio", "pairs.*.friction", "pairs.*.friction_sliding", "pairs.*.tangential_ratio", "pairs.*.tangential_damping",
    "pairs.*.rolling_friction", "pairs.*.torsional_friction",
    "bodies.*.orientation", "bodies.*.scale", "bonds.*.tangential_ratio", "bonds.*.damping", "bonds.*.strength_scatter.weibull_modulus",
    "populations.*.count", "populations.*.jitter", "populations.*.solid_fraction", "populations.*.orientation",
    "populations.*.orientation.align", "populations.*.orientation.axis", "populations.*.orientation.scatter",
    "populations.*.size.exponent", "populations.*.size.passing", "populations.*.size.shape", "populations.*.shapes.*",
    "populations.*.size.sigma",   # of a normal distribution a length: see units_of
    "inlets.*.count", "inlets.*.orientation", "inlets.*.orientation.align", "inlets.*.orientation.axis", "inlets.*.orientation.scatter",
    "inlets.*.size.exponent", "inlets.*.size.passing", "inlets.*.size.shape", "inlets.*.shapes.*", "inlets.*.size.sigma",
    "walls.*.orientation", "walls.*.scale", "walls.*.motion.oscillate.direction", "walls.*.motion.oscillate.phase", "walls.*.motion.rotate.axis", "walls.*.surface.axis",
    "walls.*.motion.servo.direction", "walls.*.motion.servo.axis", "walls.*.motion.servo.share", "walls.*.motion.servo.swing",
    "walls.*.motion.outer.direction", "walls.*.motion.outer.axis", "walls.*.motion.outer.swing",
    "walls.*.motion.free.guide", "walls.*.motion.free.hinge", "walls.*.motion.free.swing", "walls.*.motion.motor.axis",
    "walls.*.shape.plane.normal", "walls.*.shape.disc.normal", "walls.*.shape.hopper.half_angle",
    "shapes.*.pieces.cells", "shapes.*.pieces.seed",
    "walls.*.shape.disc.segments", "walls.*.shape.cone.segments", "walls.*.shape.cylinder.segments", "walls.*.shape.drum.segments",
    "walls.*.shape.trough.segments", "walls.*.shape.screw.segments", "walls.*.shape.screw.starts", "walls.*.shape.paddles.segments",
    "walls.*.shape.paddles.count", "walls.*.shape.paddles.angle", "walls.*.shape.paddles.turn",
    "walls.*.shape.hopper.segments", "walls.*.shape.drum.lifters.count",
    "cell.stop_when.strain", "cell.stop_when.stress_error", "cell.stop_when.kinetic_ratio",
    "heat.temperature", "bodies.*.temperature", "populations.*.temperature", "inlets.*.temperature", "walls.*.temperature",
    "walls.*.exchange.temperature", "walls.*.temperature.temperature", "walls.*.exchange.temperature.temperature",
}


def in_other_units(words, length, mass, time):
    """The words of a case with every number multiplied by what its unit becomes."""
    return converted(words, "", (length, mass, time))


def converted(value, key, units):
    if isinstance(value, dict):
        named = key in ("shapes", "materials", "populations.*.shapes", "inlets.*.shapes")
        result = {name: converted(entry, f"{key}.*" if named else f"{key}.{name}" if key else name, units) for name, entry in value.items()}
        if key in ("populations.*.size", "inlets.*.size") and value.get("distribution") == "normal":
            result["sigma"] = value["sigma"] * units[0]
        return result
    if isinstance(value, list):
        tables = key in ("bodies", "walls", "populations", "pairs", "inlets", "outlets", "bonds")
        return [converted(entry, f"{key}.*" if tables else key, units) for entry in value]
    if isinstance(value, (str, bool)) or key in PLAIN:
        return value
    return value * factor(DIMENSIONS[key], units)


def factor(exponents, units):
    result = 1.0
    for exponent, unit in zip(exponents, units):
        result *= unit ** exponent
    return result
