# Finds an installed library: for find_package(sightlines CONFIG). Put this file and sightlines-system.cmake into
# PREFIX/lib/cmake/sightlines, headers into PREFIX/include, and the library, static or dynamic, into PREFIX/lib.
get_filename_component(_sightlines_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET sightlines::sightlines)
  find_library(_sightlines_library NAMES sightlines_capi PATHS "${_sightlines_prefix}/lib" NO_DEFAULT_PATH NO_CACHE)
  if(NOT _sightlines_library)
    set(sightlines_FOUND FALSE)
    set(sightlines_NOT_FOUND_MESSAGE "there is no library sightlines_capi in ${_sightlines_prefix}/lib")
    return()
  endif()
  add_library(sightlines::sightlines UNKNOWN IMPORTED)
  set_target_properties(sightlines::sightlines PROPERTIES
    IMPORTED_LOCATION "${_sightlines_library}"
    INTERFACE_INCLUDE_DIRECTORIES "${_sightlines_prefix}/include")
  include("${CMAKE_CURRENT_LIST_DIR}/sightlines-system.cmake")
  sightlines_system_libraries(sightlines::sightlines)
endif()
