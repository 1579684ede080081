"""Scenes as text: the keys of an experiment, their units and ranges, tables of them, and what is said about a bad one."""

from anisogran.scenes.changes import changed
from anisogran.scenes.doubts import doubts_of
from anisogran.scenes.keys import keys_of
from anisogran.scenes.schemas import scene_schema
from anisogran.scenes.writing import scene_template, scene_text

__all__ = ["changed", "doubts_of", "keys_of", "scene_schema", "scene_template", "scene_text"]
