# SPDX-License-Identifier: GPL-3.0-or-later
# The program's bill of materials, CycloneDX 1.5 JSON: the shared libraries that it loads, the libraries
# that are headers alone, and the npm packages in the report's front end.
#   cmake -DSOURCE= -DPROGRAM= -DVERSION= -DHEADERS=NAME|FILE|VERSION,... -DPACKAGES=FILE -DOUT=FILE -P bill.cmake
# Packages and versions are dpkg's; without dpkg a shared library has its file's name and hash alone.
# Equal inputs give equal bytes.
cmake_minimum_required(VERSION 3.25)
set(commit_folder ${CMAKE_CURRENT_LIST_DIR}/../runner)
block(SCOPE_FOR VARIABLES PROPAGATE commit commit_time)
  unset(OUT)
  include(${commit_folder}/commit.cmake)
endblock()

# SPDX's words for what we chose ourselves. What those load in turn has the words of its own package.
set(licences
  "brotli=MIT" "boost=BSL-1.0" "cgal=GPL-3.0-or-later AND LGPL-3.0-or-later" "cli11=BSD-3-Clause"
  "curl=curl" "eigen3=MPL-2.0" "fmtlib=MIT" "gcc=GPL-3.0-or-later WITH GCC-exception-3.1"
  "glibc=LGPL-2.1-or-later" "gmp=LGPL-3.0-or-later OR GPL-2.0-or-later" "hdf5=BSD-3-Clause"
  "highway=Apache-2.0" "libaec=BSD-2-Clause" "libkainjow-mustache=BSL-1.0" "mpfr=LGPL-3.0-or-later"
  "muparser=BSD-2-Clause" "nlohmann-json=MIT" "openssl=Apache-2.0"
  "sqlite3=blessing" "utf8proc=MIT" "yaml-cpp=MIT" "zlib=Zlib")

