# Cost of choosing a light in a real scene: bench_scene_select.
if(TARGET ext_prepass)
  add_executable(bench_scene_select ${CMAKE_CURRENT_LIST_DIR}/scene_select_bench.cpp)
  target_link_libraries(bench_scene_select PRIVATE pbrt_build_folder pbrt_plugins ext_prepass pbrt_flags)
  target_precompile_headers(bench_scene_select REUSE_FROM pbrt_headers)
endif()
