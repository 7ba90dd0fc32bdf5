# Would packets of rays pay: bench_ray_packets. Included by CMakeLists.txt; adds only this target.
add_executable(bench_ray_packets ${CMAKE_CURRENT_LIST_DIR}/ray_packets_bench.cpp)
target_link_libraries(bench_ray_packets PRIVATE pbrt_build_folder pbrt_plugins pbrt_accel_folder pbrt_flags)
target_precompile_headers(bench_ray_packets REUSE_FROM pbrt_headers)
