# Is the module that is kept the one that the sources make?
file(SHA256 ${made} of_sources)
file(SHA256 ${kept} of_kept)
if(NOT of_sources STREQUAL of_kept)
  message(FATAL_ERROR "${kept} is not what its sources make; take the new one: cp ${made} ${kept}")
endif()
