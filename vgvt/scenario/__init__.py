"""The scenario: schema, TOML loading, bundled library, named random streams."""

from vgvt.scenario.airframe import Airframe, Beam, Body, Damping, Item, Stations
from vgvt.scenario.axis import Axis, beam_axis
from vgvt.scenario.hammer import Hammer
from vgvt.scenario.instruments import Accelerometers, Acquisition, Grid, NoiseSpectrum, Transducer
from vgvt.scenario.json_schema import scenario_json_schema
from vgvt.scenario.library import bundled_path, bundled_scenarios, spoiled_scenarios
from vgvt.scenario.load import load_scenario, scenario_path
from vgvt.scenario.mass import beam_properties, rigid_body_properties
from vgvt.scenario.mirror import expanded_beams, expanded_items, part_name
from vgvt.scenario.model import Scenario, Simulation
from vgvt.scenario.planform import edge_lines_m, outlines_m, part_at, surface_height_m
from vgvt.scenario.points import SensorPoint, sensor_points
from vgvt.scenario.rig import Excitation, Shaker, Stinger, Suspension
from vgvt.scenario.streams import named_stream
from vgvt.scenario.write import to_toml

__all__ = [
    "Accelerometers",
    "Acquisition",
    "Airframe",
    "Axis",
    "Beam",
    "Body",
    "Damping",
    "Excitation",
    "Grid",
    "Hammer",
    "Item",
    "NoiseSpectrum",
    "Scenario",
    "SensorPoint",
    "Shaker",
    "Simulation",
    "Stations",
    "Stinger",
    "Suspension",
    "Transducer",
    "beam_axis",
    "beam_properties",
    "bundled_path",
    "bundled_scenarios",
    "edge_lines_m",
    "expanded_beams",
    "expanded_items",
    "load_scenario",
    "named_stream",
    "outlines_m",
    "part_at",
    "part_name",
    "rigid_body_properties",
    "scenario_json_schema",
    "scenario_path",
    "sensor_points",
    "spoiled_scenarios",
    "surface_height_m",
    "to_toml",
]
