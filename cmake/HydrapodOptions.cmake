# What every target of this project is compiled with. Not exported: a consumer keeps its own warnings.
add_library(hydrapod_options INTERFACE)
target_compile_options(hydrapod_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
  # gcc 12 sees uninitialised and out-of-bounds reads in Eigen's inlined kernels where there are none
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow>)
# gcc's garbage collector takes a tenth of the time to compile a file; few files here need a GB.
set(few_collections
  "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1000000>")
if(HYDRAPOD_NATIVE)
  target_compile_options(hydrapod_options INTERFACE -march=native)
endif()
if(HYDRAPOD_SANITIZE)
  add_compile_options(-fsanitize=${HYDRAPOD_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HYDRAPOD_SANITIZE})
endif()

# ccache looks into precompiled headers only with these settings (its manual, "Precompiled headers").
find_program(HYDRAPOD_CCACHE ccache)
if(HYDRAPOD_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${HYDRAPOD_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
  else()
    add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:-Xclang -fno-pch-timestamp>")
  endif()
endif()
