# What `cmake --install` copies, and the Debian package that `cpack` makes of it. An installed folder may be moved:
# programs find what belongs to them relative to themselves.

set(PBRT_PROGRAMS pbrt imgtool)
if(PBRT_EXT)
  list(APPEND PBRT_PROGRAMS lightlab)
endif()
set(place "")
if(PBRT_INSTRUCTION_SETS)
  if(PBRT_NATIVE)
    message(FATAL_ERROR "PBRT_INSTRUCTION_SETS goes with PBRT_NATIVE=OFF")
  endif()
  # The programs of each set are an installed folder of their own inside lib/pbrt_octree, made by a build like this one.
  # What users start is the launcher, which chooses.
  include(ExternalProject)
  foreach(set IN LISTS PBRT_INSTRUCTION_SETS)
    ExternalProject_Add(for_${set} SOURCE_DIR ${PROJECT_SOURCE_DIR} BINARY_DIR ${PROJECT_BINARY_DIR}/for-${set}
      CMAKE_ARGS -DPBRT_NATIVE=OFF -DPBRT_MARCH=${set} -DPBRT_EXT=${PBRT_EXT} -DPBRT_TESTS=OFF -DPBRT_BENCH=OFF
        -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
      BUILD_ALWAYS ON
      INSTALL_COMMAND ${CMAKE_COMMAND} --install <BINARY_DIR> --component programs --strip
        --prefix ${PROJECT_BINARY_DIR}/sets/${set})
  endforeach()
  install(DIRECTORY ${PROJECT_BINARY_DIR}/sets/ DESTINATION lib/pbrt_octree USE_SOURCE_PERMISSIONS)
  foreach(program IN LISTS PBRT_PROGRAMS)
    install(PROGRAMS $<TARGET_FILE:pbrt_launcher> DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME ${program})
  endforeach()
  set(place lib/pbrt_octree/x86-64/)
endif()
install(TARGETS ${PBRT_PROGRAMS} RUNTIME DESTINATION ${place}${CMAKE_INSTALL_BINDIR} COMPONENT programs)
install(TARGETS pbrt_oiio LIBRARY DESTINATION ${place}lib/pbrt_octree COMPONENT programs)
if(PBRT_MPI)
  install(TARGETS pbrt_mpi LIBRARY DESTINATION ${place}lib/pbrt_octree COMPONENT programs)
endif()
if(PBRT_EXT)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/ext/lab/lightlab/report DESTINATION ${place}share/pbrt_octree
    COMPONENT programs PATTERN __pycache__ EXCLUDE)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/NOTICE.txt ${PROJECT_SOURCE_DIR}/docs/changelog.md
  DESTINATION share/doc/pbrt-octree)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE.txt DESTINATION share/doc/pbrt-octree RENAME copyright)

# One file completes all three programs: it runs them with --help.
foreach(program IN LISTS PBRT_PROGRAMS)
  install(FILES ${PROJECT_SOURCE_DIR}/src/pbrt/cmd/completion.bash DESTINATION share/bash-completion/completions
    RENAME ${program})
endforeach()

# Manual pages are made from --help.
find_program(HELP2MAN help2man)
if(HELP2MAN)
  set(pages "")
  set(about_pbrt "render pbrt-v4 scenes, choosing lights by learned visibility")
  set(about_lightlab "compare light samplers on a scene")
  set(about_imgtool "inspect, convert and compare images")
  foreach(program IN LISTS PBRT_PROGRAMS)
    set(page ${PROJECT_BINARY_DIR}/man/${program}.1)
    add_custom_command(OUTPUT ${page} DEPENDS ${program} VERBATIM
      COMMAND ${CMAKE_COMMAND} -E env SOURCE_DATE_EPOCH=0 ${HELP2MAN} --no-info "--name=${about_${program}}"
        "--version-string=${program} ${PROJECT_VERSION}" --output=${page} $<TARGET_FILE:${program}>)
    list(APPEND pages ${page})
  endforeach()
  add_custom_target(man ALL DEPENDS ${pages})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
else()
  message(STATUS "help2man is not installed: no manual pages")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pbrt-octree)
set(CPACK_PACKAGE_VENDOR "pbrt_octree")
set(CPACK_PACKAGE_CONTACT "the maintainers of pbrt_octree <maintainers@users.noreply.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Renderer for pbrt-v4 scenes with learned light visibility")
set(CPACK_PACKAGE_DESCRIPTION "Reads pbrt-v4 scene files and renders the same images as pbrt-v4. Its light sampler
learns the visibility of lights in each region of a scene in a short prepass. Includes lightlab, which compares light
samplers, and imgtool, which inspects images.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# dpkg-shlibdeps resolves the module's libraries, too; the module itself is private.
set(CPACK_DEB_COMPONENT_INSTALL OFF)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS $<TARGET_FILE_DIR:pbrt_oiio>)
# lightlab draws its charts and its page with these.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3, python3-numpy, python3-matplotlib")
if(PBRT_NATIVE)
  # Such a package runs on machines like this one only; its name says so.
  set(CPACK_PACKAGE_NAME pbrt-octree-native)
endif()
include(CPack)
