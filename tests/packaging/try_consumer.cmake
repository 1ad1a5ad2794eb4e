# cmake -D build=… -D source=… -D examples=… -D scratch=… -D compiler=… -D ccache=… -D version=… -P try_consumer.cmake
cmake_minimum_required(VERSION 3.25)
set(prefix ${scratch}/prefix)
file(REMOVE_RECURSE ${scratch})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(flags "")
set(launcher "")
if(ccache)
  set(launcher ${ccache})
endif()
if(sanitize)
  set(flags "-fsanitize=${sanitize}")
endif()
run(${CMAKE_COMMAND} --install ${build} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${source} -B ${scratch}/consumer -G Ninja
  -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_COMPILER=${compiler} -D CMAKE_CXX_FLAGS=${flags}
  -D CMAKE_CXX_COMPILER_LAUNCHER=${launcher}
  -D CMAKE_PREFIX_PATH=${prefix} -D wanted_version=${version}
  -D examples=${examples})
run(${CMAKE_COMMAND} --build ${scratch}/consumer)
run(${scratch}/consumer/consumer)
run(${prefix}/bin/hydrapod --version)

# The numbered programs, each of which prints a number or a table.
set(machine ${prefix}/share/hydrapod/models/heavy-platform.toml)
function(run_example expected)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
  message("${output}")
  if(NOT output MATCHES "${expected}")
    message(FATAL_ERROR "expected ${expected}")
  endif()
endfunction()
run_example(" Hz  [a-z]" ${scratch}/consumer/01_modes ${machine})
run_example("rz +[0-9.]+ Hz" ${scratch}/consumer/02_bode ${machine})
run(${prefix}/bin/hydrapod rig ${machine} --duration 60 --excite "white all=2e-4" -o ${scratch}/run.h5)
run_example("Hz .- " ${scratch}/consumer/03_record_to_modes ${scratch}/run.h5)
file(WRITE ${scratch}/modes.csv "frequency [Hz],direction,deviation [%]\n4.1,x,0.2\n4.1,y,0.2\n")
run_example("nominal machine" ${scratch}/consumer/04_diagnose ${machine} ${scratch}/modes.csv)
