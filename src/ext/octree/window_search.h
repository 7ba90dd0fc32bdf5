#pragma once
#include <span>
#include <vector>

#include "ext/prepass/prepass.h"
#include "pbrt/lights/sky_windows.h"

namespace ext {

/// A ray towards a sky, and whether it left the scene.
struct SkyRay {
    Point3 p;
    Vector3 d;
    bool left;
};

/// Looks for a few rectangles that nearly all rays pass which leave the scene: windows, doors, the open side of a
/// porch. `rays`: those that left the scene and rays that did not; `normals`: of surfaces all over the scene.
///
/// A window lies in a wall, so its plane has the normal of a wall: the most frequent ones are tried, and the axes of
/// the scene. For every plane, at steps along its normal, the rays are counted in the cells of a grid where they cross
/// it. Rays that leave gather in the cells of the plane of the window, while before and behind it they share their
/// cells with rays that meet a wall. The plane with the largest sum over its cells of (left - kBlocked blocked), where
/// that is positive, gives windows: the rectangles around its connected cells. Then the same is done with the rays that
/// do not pass them, until few are left.
///
/// The result is the same for any number of threads; empty if no rectangle is found.
std::vector<SkyWindow> FindWindows(std::span<const SkyRay> rays, std::span<const Normal3> normals);

/// Where the borders of windows are: rays from the vertices through points in and around each of them tell. A window
/// that is too large costs a few samples; what shines past the border of one that is too small makes noise. So a window
/// becomes the rectangle around all that is seen through it and next to it, and windows that lie in others are left
/// out.
std::vector<SkyWindow> RefineWindows(const Scene &scene, std::span<const SkyWindow> windows,
                                     std::span<const PrepassVertex> vertices, int seed);

}  // namespace ext
