# What every target of this project is compiled with. Not exported: a consumer keeps its own warnings.
add_library(hydrapod_options INTERFACE)
target_compile_options(hydrapod_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
  # gcc 12 sees uninitialised and out-of-bounds reads in Eigen's inlined kernels where there are none
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow>
  # gcc before 13 calls the undefined values of its AVX-512 intrinsics uninitialised (gcc bug 105593),
  # 1290 times in this project; clang, which compiles the same files, still warns
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-uninitialized>)
# gcc's garbage collector takes a tenth of the time to compile a file; few files here need a GB.
set(few_collections
  "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1000000>")
# Vectors in structs are copied whole: in halves, as gcc does on many processors, whoever reads them next
# waits for both. A row of a study takes a third longer then.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-mmove-max=512 HYDRAPOD_MOVE_MAX)
if(HYDRAPOD_MOVE_MAX)
  set(hydrapod_whole_vectors -mmove-max=512 -mstore-max=512)
endif()
if(HYDRAPOD_NATIVE)
  target_compile_options(hydrapod_options INTERFACE -march=native ${hydrapod_whole_vectors})
endif()
# Hardened as Debian's packages are (dpkg-buildflags hardening=+all), and with the checks of libstdc++'s
# containers; tests/cli/hardening_test.cpp reads the binary. Sanitizers see more than all of these.
if(NOT HYDRAPOD_SANITIZE)
  target_compile_options(hydrapod_options INTERFACE
    -fPIC -fno-semantic-interposition -fstack-protector-strong -fstack-clash-protection
    $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},x86_64>:-fcf-protection>)
  target_compile_definitions(hydrapod_options INTERFACE
    _GLIBCXX_ASSERTIONS $<$<NOT:$<CONFIG:Debug>>:_FORTIFY_SOURCE=2>)
  target_link_options(hydrapod_options INTERFACE -pie -Wl,-z,relro -Wl,-z,now)
endif()
if(HYDRAPOD_SANITIZE)
  if(HYDRAPOD_BUILD_PYTHON)
    target_compile_options(hydrapod_options INTERFACE -fPIC)  # the library is part of the extension
  endif()
  add_compile_options(-fsanitize=${HYDRAPOD_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HYDRAPOD_SANITIZE})
endif()

# Compiles the sources of a target a few at a time, those of one of these folders together: most of the
# time goes to headers, which they share (report: 23 s for five files instead of 50 s). Names in anonymous
# namespaces are unique within such a folder. Folders full of Eigen take longer together: gcc inlines more.
set(hydrapod_unity_folders base calibration control data diagnosis identification model report rig
  signals simulation tasks)
function(hydrapod_unity target root)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(NOT source MATCHES "^${root}/(.*)/[^/]*[.]cpp$")
      continue()
    endif()
    set(folder ${CMAKE_MATCH_1})
    if(NOT folder IN_LIST hydrapod_unity_folders)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      continue()
    endif()
    math(EXPR number_${folder} "0${number_${folder}} + 1")
    math(EXPR group "(${number_${folder}} - 1) / 5")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
  endforeach()
endfunction()

# ccache looks into precompiled headers only with this sloppiness (its manual, "Precompiled headers"). With a
# base folder, which makes paths below it relative, a second checkout or build folder is served as well.
find_program(HYDRAPOD_CCACHE ccache)
if(HYDRAPOD_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${HYDRAPOD_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
  else()
    add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:-Xclang -fno-pch-timestamp>")
  endif()
endif()
