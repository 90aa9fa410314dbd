"""How the points of clouds of ROS lie in memory, as different drivers have it."""

import numpy as np

FRAME = "os_lidar"


def _layout(step, **fields):
    return np.dtype({"names": list(fields), "formats": [form for form, _ in fields.values()],
                     "offsets": [offset for _, offset in fields.values()], "itemsize": step})


# Ouster's driver: padded for SSE, with fields that nobody asked for, here 0, between the others.
OUSTER = _layout(48, x=("<f4", 0), y=("<f4", 4), z=("<f4", 8), intensity=("<f4", 16), t=("<u4", 20),
                 reflectivity=("<u2", 24), ring=("<u2", 26), ambient=("<u2", 28), range=("<u4", 32))
# Nothing is padded, and numbers lie at odd addresses.
PACKED = _layout(22, x=("<f4", 0), y=("<f4", 4), z=("<f4", 8), intensity=("<f4", 12), ring=("<u2", 16), t=("<u4", 18))
# No driver does this, but the message may: fields in another order, gaps and odd offsets.
ODD = _layout(27, t=("<u4", 1), ring=("<u2", 6), z=("<f4", 9), y=("<f4", 13), x=("<f4", 17), intensity=("<f4", 21))

# sensor_msgs/PointField
DATATYPES = {"<u2": 4, "<u4": 6, "<f4": 7}


def cloud_bytes(points, layout):
    cloud = np.zeros(len(points), dtype=layout)
    for name in layout.names:
        if name in points.dtype.names:
            cloud[name] = points[name]
    return cloud.tobytes()


def cloud_fields(layout):
    """(name, offset, datatype) of each."""
    return [(name, layout.fields[name][1], DATATYPES[layout.fields[name][0].str]) for name in layout.names]
