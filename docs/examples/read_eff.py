#!/usr/bin/env python3
"""A reader of field files, `.eff.mcap`, version 1, written from docs/eff.md alone.

    python read_eff.py FIELD.eff.mcap          prints what is in it, as JSON

It needs mcap, protobuf, numpy and zstandard. It does not check all that a validator checks; what it does not
know it refuses.
"""

import json
import math
import sys
from dataclasses import dataclass, field

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader

VERSION = 1
FEATURES = {"directing"}
TOPICS = {"/eff/manifest", "/eff/edits", "/eff/pose", "/eff/samples", "/eff/field"}
F32, F16, FIXED16, FIXED32 = 1, 2, 3, 4


class Refused(Exception):
    """The file is of a kind that this reader must not read."""


@dataclass
class Step:
    """One time step. Arrays are indexed [x, y, z]; `u` has the component first."""

    u: np.ndarray
    flags: np.ndarray
    sd: np.ndarray | None
    outside: np.ndarray


@dataclass
class Samples:
    """The measured vectors of one time step, one row a sample."""

    strand: np.ndarray
    marker: np.ndarray
    position: np.ndarray
    value: np.ndarray
    covariance: np.ndarray


@dataclass
class Eff:
    """A field file."""

    manifest: dict
    layers: list = field(default_factory=list)
    translations: list = field(default_factory=list)
    rotations: list = field(default_factory=list)
    samples: list = field(default_factory=list)
    steps: list = field(default_factory=list)
    attachments: dict = field(default_factory=dict)

    def time(self, k):
        info = self.manifest["field"]
        return info["start_secs"] + k / info["rate_hz"]

    def at(self, time, point):
        """The wind at a time and a point in head space, edits included."""
        info = self.manifest["field"]
        last = len(self.steps) - 1
        place = min(max((time - info["start_secs"]) * info["rate_hz"], 0.0), float(last))
        before = int(place)
        share = place - before
        wind = (1 - share) * self.in_step(before, point) + share * self.in_step(min(before + 1, last), point)
        for layer in self.layers:
            share = presence(layer, time)
            added, weights = extra(layer, point)
            if layer.get("reshape"):
                wind = reshaped(layer["reshape"], share * min(1.0, weights), wind)
            wind = wind + share * added
        return wind

    def in_step(self, k, point):
        """Trilinear between voxel centers; the nearest ones hold at the rim; beyond it the wind outside comes in."""
        grid = self.manifest["field"]["grid"]
        step, dims = self.steps[k], np.array(grid["dims"])
        place = (np.array(point) - grid["origin_m"]) / grid["edge_m"]
        beyond = np.linalg.norm(np.maximum(np.maximum(-place, place - dims), 0))
        far = min(beyond / (0.5 * dims.min()), 1.0)
        place = np.clip(place - 0.5, 0, dims - 1)
        low = place.astype(int)
        share = place - low
        wind = np.zeros(3)
        for corner in np.ndindex(2, 2, 2):
            voxel = np.minimum(low + corner, dims - 1)
            weight = np.prod(np.where(corner, share, 1 - share))
            wind += weight * step.u[:, voxel[0], voxel[1], voxel[2]].astype(float)
        return (1 - far) * wind + far * np.array(step.outside)


def smooth(x):
    x = min(max(x, 0.0), 1.0)
    return x * x * x * (x * (6 * x - 15) + 10)


def presence(layer, time):
    first, last = layer["first_secs"], layer["last_secs"]
    if layer["muted"] or not first < time < last:
        return 0.0
    x = (time - first) / (last - first)
    rise = smooth(x / layer["rise"]) if layer["rise"] > 0 else 1.0
    fall = smooth((1 - x) / layer["fall"]) if layer["fall"] > 0 else 1.0
    return rise * fall


def extra(layer, point):
    """What the handles add at a point, and the sum of their weights."""
    total, weights = np.zeros(3), 0.0
    for handle in layer["handles"]:
        s = np.linalg.norm(np.array(point) - handle["center_m"]) / handle["reach_m"]
        weight = (1 - s) ** 4 * (4 * s + 1) if s < 1 else 0.0
        total += weight * np.array(handle["extra"])
        weights += weight
    return total / max(1.0, weights), weights


