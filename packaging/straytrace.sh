#!/bin/sh
# Starts the program of this name with the C library beside it, so that the age of that of the system does not matter.
here=$(dirname "$(readlink -f "$0")")
exec "$here/ld-linux-x86-64.so.2" --library-path "$here/../lib:$here/../lib/system" --argv0 "$0" "$here/../lib/programs/$(basename "$0")" "$@"
