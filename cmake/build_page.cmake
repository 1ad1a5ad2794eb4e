# Run by cmake/HydrapodPage.cmake: installs npm's packages into `folder` where the lock file is new, bundles
# the page of `source` and writes it to `page`. Where that cannot be done, `page` holds the reason
# and is made old, so that the next build tries again.
cmake_minimum_required(VERSION 3.25)

function(give_up reason)
  message(WARNING "hydrapod report is built without its page: ${reason}")
  file(WRITE ${page} "#include \"page.hpp\"
namespace hydrapod::report {
std::string_view page_template() { return {}; }
std::string_view why_no_page() { return R\"why(${reason})why\"; }
}  // namespace hydrapod::report
")
  execute_process(COMMAND touch -d 2000-01-01 ${page})
endfunction()

# The last lines of what a program said.
function(tail text result)
  string(STRIP "${text}" text)
  string(LENGTH "${text}" length)
  set(most 400)
  if(length GREATER most)
    math(EXPR begin "${length} - ${most}")
    string(SUBSTRING "${text}" ${begin} ${most} text)
  endif()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

if(NOT node OR NOT npm)
  give_up("there was no node or no npm when it was built; install nodejs and npm and build again")
  return()
endif()

file(MAKE_DIRECTORY ${folder})
set(stamp ${folder}/installed)
file(SHA256 ${source}/package-lock.json lock)
string(APPEND lock " omit ${omit}")
set(installed "")
if(EXISTS ${stamp})
  file(READ ${stamp} installed)
endif()
if(NOT installed STREQUAL lock)
  foreach(file package.json package-lock.json .npmrc)
    file(COPY_FILE ${source}/${file} ${folder}/${file})
  endforeach()
  set(command ${npm} ci)
  if(omit)
    list(APPEND command --omit=${omit})
  endif()
  execute_process(COMMAND ${command} WORKING_DIRECTORY ${folder}
    RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT status EQUAL 0)
    tail("${said}" said)
    give_up("npm could not install its packages (web/package.json); it said: ${said}")
    return()
  endif()
  file(WRITE ${stamp} "${lock}")
endif()

execute_process(COMMAND ${node} ${source}/build.mjs ${page} WORKING_DIRECTORY ${folder}
  RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "bundling web/src failed")
endif()