def reshaped(reshape, weight, wind):
    """The wind turned about an axis by its length and stretched, so much of the way (Rodrigues)."""
    turn = weight * np.array(reshape["turn"])
    angle = np.linalg.norm(turn)
    if angle > 0:
        axis = turn / angle
        across = np.cross(axis, wind)
        wind = wind + math.sin(angle) * across + (1 - math.cos(angle)) * np.cross(axis, across)
    return (1 + (reshape["scale"] - 1) * weight) * wind


def unpack(array, planes, dims):
    """The numbers of an Array as [plane, x, y, z]."""
    n = planes * math.prod(dims)
    width = {F32: 4, F16: 2, FIXED16: 2, FIXED32: 4}.get(array.encoding)
    if width is None:
        raise Refused(f"encoding {array.encoding} is not of version 1")
    if len(array.data) != n * width:
        raise Refused(f"found {len(array.data)} bytes, expected {n * width}")
    numbers = np.frombuffer(array.data, np.uint8).reshape(width, n).T.tobytes()
    shape = (planes, *dims)
    if array.encoding == F32:
        return np.frombuffer(numbers, "<f4").reshape(shape)
    if array.encoding == F16:
        return np.frombuffer(numbers, "<f2").astype(np.float32).reshape(shape)
    unsigned, signed = ("<u2", np.int16) if width == 2 else ("<u4", np.int32)
    d = np.frombuffer(numbers, unsigned)
    multiples = ((d >> 1) ^ -(d & 1).astype(unsigned)).astype(signed).reshape(shape)
    for axis in (3, 2, 1):
        multiples = np.cumsum(multiples, axis=axis, dtype=signed)
    return (multiples * array.quantum).astype(np.float32)


def message_classes(schema):
    """The class of a schema's message, made from the descriptors that are in the file."""
    files = descriptor_pb2.FileDescriptorSet.FromString(schema.data)
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))


def check_manifest(manifest):
    if manifest.get("format") != "tousle.eff":
        raise Refused(f"format {manifest.get('format')!r} is not tousle.eff")
    if manifest["version"] > VERSION:
        raise Refused(f"version {manifest['version']} is newer than this reader's, {VERSION}")
    for feature in manifest["requires"]:
        if feature not in FEATURES:
            raise Refused(f"feature {feature!r} is unknown to this reader")


def check_time(info, k, log_time):
    expected = (info.get("start_secs", 0.0) + k / info["rate_hz"]) * 1e9
    if abs(log_time - expected) > 1.5:
        raise Refused(f"message {k} is at {log_time} ns, expected {expected}")


def read(stream):
    reader = make_reader(stream, validate_crcs=True)
    if reader.get_header().profile != "tousle.eff":
        raise Refused("the profile is not tousle.eff")
    eff, classes = None, {}
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        topic = channel.topic
        if not topic.startswith("/eff/"):
            continue
        if topic not in TOPICS:
            raise Refused(f"topic {topic} is not of version 1")
        if topic == "/eff/manifest":
            eff = Eff(json.loads(message.data))
            check_manifest(eff.manifest)
            continue
        if eff is None:
            raise Refused("there is no manifest before the first message")
        if topic == "/eff/edits":
            eff.layers = json.loads(message.data)["layers"]
            continue
        if topic not in classes:
            classes[topic] = message_classes(schema)
        take = {"/eff/pose": take_pose, "/eff/samples": take_samples, "/eff/field": take_step}[topic]
        take(eff, classes[topic].FromString(message.data), message.log_time)
    if eff is None:
        raise Refused("there is no manifest")
    for attachment in reader.iter_attachments():
        eff.attachments[attachment.name] = attachment.data
    check_counts(eff)
    return eff


def take_pose(eff, message, log_time):
    check_time(eff.manifest["pose"], len(eff.translations), log_time)
    t, r = message.translation_m, message.rotation
    eff.translations.append(np.array([t.x, t.y, t.z]))
    eff.rotations.append(np.array([r.x, r.y, r.z, r.w]))


