# Installs the npm packages that package-lock.json names, where they are not there yet, and writes the bags of MCAP with
# them: cmake -DNODE= -DNPM= -DFOLDER= -DRECORDINGS= -P write_mcap.cmake
set(installed ${FOLDER}/node_modules/.package-lock.json)
if(NOT EXISTS ${installed} OR ${FOLDER}/package-lock.json IS_NEWER_THAN ${installed})
  execute_process(COMMAND ${NPM} ci --no-audit --no-fund WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE failure)
  if(failure)
    message("npm ci has failed, as without a network: no bags of MCAP")
    return()
  endif()
endif()
execute_process(COMMAND ${NODE} write_mcap.mjs ${RECORDINGS} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE failure)
if(failure)
  message(FATAL_ERROR "write_mcap.mjs: ${failure}")
endif()
