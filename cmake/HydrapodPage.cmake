# The page of `hydrapod report`: web/ is bundled by npm's esbuild into one file and compiled into the
# library, so that nothing of this is needed when the program runs. Packages stand in <build>/web, not in
# the source folder. Without node and npm, or without npm's packages, the library is built all the same and
# `hydrapod report` says why it has no page.
find_program(HYDRAPOD_NODE NAMES node nodejs)
find_program(HYDRAPOD_NPM npm)

set(hydrapod_page ${CMAKE_CURRENT_BINARY_DIR}/web/page.cpp)
file(GLOB_RECURSE web_sources CONFIGURE_DEPENDS web/src/*)
# the tests also want a type checker and a driver for the browser
set(npm_omit dev)
if(HYDRAPOD_BUILD_TESTS)
  set(npm_omit "")
endif()
add_custom_command(OUTPUT ${hydrapod_page}
  COMMAND ${CMAKE_COMMAND}
    -D node=${HYDRAPOD_NODE} -D npm=${HYDRAPOD_NPM} -D omit=${npm_omit}
    -D source=${CMAKE_CURRENT_SOURCE_DIR}/web -D folder=${CMAKE_CURRENT_BINARY_DIR}/web
    -D page=${hydrapod_page}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/build_page.cmake
  DEPENDS ${web_sources} web/build.mjs web/shaders.mjs web/core/hydrapod.wasm web/core/NOTICES.txt web/package.json web/package-lock.json web/.npmrc
    cmake/build_page.cmake
  COMMENT "Bundling the report's page"
  VERBATIM)
