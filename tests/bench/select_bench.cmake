# Cost of choosing a light: bench_select.
add_executable(bench_select ${CMAKE_CURRENT_LIST_DIR}/select_bench.cpp)
target_link_libraries(bench_select PRIVATE pbrt_lightsamplers_folder pbrt_flags benchmark::benchmark)
target_include_directories(bench_select PRIVATE ${PROJECT_SOURCE_DIR}/tests)
