# Would resampled importance sampling pay: bench_ris.
if(TARGET ext_prepass)
  add_executable(bench_ris ${CMAKE_CURRENT_LIST_DIR}/ris_bench.cpp)
  target_link_libraries(bench_ris PRIVATE pbrt_build_folder pbrt_plugins ext_prepass pbrt_flags)
  target_precompile_headers(bench_ris REUSE_FROM pbrt_headers)
endif()
