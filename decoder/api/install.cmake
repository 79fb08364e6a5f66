# What `cmake --install` puts where. Components: runtime (the program and the libraries it or others
# run with), development (headers, CMake and pkg-config files), python.
include(CMakePackageConfigHelpers)

set(TAGSMITH_MODULES_DIR ${CMAKE_INSTALL_LIBDIR}/tagsmith)
set(TAGSMITH_SHARE_DIR ${CMAKE_INSTALL_DATADIR}/tagsmith)
set(TAGSMITH_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/tagsmith)
set(TAGSMITH_PC_DIR ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# The program looks for what it loads late relative to itself, so that the tree can be moved.
file(RELATIVE_PATH modules_from_program ${CMAKE_INSTALL_FULL_BINDIR}
  ${CMAKE_INSTALL_FULL_LIBDIR}/tagsmith)
set_target_properties(tagsmith PROPERTIES INSTALL_RPATH "$ORIGIN/${modules_from_program}")
install(TARGETS tagsmith RUNTIME COMPONENT runtime)
install(TARGETS tagsmith_codecs LIBRARY DESTINATION ${TAGSMITH_MODULES_DIR} COMPONENT runtime)
install(TARGETS tagsmith_core tagsmith_files EXPORT tagsmithTargets
  LIBRARY COMPONENT runtime NAMELINK_COMPONENT development)
install(DIRECTORY templates surveys docs/schemas DESTINATION ${TAGSMITH_SHARE_DIR}
  COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)

# Man pages and completions come of the program itself.
set(manual ${PROJECT_BINARY_DIR}/manual)
add_custom_command(OUTPUT ${manual}/stamp
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:tagsmith> -DFOLDER=${manual}
    -DSTAMP=${manual}/stamp -P ${PROJECT_SOURCE_DIR}/decoder/api/manual.cmake
  DEPENDS tagsmith decoder/api/manual.cmake
  COMMENT "Writing man pages and completions")
add_custom_target(tagsmith_manual ALL DEPENDS ${manual}/stamp)
install(DIRECTORY ${manual}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
install(FILES ${manual}/completion/tagsmith COMPONENT runtime
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${manual}/completion/_tagsmith COMPONENT runtime
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${manual}/completion/tagsmith.fish COMPONENT runtime
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)

install(DIRECTORY decoder/api/include/tagsmith DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development)
install(EXPORT tagsmithTargets NAMESPACE tagsmith:: DESTINATION ${TAGSMITH_CMAKE_DIR}
  COMPONENT development)
write_basic_package_version_file(tagsmithConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES decoder/api/tagsmithConfig.cmake
  ${PROJECT_BINARY_DIR}/tagsmithConfigVersion.cmake
  DESTINATION ${TAGSMITH_CMAKE_DIR} COMPONENT development)

file(RELATIVE_PATH TAGSMITH_PC_TO_PREFIX ${CMAKE_INSTALL_PREFIX}/${TAGSMITH_PC_DIR}
  ${CMAKE_INSTALL_PREFIX})
foreach(name core files)
  configure_file(decoder/api/${name}.pc.in tagsmith-${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/tagsmith-${name}.pc DESTINATION ${TAGSMITH_PC_DIR}
    COMPONENT development)
endforeach()
