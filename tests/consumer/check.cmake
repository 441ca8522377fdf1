# cmake -D LAGRAIN=<build folder> -D WORK=<scratch folder> -D RENDER=<0|1> -D CXX=<compiler>
#   -D GENERATOR=<CMake generator> -P check.cmake
# Installs lagrain, builds the project beside this file with nothing but the installed copy, runs it.

# An old copy would hide a header that is no longer installed.
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${WORK} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${LAGRAIN} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -G ${GENERATOR}
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_PREFIX_PATH=${WORK}/prefix -D RENDER=${RENDER})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/discs)
if(RENDER)
  run(${WORK}/build/picture)
endif()
