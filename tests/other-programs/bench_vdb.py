"""Size and speed of fields as OpenVDB itself writes them (Blosc), one file a step: beside `tousle bench file`.

    python3 bench_vdb.py FIELD.npz... > openvdb.csv

Speeds are in bytes that the steps take in memory, vectors and flags, by processor time.
"""

import os
import sys
import tempfile
import time

import numpy as np

try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb

print("field,written as,bytes,share of raw,write MB/s,read MB/s")
for path in sys.argv[1:]:
    field = np.load(path)
    u, flag = field["u"], field["flag"]
    raw = u.nbytes + flag.nbytes
    size = written = read = 0
    with tempfile.TemporaryDirectory() as work:
        for step in range(len(u)):
            wind, flags = vdb.Vec3SGrid(), vdb.FloatGrid()
            wind.name, flags.name = "wind", "flag"
            wind.copyFromArray(np.ascontiguousarray(u[step].transpose(1, 2, 3, 0)))
            flags.copyFromArray(flag[step].astype(np.float32))
            file = f"{work}/{step}.vdb"
            before = time.process_time()
            vdb.write(file, [wind, flags])
            written += time.process_time() - before
            size += os.path.getsize(file)
            out = np.zeros((*u.shape[2:], 3), np.float32)
            before = time.process_time()
            # Into an array, for what is not looked at is not unpacked.
            vdb.read(file, "wind").copyToArray(out)
            read += time.process_time() - before
    name = os.path.splitext(os.path.basename(path))[0]
    print(f"{name},vdb by OpenVDB (blosc),{size},{size / raw:.3f},{raw / 1e6 / written:.0f},{raw / 1e6 / read:.0f}")
