#!/bin/sh
# The states that committor_starts.py chooses from made-up runs:
#   sh starts.sh SCRIPT
# Too early: cycle 4 of seed 1, and cycle 5 of seed 2 for a control. Cycle 9 of seed 1 is after 60 grains.
set -eu
found=$(python3 "$1" <<'END'
scale,amplitude_rad,seed,cycle,largest_crystallite
desk,0.1,1,4,4
desk,0.1,1,5,3
desk,0.1,1,6,4
desk,0.1,1,7,9
desk,0.1,1,8,70
desk,0.1,1,9,5
desk,0.1,1,11,1
desk,0.1,2,5,2
desk,0.1,2,10,
desk,0.1,2,12,14
END
)
expected="  desk:
    sweep:
      zip:
        amplitude_rad: [0.1, 0.1, 0.1, 0.1]
        cycles: [7, 7, 7, 7]
        start_seed: [2, 1, 1, 2]
        start_cycle: [10, 5, 7, 12]"
[ "$found" = "$expected" ] || { echo "$found"; exit 1; }
