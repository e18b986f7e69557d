"""Minimum times at 20 N m with a load that is lighter or heavier: its inertia and friction times a factor.

    python light_loads.py 0.3
"""

import importlib
import sys
from math import sqrt

import plant_values as plant

LOAD_KEYS = ("LOAD_INERTIA_KG_M2", "LOAD_FRICTION_NM_S_RAD", "LOAD_COULOMB_NM", "LOAD_STICTION_NM")
WITH_LOAD = ("accelerate", "brake", "stop")


def main():
    times = float(sys.argv[1])
    for key in LOAD_KEYS:
        setattr(plant, key, times * getattr(plant, key))
    # Imported now: its constants are those of the plant.
    minimum_time = importlib.import_module("minimum_time")
    longer = sqrt(times)
    minimum_time.GUESSES = {
        leg: (duration_s * longer if leg in WITH_LOAD else duration_s, end_rad, speed_rad_s / longer)
        for leg, (duration_s, end_rad, speed_rad_s) in minimum_time.GUESSES.items()
    }
    minimum_time.Study(minimum_time.INTERVALS).row(20)


if __name__ == "__main__":
    main()
