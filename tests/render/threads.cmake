# render_learning_threads: render_learning with the thread sanitizer over the folders whose code runs on several threads or
# learns. The others are linked as they are, which hides their own races and saves two thirds of a build.
set(options -O1 -g1 -fsanitize=thread -fno-omit-frame-pointer -Wno-tsan)  # fences, in Boost only
pbrt_add_headers(thread_headers OPTIONS ${options})
set_target_properties(thread_headers PROPERTIES EXCLUDE_FROM_ALL ON)
set(objects)
foreach(library pbrt_core_folder pbrt_films_folder pbrt_lightsamplers_folder pbrt_transport_folder pbrt_integrators_folder
    ext_lightgroups ext_prepass ext_visibility ext_portals ext_octree ext_guiding)
  get_target_property(folder ${library} SOURCE_DIR)
  get_target_property(sources ${library} SOURCES)
  list(TRANSFORM sources PREPEND ${folder}/)
  add_library(threads_${library} OBJECT EXCLUDE_FROM_ALL ${sources})
  target_link_libraries(threads_${library} PRIVATE $<TARGET_PROPERTY:${library},LINK_LIBRARIES> pbrt_flags)
  list(APPEND objects threads_${library})
endforeach()
# As in src/pbrt/core/CMakeLists.txt, whose properties of files hold in that folder only.
set(core ${PROJECT_SOURCE_DIR}/src/pbrt/core)
set_source_files_properties(${core}/parallel.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON
  COMPILE_OPTIONS -fno-sanitize=thread COMPILE_DEFINITIONS PBRT_THREAD_SANITIZER)
if(TARGET pbrt_mpi)
  set_source_files_properties(${core}/connect_team.cpp PROPERTIES COMPILE_DEFINITIONS PBRT_MPI_MODULE="$<TARGET_FILE_NAME:pbrt_mpi>")
endif()

add_executable(render_learning_threads EXCLUDE_FROM_ALL frames_test.cpp learning_test.cpp)
foreach(target ${objects} render_learning_threads)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PBRT_UNITY})
  target_compile_options(${target} PRIVATE ${options})
  target_precompile_headers(${target} REUSE_FROM thread_headers)
endforeach()
# The standard library precedes the folders' archives: of those, objects are drawn in for a template that gtest misses too.
target_link_libraries(render_learning_threads PRIVATE ${objects} GTest::gtest GTest::gtest_main stdc++ test_support)
target_link_options(render_learning_threads PRIVATE -fsanitize=thread)
