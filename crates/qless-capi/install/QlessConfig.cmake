# Targets: Qless::qless (shared) and Qless::qless_static.
get_filename_component(qless_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET Qless::qless)
  add_library(Qless::qless SHARED IMPORTED)
  set_target_properties(Qless::qless PROPERTIES
    IMPORTED_LOCATION "${qless_prefix}/lib/libqless.so"
    INTERFACE_INCLUDE_DIRECTORIES "${qless_prefix}/include")
  find_package(Threads REQUIRED)
  add_library(Qless::qless_static STATIC IMPORTED)
  set_target_properties(Qless::qless_static PROPERTIES
    IMPORTED_LOCATION "${qless_prefix}/lib/libqless.a"
    INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m"
    INTERFACE_INCLUDE_DIRECTORIES "${qless_prefix}/include")
endif()
unset(qless_prefix)
