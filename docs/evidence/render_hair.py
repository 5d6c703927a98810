"""Pictures of a motion, frames side by side, by Blender's path tracer.

    pip install bpy==5.0.1
    python render_hair.py MOTION.npz OUT.png FRAME,FRAME,... WIDTH_MM front|left|three

The body is that of the development captures' sessions, in its rest pose; the bump on it is a nose.
"""

import sys

import bpy
import numpy as np
from mathutils import Vector

SPACING_M = 0.62
PIXELS = 360
VIEWS = {"front": (1, 0, 0), "left": (0, 1, 0), "three": (0.8, 0.6, 0.15)}


def material(name, color, roughness):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1)
    shader.inputs["Roughness"].default_value = roughness
    return made


def ellipsoid(center, half_axes, skin):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, location=center)
    bpy.context.object.scale = half_axes
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(skin)


def capsule(a, b, radius, skin):
    a, b = np.array(a), np.array(b)
    bpy.ops.mesh.primitive_cylinder_add(radius=radius, depth=np.linalg.norm(b - a), location=(a + b) / 2, vertices=48)
    bpy.context.object.rotation_euler = Vector(b - a).to_track_quat("Z", "Y").to_euler()
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(skin)
    for end in (a, b):
        ellipsoid(end, (radius, radius, radius), skin)


def body(at, skin):
    ellipsoid(at, (0.095, 0.075, 0.1), skin)
    ellipsoid(at + np.array([0.095, 0, -0.01]), (0.02, 0.012, 0.02), skin)
    capsule(at + [-0.015, 0, -0.07], at + [-0.02, 0, -0.19], 0.055, skin)
    capsule(at + [-0.02, -0.15, -0.27], at + [-0.02, 0.15, -0.27], 0.07, skin)


def hair(points, counts, width_m, look):
    curves = bpy.data.hair_curves.new("hair")
    curves.add_curves([int(n) for n in counts])
    curves.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    radius = curves.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(len(points), width_m / 2, np.float32))
    curves.materials.append(look)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("hair", curves))


def light(at, watts, size):
    lamp = bpy.data.lights.new("lamp", "AREA")
    lamp.energy, lamp.size = watts, size
    made = bpy.data.objects.new("lamp", lamp)
    made.location = at
    made.rotation_euler = (-Vector(at)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(made)


def main(motion, out, frames, width_mm, view):
    frames = [int(frame) for frame in frames.split(",")]
    motion = np.load(motion)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    skin, brown = material("skin", (0.75, 0.55, 0.45), 0.5), material("hair", (0.09, 0.045, 0.02), 0.35)
    towards = np.array(VIEWS[view]) / np.linalg.norm(VIEWS[view])
    right = np.cross([0, 0, 1], towards)
    right /= np.linalg.norm(right)
    for k, frame in enumerate(frames):
        at = right * SPACING_M * (k - (len(frames) - 1) / 2)
        body(at, skin)
        hair(motion["pos"][frame] + at, motion["counts"], float(width_mm) * 1e-3, brown)
    light(towards * 2 + right * 1.2 + [0, 0, 1.5], 60, 1.2)
    light(towards * 1.5 - right * 1.5 + [0, 0, 0.3], 25, 1.5)
    light(-towards * 1.5 + [0, 0, 1.5], 40, 1)
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    sky = scene.world.node_tree.nodes["Background"]
    sky.inputs[0].default_value, sky.inputs[1].default_value = (0.8, 0.85, 0.9, 1), 0.5
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", SPACING_M * len(frames)
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = towards * 2 + [0, 0, -0.06]
    scene.camera.rotation_euler = (-Vector(towards)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(scene.camera)
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 32, False
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = PIXELS * len(frames), int(PIXELS * 1.05)
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


main(*sys.argv[1:])
