#pragma once
#include <span>
#include <vector>

#include "ext/prepass/prepass.h"
#include "pbrt/lights/environment_portals.h"

namespace ext {

/// A ray towards an environment light, and whether it left the scene.
struct EnvironmentRay {
    Point3 p;
    Vector3 d;
    bool left;
};

/// The rays of TraceEnvironmentRays from a vertex to each light, if there are many vertices.
inline constexpr size_t kEnvironmentRaysPerVertex = 16;
/// Rays towards the environment lights from `count` of the vertices (at most all), spread over the picture. Their
/// directions follow radiance times cosine. Depends on the seed only.
std::vector<EnvironmentRay> TraceEnvironmentRays(PrepareContext &context, std::span<const LightId> lights,
                                                 std::span<const PrepassVertex> vertices, size_t count);

/// Finds a few rectangles that nearly all rays pass which leave the scene: windows, doors, the open side of a porch.
/// `rays`: those that left the scene and those that did not; `normals`: of surfaces all over the scene.
///
/// A portal lies in a wall, so its plane has the normal of a wall: the most frequent normals are tried, and the axes of
/// the scene. For every plane, at steps along its normal, the rays are counted in the cells of a grid where they cross
/// it. Rays that leave gather in the cells of the plane of the portal, while before and behind it they share their
/// cells with rays that meet a wall. The plane with the largest sum over its cells of (left - kBlocked blocked), where
/// that is positive, gives portals: the rectangles around its connected cells. Then the same is done with the rays that
/// do not pass them, until few are left.
///
/// The result is the same for any number of threads; empty if no rectangle is found.
std::vector<Portal> FindPortals(std::span<const EnvironmentRay> rays, std::span<const Normal3> normals);

/// Moves the borders of portals, by rays from the vertices through points in and around each of them. A portal that is
/// too large costs a few samples; radiance beside one that is too small is noisy. So a portal becomes the rectangle
/// around all rays that pass it or next to it, and portals that lie in others are removed.
std::vector<Portal> RefinePortals(const Scene &scene, std::span<const Portal> portals,
                                  std::span<const PrepassVertex> vertices, int seed);

}  // namespace ext
