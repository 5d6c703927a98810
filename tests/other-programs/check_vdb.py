"""OpenVDB opens the step that the demo wrote and finds in it what NumPy finds in the field.

    python3 check_vdb.py DEMO_FOLDER
"""

import sys
from pathlib import Path

import numpy as np

try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb

folder = Path(sys.argv[1])
path = next(folder.glob("gusts.*.vdb"))
step = int(path.suffixes[-2][1:])
field = np.load(folder / "gusts.npz")
expected = field["u"][step].transpose(1, 2, 3, 0)
grid = vdb.read(str(path), "wind")
found = np.zeros(expected.shape, np.float32)
grid.copyToArray(found)
same = np.array_equal(found, expected)
print(f"{'ok  ' if same else 'FAIL'} {path.name}: wind is bit for bit that of gusts.npz, step {step}")
sys.exit(0 if same else 1)
