# Sourced: TMPDIR becomes a new folder, deleted at the end. It is in memory if there is room (2 GB) and TMPDIR is not set:
# tests of the store wait ten times as long for a slow disk as they compute.
room=$(df -k --output=avail /dev/shm 2>/dev/null | tail -n 1)
[ -n "${TMPDIR:-}" ] || [ ! -w /dev/shm ] || [ "${room:-0}" -lt 2000000 ] || TMPDIR=/dev/shm
TMPDIR=$(mktemp -d "${TMPDIR:-/tmp}/shearcell-tests-XXXXXX")
chmod 755 "$TMPDIR"  # Slurm's daemons have other users
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
