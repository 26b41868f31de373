# SPDX-License-Identifier: GPL-3.0-or-later
# Finds the commit of the sources. Sets `commit` (12 digits, followed by -dirty if a tracked file differs;
# or "unknown") and `commit_time` (seconds since 1970; empty if unknown). When run as a script, writes
# `commit` into a source file if its content changes:
#   cmake -DSOURCE=FOLDER -DOUT=FILE.cpp -P commit.cmake
cmake_minimum_required(VERSION 3.25)

# `git archive` replaces these two placeholders (see .gitattributes in this folder).
set(commit "$Format:%H$")
set(commit_time "$Format:%ct$")

# Git is asked only if SOURCE is a repository itself: an archive may be unpacked inside another one.
if(EXISTS "${SOURCE}/.git")
  execute_process(COMMAND git --no-optional-locks -C ${SOURCE} log -1 --format=%H,%ct
                  OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND git --no-optional-locks -C ${SOURCE} status --porcelain --untracked-files=no
                  OUTPUT_VARIABLE changed ERROR_QUIET)
else()
  set(head "${commit},${commit_time}")
endif()

set(commit "unknown")
set(commit_time "")
if(head MATCHES "^([0-9a-f]+),([0-9]+)$")
  set(commit_time ${CMAKE_MATCH_2})
  string(SUBSTRING ${CMAKE_MATCH_1} 0 12 commit)
  if(changed)
    string(APPEND commit "-dirty")
  endif()
endif()

if(OUT)
  file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT
"#include \"experiments/runner/build_facts.hpp\"

namespace shearcell {
const char* const kBuildCommit = \"${commit}\";
}  // namespace shearcell
")
endif()
