# find_package(tagsmith 1 CONFIG COMPONENTS core files): the targets tagsmith::core (pictures in
# memory to readings, grades, positions, plans) and tagsmith::files (surveys, pictures and prints as
# files; links core). Without COMPONENTS both.
set(tagsmith_known_components core files)
if(NOT tagsmith_FIND_COMPONENTS)
  set(tagsmith_FIND_COMPONENTS ${tagsmith_known_components})
endif()
foreach(component IN LISTS tagsmith_FIND_COMPONENTS)
  if(component IN_LIST tagsmith_known_components)
    set(tagsmith_${component}_FOUND TRUE)
  elseif(tagsmith_FIND_REQUIRED_${component})
    set(tagsmith_FOUND FALSE)
    set(tagsmith_NOT_FOUND_MESSAGE
      "there is no component ${component}, expected some of: ${tagsmith_known_components}")
    return()
  endif()
endforeach()

include("${CMAKE_CURRENT_LIST_DIR}/tagsmithTargets.cmake")
