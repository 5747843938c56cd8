"""One file a format of matrices: SUFFIXES and read(path, variable) -> sparse matrix as written."""
