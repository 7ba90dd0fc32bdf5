# Embree's flat curves against ours: curve_shapes. Included by CMakeLists.txt; adds only this target.
add_executable(curve_shapes ${CMAKE_CURRENT_LIST_DIR}/curve_shapes.cpp)
target_link_libraries(curve_shapes PRIVATE pbrt_shapes_folder pbrt_flags embree)
