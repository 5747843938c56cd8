"""What in an HDF5 file (NetCDF-4, MATLAB 7.3) leads elsewhere or nowhere, found before it is read.

Links and data may stand in other files, of which the sheet says nothing and which nobody sent. A
group that holds itself, or has two names at every level, makes a library that lists all groups fill
the memory from two kilobytes.
"""

# A record or a set of matrices has a few dozen groups and variables, a few deep.
MOST_OBJECTS = 20_000  # groups and variables
DEEPEST_GROUP = 16  # groups in each other


def check_links(path: str) -> None:
    """Raise ValueError, one line, for a link to another file, a loop, or too many objects.

    A file that cannot be opened or listed is left to its reader. Soft links are not followed.
    """
    import h5py

    try:
        file = h5py.File(path, "r")
    except OSError:
        return
    with file:
        seen, count = {_identity(file["/"])}, 0
        waiting = [(file["/"], "", 1)]
        while waiting:
            group, place, depth = waiting.pop()
            if depth > DEEPEST_GROUP:
                raise ValueError(
                    f"expected groups {DEEPEST_GROUP} deep at most, got {place} ({path})"
                )
            for name in group:
                here = f"{place}/{name}"
                count += 1
                if count > MOST_OBJECTS:
                    raise ValueError(
                        f"expected {MOST_OBJECTS} groups and variables at most, got more ({path})"
                    )
                link = group.get(name, getlink=True)
                if isinstance(link, h5py.SoftLink):
                    continue
                if not isinstance(link, h5py.HardLink):
                    raise ValueError(
                        f"expected all data in the file, got {here}, a link to another one ({path})"
                    )
                item = group.get(name)
                if isinstance(item, h5py.Dataset):
                    _check_storage(item, here, path)
                elif isinstance(item, h5py.Group):
                    own = _identity(item)
                    if own in seen:
                        raise ValueError(
                            f"expected each group once, got {here}, which holds itself or has two "
                            f"names ({path})"
                        )
                    seen.add(own)
                    waiting.append((item, here, depth + 1))


def _identity(group) -> tuple:
    """Where a group stands in the file."""
    import h5py

    info = h5py.h5o.get_info(group.id)
    return info.fileno, info.addr


def _check_storage(item, here: str, path: str) -> None:
    """Raise ValueError for a variable whose numbers stand in other files."""
    if item.external or item.is_virtual:
        raise ValueError(
            f"expected all data in the file, got {here}, whose numbers stand in other files "
            f"({path})"
        )