def take_samples(eff, message, log_time):
    check_time(eff.manifest["samples"], len(eff.samples), log_time)
    n = len(message.strand_idx)
    column = lambda array, planes: unpack(array, planes, (n, 1, 1)).reshape(planes, n).T
    eff.samples.append(
        Samples(
            np.array(message.strand_idx),
            np.array(message.marker_idx),
            column(message.position_m, 3),
            column(message.value, 3),
            column(message.covariance, 6),
        )
    )


def take_step(eff, message, log_time):
    info = eff.manifest["field"]
    check_time(info, len(eff.steps), log_time)
    dims = tuple(info["grid"]["dims"])
    u = unpack(message.u, 3, dims)
    sd = unpack(message.sd, 1, dims)[0] if message.HasField("sd") else None
    flags = np.frombuffer(message.flags, np.uint8).reshape(dims)
    o = message.outside
    eff.steps.append(Step(u, flags, sd, np.array([o.x, o.y, o.z])))


def check_counts(eff):
    samples = eff.manifest.get("samples") or {"n_steps": 0}
    counts = [
        ("poses", len(eff.translations), eff.manifest["pose"]["n_poses"]),
        ("steps of samples", len(eff.samples), samples["n_steps"]),
        ("steps", len(eff.steps), eff.manifest["field"]["n_steps"] or len(eff.steps)),
    ]
    for what, found, expected in counts:
        if found != expected:
            raise Refused(f"found {found} {what}, expected {expected}")


def content(eff):
    """What is in the file, in the numbers that the conformance set gives for it."""
    info = eff.manifest["field"]
    grid = info["grid"]
    pose = lambda k: {"translation_m": list(eff.translations[k]), "rotation_xyzw": list(eff.rotations[k])}
    origin = np.array(grid["origin_m"])
    far = origin + np.array(grid["dims"]) * grid["edge_m"]
    middle = (eff.time(0) + eff.time(len(eff.steps) - 1)) / 2
    found = {
        "name": eff.manifest["name"],
        "quantity": info["quantity"],
        "grid": grid,
        "times_secs": [eff.time(k) for k in range(len(eff.steps))],
        "steps": [step_content(step) for step in eff.steps],
        "n_poses": len(eff.translations),
        "first_pose": pose(0),
        "last_pose": pose(-1),
        "colliders": [collider["name"] for collider in eff.manifest["scene"]["body"]["colliders"]],
        "layers": [[l["id"], l["muted"], l["first_secs"], l["last_secs"]] for l in eff.layers],
        "samples": samples_content(eff),
        "attachments": list(eff.attachments),
        "sampled": list(eff.at(middle, 0.45 * origin + 0.55 * far)),
    }
    if "directing" in eff.manifest["requires"]:
        found["directing"] = [
            {"handles": l["handles"], "reshape": l.get("reshape"), "origin": l["origin"]} for l in eff.layers
        ]
    return found


def step_content(step):
    u = step.u.reshape(3, -1)
    return {
        "sum_u": list(u.sum(axis=1, dtype=float)),
        "first_u": [float(c) for c in u[:, 0]],
        "last_u": [float(c) for c in u[:, -1]],
        "n_outside": int((step.flags == 0).sum()),
        "n_interpolated": int((step.flags == 1).sum()),
        "n_measured": int((step.flags == 2).sum()),
        "sum_known_sd": None if step.sd is None else float(step.sd[np.isfinite(step.sd)].sum(dtype=float)),
        "outside": list(step.outside),
    }


def samples_content(eff):
    if not eff.manifest.get("samples"):
        return None
    covariances = np.concatenate([s.covariance for s in eff.samples])
    return {
        "rate_hz": eff.manifest["samples"]["rate_hz"],
        "counts": [len(s.strand) for s in eff.samples],
        "sum_position_m": float(sum(s.position.sum(dtype=float) for s in eff.samples)),
        "sum_value": float(sum(s.value.sum(dtype=float) for s in eff.samples)),
        "sum_known_covariance": float(covariances[np.isfinite(covariances)].sum(dtype=float)),
    }


if __name__ == "__main__":
    try:
        with open(sys.argv[1], "rb") as stream:
            print(json.dumps(content(read(stream))))
    except Refused as refused:
        sys.exit(f"{sys.argv[1]}: {refused}")
