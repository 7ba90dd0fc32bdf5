# Rays per second of the accelerator. Included by CMakeLists.txt; adds only this target.
add_executable(rays_bench ${CMAKE_CURRENT_LIST_DIR}/rays_bench.cpp)
target_link_libraries(rays_bench PRIVATE pbrt_accel_folder pbrt_flags benchmark::benchmark)