# TEXT as a JSON string, quotes included.
function(quote result text)
  string(REPLACE "\\" "\\\\" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  set(${result} "\"${text}\"" PARENT_SCOPE)
endfunction()

# The paths under which dpkg may know a file: /lib and /usr/lib were two once.
function(dpkg_names result file)
  file(REAL_PATH "${file}" real)
  set(names "${file}" "${real}")
  list(TRANSFORM names REPLACE "^/usr/" "/" OUTPUT_VARIABLE short)
  set(${result} ${names} ${short} PARENT_SCOPE)
endfunction()

# Asks dpkg once for all files: sets OWNERS, its lines "PACKAGE[:ARCH][, PACKAGE...]: FILE", and FACTS, lines
# "PACKAGE VERSION ARCHITECTURE SOURCE". Both are empty where there is no dpkg.
function(ask_dpkg files)
  set(asked "")
  foreach(file IN LISTS files)
    dpkg_names(names ${file})
    list(APPEND asked ${names})
  endforeach()
  set(said "")
  set(facts "")
  if(DPKG)
    execute_process(COMMAND ${DPKG} -S ${asked} OUTPUT_VARIABLE said ERROR_QUIET)
    string(REGEX MATCHALL "(^|\n)[a-z0-9][a-z0-9.+-]+" packages "${said}")
    list(TRANSFORM packages REPLACE "\n" "")
    list(REMOVE_DUPLICATES packages)
    if(packages)
      execute_process(COMMAND ${DPKG} -W -f "\${Package} \${Version} \${Architecture} \${source:Package}\n" ${packages}
                      OUTPUT_VARIABLE facts)
    endif()
  endif()
  set(OWNERS "\n${said}" PARENT_SCOPE)
  set(FACTS "\n${facts}" PARENT_SCOPE)
endfunction()

# Sets OUT_package, OUT_version, OUT_arch and OUT_source of the package that owns a file; empty where none.
function(owner out file)
  foreach(part package version arch source)
    set(${out}_${part} "" PARENT_SCOPE)
  endforeach()
  dpkg_names(names ${file})
  foreach(name IN LISTS names)
    string(FIND "${OWNERS}" ": ${name}\n" end)
    if(end LESS 0)
      continue()
    endif()
    string(SUBSTRING "${OWNERS}" 0 ${end} package)
    string(REGEX REPLACE "^.*\n" "" package "${package}")
    string(REGEX REPLACE "[:,].*$" "" package "${package}")
    string(FIND "${FACTS}" "\n${package} " begin)
    math(EXPR begin "${begin} + 1")
    string(SUBSTRING "${FACTS}" ${begin} -1 line)
    string(REGEX MATCH "^([^ ]+) ([^ ]+) ([^ ]+) ([^\n]+)\n" line "${line}")
    set(${out}_package "${CMAKE_MATCH_1}" PARENT_SCOPE)
    set(${out}_version "${CMAKE_MATCH_2}" PARENT_SCOPE)
    set(${out}_arch "${CMAKE_MATCH_3}" PARENT_SCOPE)
    set(${out}_source "${CMAKE_MATCH_4}" PARENT_SCOPE)
    return()
  endforeach()
endfunction()

# The member "licenses" of a component: SPDX's expression where we know it, else the package's own word.
function(licence_of result source package)
  foreach(entry IN LISTS licences)
    string(REGEX MATCH "^([^=]+)=(.+)$" entry "${entry}")
    if("${source}" MATCHES "^${CMAKE_MATCH_1}(-?[0-9.]+)?$")
      string(REGEX MATCH "^([^=]+)=(.+)$" entry "${entry}")
      set(${result} ",\"licenses\":[{\"expression\":\"${CMAKE_MATCH_2}\"}]" PARENT_SCOPE)
      return()
    endif()
  endforeach()
  set(${result} "" PARENT_SCOPE)
  set(copyright /usr/share/doc/${package}/copyright)
  if(NOT package OR NOT EXISTS ${copyright})
    return()
  endif()
  file(READ ${copyright} text)
  if(text MATCHES "\nFiles: *\n? \\*[^\n]*\n([^\n]+\n)*License: *([^\n]+)\n")
    set(word "${CMAKE_MATCH_2} for most of the source package, see ${copyright}")
  else()
    set(word "see ${copyright}")
  endif()
  quote(word "${word}")
  set(${result} ",\"licenses\":[{\"license\":{\"name\":${word}}}]" PARENT_SCOPE)
endfunction()

# {"type": "library", ...} of a Debian package or of a file without one.
function(component result name version arch package source use files)
  licence_of(licence "${source}" "${package}")
  set(purl "")
  set(reference "${name}")
  if(package)
    string(REPLACE "+" "%2B" escaped "${package}@${version}")
    set(reference "pkg:deb/${DISTRIBUTION}/${escaped}?arch=${arch}")
    set(purl ",\"purl\":\"${reference}\"")
  endif()
  if(version)
    quote(version "${version}")
    set(version ",\"version\":${version}")
  endif()
  if(files)
    set(files ",\"components\":[${files}]")
  endif()
  set(${result} "{\"type\":\"library\",\"bom-ref\":\"${reference}\",\"name\":\"${name}\"${version}${licence}${purl},\
\"properties\":[{\"name\":\"shearcell:use\",\"value\":\"${use}\"}]${files}}" PARENT_SCOPE)
endfunction()

find_program(DPKG dpkg-query)
set(DISTRIBUTION debian)
if(EXISTS /etc/os-release)
  file(STRINGS /etc/os-release line REGEX "^ID=")
  string(REGEX REPLACE "^ID=\"?([a-z0-9._-]+)\"?$" "\\1" DISTRIBUTION "${line}")
endif()

# Shared libraries, those that libraries load included: one component a package, its files within.
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${PROGRAM} RESOLVED_DEPENDENCIES_VAR libraries
     UNRESOLVED_DEPENDENCIES_VAR missing)
if(missing)
  message(FATAL_ERROR "libraries that ${PROGRAM} loads are not found: ${missing}")
