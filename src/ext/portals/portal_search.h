#pragma once
#include <span>
#include <vector>

#include "ext/prepass/prepass.h"
#include "pbrt/lights/environment_portals.h"

namespace ext {

/// Ray towards an environment light, and whether it left the scene.
struct EnvironmentRay {
    Point3 p;
    Vector3 d;
    bool left;
};

/// Detects a few rectangles (windows, doors, porch openings) that nearly all rays pass which leave the scene. `rays`:
/// all, also those that did not leave; `normals`: of surfaces all over the scene.
///
/// A portal lies in a wall and shares its normal, so the most frequent surface normals and the axes are candidates. For
/// planes at steps along each normal, rays are counted in grid cells at their crossing. In the portal's plane, leaving
/// rays concentrate in a few cells; before and behind it they share cells with blocked rays. The plane that maximizes
/// the sum over cells of (left - kBlocked blocked), where positive, gives portals: the bounding rectangles of its
/// connected cells. The search is repeated on the rays that miss them until few are left.
///
/// With openings on many sides, most planes inside the room have cells that only leaving rays happen to pass. A second
/// search counts a cell's gain in one half of the rays if the other half has a gain there. It resolves small openings
/// less well, so the portals with the lower second moment of the rays are returned.
///
/// Deterministic for any number of threads; empty if no rectangle is found.
std::vector<Portal> FindPortals(std::span<const EnvironmentRay> rays, std::span<const Normal3> normals);

/// Refines portal borders by rays from the vertices through points in and around each portal. An oversized portal costs
/// a few samples; radiance beside an undersized one is noisy. So a portal becomes the bounding rectangle of all rays
/// that pass it or close by, and portals inside others are removed.
std::vector<Portal> RefinePortals(const Scene &scene, std::span<const Portal> portals,
                                  std::span<const PrepassVertex> vertices, int seed);

}  // namespace ext
