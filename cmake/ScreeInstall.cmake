# What `cmake --install` puts where, what find_package(Scree) finds, and the Debian package that cpack makes.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(SCREE_CMAKE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/Scree")

# Everything that is installed, as one target: workflows/run builds the tools alone, and `cmake --install` builds nothing by itself. So the first
# thing that an install does is to build what is missing; for a user who may not write to the build folder, after a build of all, that is nothing.
add_custom_target(scree-installed)
install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${CMAKE_BINARY_DIR}\" --target scree-installed RESULT_VARIABLE code
    OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR \"scree: what is to be installed cannot be built in ${CMAKE_BINARY_DIR}:\\n\${said}\")
  endif()")

# scree_install_library(scree_X): the library, as Scree::X, and the headers beside it.
function(scree_install_library target)
  string(REPLACE "scree_" "" name "${target}")
  add_library(Scree::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/scree>")
  add_dependencies(scree-installed ${target})
  install(TARGETS ${target} EXPORT ScreeTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  file(RELATIVE_PATH folder "${CMAKE_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
  install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/scree/${folder}"
    FILES_MATCHING PATTERN "*.hpp" PATTERN "*.inc" PATTERN "*-inl.hpp" EXCLUDE)
endfunction()

# scree_install_tool(scree-X): the program, with its manual page and completion, which it writes itself.
function(scree_install_tool target)
  install(TARGETS ${target})
  set(page "${CMAKE_BINARY_DIR}/manual/${target}.1")
  set(completion "${CMAKE_BINARY_DIR}/completion/${target}")
  add_custom_command(OUTPUT "${page}" "${completion}"
    COMMAND ${CMAKE_COMMAND} -E make_directory "${CMAKE_BINARY_DIR}/manual" "${CMAKE_BINARY_DIR}/completion"
    COMMAND $<TARGET_FILE:${target}> --print-manual-page > "${page}"
    COMMAND $<TARGET_FILE:${target}> --print-completion > "${completion}"
    DEPENDS ${target} VERBATIM)
  add_custom_target(${target}-manual ALL DEPENDS "${page}" "${completion}")
  add_dependencies(scree-installed ${target}-manual)
  install(FILES "${page}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
  install(FILES "${completion}" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")
endfunction()

# scree_install_package(): once, at the end. Everything that is not built.
function(scree_install_package)
  install(EXPORT ScreeTargets NAMESPACE Scree:: DESTINATION "${SCREE_CMAKE_DIR}")
  configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/ScreeConfig.cmake.in" "${CMAKE_BINARY_DIR}/ScreeConfig.cmake"
    INSTALL_DESTINATION "${SCREE_CMAKE_DIR}")
  # before 1.0 a minor version may change an interface
  write_basic_package_version_file("${CMAKE_BINARY_DIR}/ScreeConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
  install(FILES "${CMAKE_BINARY_DIR}/ScreeConfig.cmake" "${CMAKE_BINARY_DIR}/ScreeConfigVersion.cmake"
    "${PROJECT_SOURCE_DIR}/cmake/FindZoltan.cmake" DESTINATION "${SCREE_CMAKE_DIR}")
  install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION "${CMAKE_INSTALL_DOCDIR}")
  install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME copyright)
  install(FILES decomposer/CASE.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")

  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_NAME scree)
  set(CPACK_PACKAGE_VENDOR "The Scree authors")
  set(CPACK_PACKAGE_CONTACT "The Scree authors")
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Discrete element method with rigid particles of any triangulated shape")
  set(CPACK_PACKAGE_DESCRIPTION "Four tools, from the mesh on disk to the figure in the report: scree-mesher checks, imports and
generates shapes, scree-decomposer packs a case into a scene, scree-solver moves the bodies on
threads and MPI ranks, scree-post makes ParaView files, tables, pictures and a report.")
  set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_STRIP_FILES ON)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  # the Python package in it does nothing without numpy and h5py; pictures alone need a display
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "openmpi-bin, python3 (>= 3.11), python3-h5py, python3-numpy")
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "xvfb, libgl1-mesa-dri")
  set(CPACK_DEBIAN_PACKAGE_SUGGESTS "ffmpeg, paraview, snakemake, python3-matplotlib, python3-pandas")
  include(CPack)
endfunction()
