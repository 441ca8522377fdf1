# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D LAGRAIN=<build folder> -D WORK=<scratch folder> -D RENDER=<0|1> -D CXX=<compiler>
#   -D GENERATOR=<CMake generator> -P check.cmake
# Installs lagrain, builds the project beside this file (the examples, and the programs that READMEs
# show) with nothing but the installed copy, and runs it.

# An old copy would hide a header that is no longer installed.
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${WORK} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# The first program of a README is built as it stands there.
function(extract_program readme program)
  file(READ ${CMAKE_CURRENT_LIST_DIR}/../../${readme} text)
  string(REGEX MATCH "```cpp\n[^`]*```" block "${text}")
  string(REGEX REPLACE "^```cpp\n|```$" "" block "${block}")
  file(WRITE ${WORK}/${program}.cpp "${block}")
endfunction()
extract_program(README.md readme)
extract_program(common/README.md common_readme)

run(${CMAKE_COMMAND} --install ${LAGRAIN} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -G ${GENERATOR}
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=${CXX}
  -D CMAKE_PREFIX_PATH=${WORK}/prefix -D RENDER=${RENDER} -D PROGRAMS=${WORK})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_CTEST_COMMAND} --test-dir ${WORK}/build --output-on-failure --no-tests=error)
