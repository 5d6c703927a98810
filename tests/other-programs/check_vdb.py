"""OpenVDB opens the step that the demo wrote and finds in it what NumPy finds in the field; and what OpenVDB writes,
packed by Blosc as it is wont to, `tousle import` takes in bit for bit.

    python3 check_vdb.py DEMO_FOLDER [TOUSLE]
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb


def check(what, holds):
    print(f"{'ok  ' if holds else 'FAIL'} {what}")
    if not holds:
        sys.exit(1)


folder = Path(sys.argv[1])
path = next(folder.glob("gusts.*.vdb"))
step = int(path.suffixes[-2][1:])
field = np.load(folder / "gusts.npz")
expected = field["u"][step].transpose(1, 2, 3, 0)
grid = vdb.read(str(path), "wind")
found = np.zeros(expected.shape, np.float32)
grid.copyToArray(found)
check(f"{path.name}: wind is bit for bit that of gusts.npz, step {step}", np.array_equal(found, expected))

if len(sys.argv) > 2:
    tousle = str(Path(sys.argv[2]).resolve())
    with tempfile.TemporaryDirectory() as work:
        def run(*words):
            subprocess.run([tousle, "-q", *words], cwd=work, check=True, stdout=subprocess.DEVNULL)

        vdb.write(f"{work}/theirs.vdb", [grid])
        packed = vdb.readGridMetadata(f"{work}/theirs.vdb", "wind")["file_compression"]
        run("import", "theirs.vdb", "--session", str((folder / "session.json").resolve()), "-o", "theirs.eff.mcap")
        run("export", "theirs.eff.mcap", "-o", "theirs.npz")
        back = np.load(f"{work}/theirs.npz")["u"][0].transpose(1, 2, 3, 0)
        check(f"what OpenVDB wrote ({packed}) comes back bit for bit", np.array_equal(back, expected))
