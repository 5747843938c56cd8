#!/bin/sh
# Cancel jobs by their numbers.
scancel "$@"