endif()
list(SORT libraries)
string(REPLACE "," ";" headers "${HEADERS}")
list(TRANSFORM headers REPLACE "^[^|]*[|]([^|]*)[|].*$" "\\1" OUTPUT_VARIABLE header_files)
ask_dpkg("${libraries};${header_files}")
set(keys "")
foreach(library IN LISTS libraries)
  get_filename_component(file ${library} NAME)
  owner(own ${library})
  if(own_package)
    set(key ${own_package})
  else()
    string(REGEX REPLACE "\\.so.*" "" key ${file})
  endif()
  if(NOT key IN_LIST keys)
    list(APPEND keys ${key})
    set(files_${key} "")
  else()
    string(APPEND files_${key} ",")
  endif()
  file(SHA256 ${library} hash)
  string(APPEND files_${key} "{\"type\":\"file\",\"name\":\"${file}\",\"hashes\":[{\"alg\":\"SHA-256\",\"content\":\"${hash}\"}]}")
  foreach(part package version arch source)
    set(${part}_${key} "${own_${part}}")
  endforeach()
endforeach()
list(SORT keys)
set(all "")
foreach(key IN LISTS keys)
  component(one ${key} "${version_${key}}" "${arch_${key}}" "${package_${key}}" "${source_${key}}"
            "shared library" "${files_${key}}")
  list(APPEND all "${one}")
endforeach()

# Libraries that are headers alone.
foreach(header IN LISTS headers)
  string(REGEX MATCH "^([^|]+)\\|([^|]*)\\|(.*)$" header "${header}")
  set(name "${CMAKE_MATCH_1}")
  set(version "${CMAKE_MATCH_3}")
  owner(own "${CMAKE_MATCH_2}")
  if(own_package)
    component(one ${own_package} "${own_version}" "${own_arch}" ${own_package} "${own_source}" "headers" "")
  else()
    component(one ${name} "${version}" "" "" ${name} "headers" "")
  endif()
  list(APPEND all "${one}")
endforeach()

# npm packages in the front end.
file(READ ${PACKAGES} packages)
string(JSON count LENGTH "${packages}")
if(count GREATER 0)
  math(EXPR last "${count} - 1")
  foreach(i RANGE ${last})
    foreach(part name version license sha512)
      string(JSON ${part} GET "${packages}" ${i} ${part})
    endforeach()
    string(REPLACE "@" "%40" path "${name}")
    list(APPEND all "{\"type\":\"library\",\"bom-ref\":\"pkg:npm/${path}@${version}\",\"name\":\"${name}\",\
\"version\":\"${version}\",\"hashes\":[{\"alg\":\"SHA-512\",\"content\":\"${sha512}\"}],\
\"licenses\":[{\"expression\":\"${license}\"}],\"purl\":\"pkg:npm/${path}@${version}\",\
\"properties\":[{\"name\":\"shearcell:use\",\"value\":\"in the report's front end\"}]}")
  endforeach()
endif()
list(JOIN all "," all)

if(commit_time AND NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  set(ENV{SOURCE_DATE_EPOCH} ${commit_time})
endif()
set(time "")
if(DEFINED ENV{SOURCE_DATE_EPOCH})
  string(TIMESTAMP time "%Y-%m-%dT%H:%M:%SZ" UTC)
  set(time "\"timestamp\":\"${time}\",")
endif()
string(UUID serial NAMESPACE 6ba7b810-9dad-11d1-80b4-00c04fd430c8 NAME "${VERSION} ${commit} ${time} ${all}" TYPE SHA1)
set(reference "pkg:generic/shearcell@${VERSION}?vcs_commit=${commit}")
set(bill "{\"bomFormat\":\"CycloneDX\",\"specVersion\":\"1.5\",\"serialNumber\":\"urn:uuid:${serial}\",\"version\":1,\
\"metadata\":{${time}\"component\":{\"type\":\"application\",\"bom-ref\":\"${reference}\",\
\"name\":\"shearcell\",\"version\":\"${VERSION}\",\"licenses\":[{\"expression\":\"GPL-3.0-or-later\"}],\
\"purl\":\"${reference}\",\"properties\":[{\"name\":\"shearcell:commit\",\"value\":\"${commit}\"}]}},\"components\":[${all}]}")
string(JSON bill GET "${bill}")  # checks it, and indents it
file(WRITE ${OUT} "${bill}\n")
