"""Programs that others wrote open what the demo wrote: PyPI mcap and pymcap-cli, NumPy, usd-core.

    python check.py DEMO_FOLDER [TOUSLE]

Prints a line a check; ends with exit code 1 at the first that fails.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from pxr import Usd, UsdGeom, UsdValidation

folder = Path(sys.argv[1])


def check(what, holds, found=""):
    print(f"{'ok  ' if holds else 'FAIL'} {what} {found}")
    if not holds:
        sys.exit(1)


def check_field(name):
    counts = {}
    steps = None
    with open(folder / name, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        check(f"{name}: profile", reader.get_header().profile == "tousle.eff")
        for _, channel, message in reader.iter_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
        steps = sum(1 for _ in reader.iter_decoded_messages(topics=["/eff/field"]))
    check(f"{name}: one manifest", counts.get("/eff/manifest") == 1, str(counts))
    check(f"{name}: every step decodes with the descriptor in the file", steps == counts["/eff/field"], str(steps))
    doctor = subprocess.run(
        [str(Path(sys.executable).parent / "pymcap-cli"), "doctor", str(folder / name)], capture_output=True, text=True
    )
    check(f"{name}: pymcap-cli doctor", doctor.returncode == 0, doctor.stdout[-300:] if doctor.returncode else "")


def check_npz():
    motion = np.load(folder / "bob.npz")
    frames, points, three = motion["pos"].shape
    check("bob.npz: shapes", three == 3 and motion["t"].shape == (frames,) and motion["counts"].sum() == points)
    check("bob.npz: finite", bool(np.isfinite(motion["pos"]).all()))
    lengths = np.linalg.norm(np.diff(motion["pos"], axis=1), axis=2)
    inner = np.setdiff1d(np.arange(points - 1), np.cumsum(motion["counts"])[:-1] - 1)
    stretch = np.abs(lengths[:, inner] / lengths[0, inner] - 1).max()
    check("bob.npz: no stick stretches by 0.1 %", stretch < 1e-3, f"{100 * stretch:.4f} %")
    field = np.load(folder / "gusts.npz")
    check("gusts.npz: shapes", field["u"].shape[2:] == field["flag"].shape[1:], str(field["u"].shape))


def check_usd():
    stage = Usd.Stage.Open(str(folder / "bob.usda"))
    check("bob.usda: meters", UsdGeom.GetStageMetersPerUnit(stage) == 1.0)
    registry = UsdValidation.ValidationRegistry()
    validators = registry.GetOrLoadAllValidators()
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    check("bob.usda: UsdValidation finds nothing", len(errors) == 0, f"({len(validators)} validators)")
    kinds = sorted({prim.GetTypeName() for prim in stage.Traverse()})
    check("bob.usda: curves and reeds", {"BasisCurves", "Mesh"} <= set(kinds), str(kinds))
    mesh = next(prim for prim in stage.Traverse() if prim.GetTypeName() == "Mesh" and "eed" in prim.GetName())
    st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
    check("bob.usda: reeds have texture coordinates", bool(st), f"{st.GetInterpolation()}")


if len(sys.argv) > 2:
    convert = [sys.argv[2], "-q", "convert", "gusts.c3d", "--session", "session.json", "-o", "preview.eff.mcap", "--preview"]
    subprocess.run([str(Path(convert[0]).resolve()), *convert[1:]], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    check_field("preview.eff.mcap")
for field in ("gusts.eff.mcap", "lifted.eff.mcap"):
    check_field(field)
check_npz()
check_usd()
