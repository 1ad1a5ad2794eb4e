# Writes `output`, a header with the commit of the sources, when it is another one than before.
# In a checkout git knows it; in an archive that git made (`git archive`) commit.txt holds it.
# Called at each build: cmake -Dsource=FOLDER -Doutput=FILE -P write_commit.cmake
cmake_minimum_required(VERSION 3.25)
set(commit "")
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/commit.txt archived LIMIT_COUNT 1)
if(archived MATCHES "^[0-9a-f]+$")
  set(commit ${archived})
elseif(EXISTS ${source}/.git)
  execute_process(COMMAND git -C ${source} describe --always --abbrev=40 --match= --dirty=-changed
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status
                  ERROR_QUIET)
  if(status EQUAL 0 AND described MATCHES "^[0-9a-f]+(-changed)?$")
    set(commit ${described})
  endif()
endif()
file(CONFIGURE OUTPUT ${output} CONTENT "#pragma once
/// Commit of the sources, empty where unknown; written at each build by write_commit.cmake.

namespace hydrapod::cli {

inline constexpr const char* commit = \"${commit}\";

}  // namespace hydrapod::cli
")
