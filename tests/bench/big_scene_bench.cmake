# How fast a big scene is read: bench_big_scene.
add_executable(bench_big_scene ${CMAKE_CURRENT_LIST_DIR}/big_scene_bench.cpp)
target_link_libraries(bench_big_scene PRIVATE pbrt_build_folder pbrt_plugins pbrt_flags)
target_precompile_headers(bench_big_scene REUSE_FROM pbrt_headers)
