"""Scenes for the tests of the effects plan."""

from cranktopo.design.loading import load_scene


def with_effects(scene, **update):
    return scene.model_copy(update={"effects": scene.effects.model_copy(update=update)})


def with_part(scene, name, **update):
    return scene.model_copy(update={name: getattr(scene, name).model_copy(update=update)})


# The built-in designs switch the tangential case off; here the plan decides.
MIKRON = with_effects(load_scene("mikron-iiic-plain"), tangential="auto")
OPPOSED = with_effects(load_scene("opposed-piston"), tangential="auto")
