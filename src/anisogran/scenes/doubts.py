"""Is a scene plausible? Groups of its numbers that a mistake in the units (mm, g) puts far outside of what grains are like."""

from anisogran.scenes.keys import keys_of

STIFFNESS = 1e2, 1e7  # over pressure: softer grains overlap by more than a per cent or so, harder ones take ages
DENSITY = 100.0, 2e4  # kg/m3: foam to gold
RADIUS = 1e-6, 0.2  # m: dust to cobbles; grains given in mm are mostly above


def doubts_of(scene):
    """Sentences about what is implausible in a scene, each with key, value and likely cause; none for most scenes.

    Scenes in reduced units, where density and mean diameter are 1, are judged by their stiffness alone; those without a pressure are
    not judged by it.
    """
    doubts = []
    for table, one in keys_of(scene).items() if hasattr(scene, "pressure") else ():
        record = getattr(scene, table)
        if one.records and record is not None:
            doubts += [
                f"{table}.{name} = {value:g} N/m is {value / scene.pressure:.2g} times the pressure of {scene.pressure:g} N/m, not "
                f"{STIFFNESS[0]:g} to {STIFFNESS[1]:g} times: mm for m, or g for kg, in one of them?"
                for name, value in stiffnesses(record)
                if not STIFFNESS[0] <= value / scene.pressure <= STIFFNESS[1]
            ]
    size, half = ("mean_radius", 1.0) if hasattr(scene, "mean_radius") else ("mean_diameter", 0.5)
    radius = half * getattr(scene, size)
    if scene.density == 1 and radius == 0.5:
        return doubts
    if not DENSITY[0] <= scene.density <= DENSITY[1]:
        doubts.append(f"density = {scene.density:g} kg/m3 is not in {DENSITY[0]:g} to {DENSITY[1]:g} kg/m3: given in g/cm3 or g/mm3?")
    if not RADIUS[0] <= radius <= RADIUS[1]:
        doubts.append(f"{size} = {getattr(scene, size):g} m: a radius not in {RADIUS[0]:g} to {RADIUS[1]:g} m: given in mm or um?")
    return doubts


def stiffnesses(record):
    """(name, value) of the stiffnesses of a contact effect that are never zero, in N/m."""
    return [(name, getattr(record, name)) for name, one in keys_of(record).items() if one.unit == "N/m" and one.above == 0]
