# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D NATIVE=<program> -D NODE=<node> -D MODULE=<script> -D WORK=<folder> -P check_same.cmake
# The program that was compiled for this machine and the one for browsers must print the same.
file(MAKE_DIRECTORY ${WORK})
execute_process(COMMAND ${NATIVE} OUTPUT_FILE ${WORK}/native.txt COMMAND_ERROR_IS_FATAL ANY)
# Where signs are wrong T may never become regular.
execute_process(COMMAND ${NODE} ${MODULE} TIMEOUT 300 OUTPUT_FILE ${WORK}/browser.txt
  RESULT_VARIABLE failed)
file(STRINGS ${WORK}/native.txt native)
file(STRINGS ${WORK}/browser.txt browser)
foreach(line other IN ZIP_LISTS native browser)
  if(NOT line STREQUAL other)
    message(FATAL_ERROR "natively:\n  ${line}\nin a browser:\n  ${other}")
  endif()
endforeach()
if(NOT failed EQUAL 0)
  message(FATAL_ERROR "node: ${failed}")
endif()
list(LENGTH native lines)
message(STATUS "${lines} lines are the same")
