# SPDX-License-Identifier: Apache-2.0
# Writes the commit of the sources into HEADER, which changes only when the commit does. Without a
# repository the commit is empty. Run by each build: cmake -DSOURCE=... -DHEADER=... -P commit.cmake
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define TAGSMITH_COMMIT \"${commit}\"\n")
