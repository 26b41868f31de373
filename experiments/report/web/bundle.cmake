# SPDX-License-Identifier: GPL-3.0-or-later
# Bundles the front end, at build time: cmake -DNPM= -DNODE= -DSOURCE= -DOUT= -DSTAMP= -P bundle.cmake
# If bundling fails (no network), the program is built without the front end, and the next build tries again.

file(MAKE_DIRECTORY ${OUT})
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json DESTINATION ${OUT})
# Scripts of packages are not run.
execute_process(
  COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --loglevel=error
  WORKING_DIRECTORY ${OUT} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT failed)
  execute_process(COMMAND ${NODE} ${SOURCE}/build.mjs ${OUT} ${OUT}/bundle
                  RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
endif()
if(failed)
  message("The report will have drawings instead of interactive plots and packings: its front end "
          "could not be bundled (${failed}). The next build tries again, unless -DSHEARCELL_WEB=OFF is set.\n"
          "${said}")
  file(WRITE ${OUT}/bundle/report.js "")
  file(WRITE ${OUT}/bundle/licences.txt "")
  file(WRITE ${OUT}/bundle/packages.json "[]")
else()
  file(TOUCH ${STAMP})
endif()
