#pragma once
#include <string>
#include <vector>

#include "support/render_scene.h"
#include "support/scene_text.h"

namespace pbrt::test {

/// Many renders of few samples: with 46 degrees of freedom 4.4 standard errors are as rare as 5.6 with 14.
constexpr int kRenders = 24;

/// Small views of a room corner, to compare integrators that follow light from the lights with paths from the camera.
struct View {
    std::string name;
    std::string camera = "Camera 'perspective' 'float fov' 50";
    std::string filter = "box";
    std::string filmType = "rgb";
    std::string film{};         ///< further parameters
    std::string objects{};      ///< in the room
    std::string parameters{};   ///< of the integrator that is compared, further ones
    int samples = 20;           ///< per pixel, of each render of the integrator that is compared
    int renders = kRenders;     ///< of that integrator
    int referenceSamples = 32;  ///< per pixel, of each of kRenders renders of the reference
    int depth = 3;
    /// False: light that only camera paths see, or fog about a camera, where a light path's vertices come as near to
    /// the lens as they like, and so the variance is without bounds.
    bool isForLightPath = true;
    std::string reference = "path";  ///< the integrator that is compared to
    std::string media{};             ///< before the camera
};
void PrintTo(const View &v, std::ostream *out);
const std::vector<View> &AllViews();
/// With media: compared to volpath.
const std::vector<View> &FoggyViews();

/// The views of these names, of either kind. For integrators that share the code of a view with another one, which is
/// tested with all views: mlt traces pairs of subpaths as bdpt does, and the camera paths of sppm are those of path.
std::vector<View> ViewsNamed(const std::vector<std::string> &names);

/// A camera that nothing can be connected to.
extern const std::string kRealisticCamera;

constexpr int kViewSize = 16;
Image RenderView(const View &v, const std::string &integrator, int seed, int samples);

/// Expects the mean of the reference: of all renders, no tile and colour differs, after `allowed` of the mean of the
/// picture, by what chance explains once in 14,000 tiles. The difference that would be noticed, in the mean over the
/// tiles and relative to the picture's mean, must be below `maxBias`, or the comparison fails.
void CheckMean(const View &v, const std::string &integrator, double maxBias, double allowed = 0);

/// Expects the same bits for any number of threads.
void CheckThreads(const View &v, const std::string &integrator, int samples);

/// Expects the mean of path under each choice of light sampler that the build has, at least two of them, in a
/// view with a lamp, a point light and a sky; `allowed`: see CheckMean.
void CheckLightSamplers(
    View v, const std::string &integrator,
    const std::vector<std::string> &choices = {"'string lightsampler' 'uniform'", "'string lightsampler' 'bvh'",
                                               "'string lightsampler' 'octree' 'float octree.budget' .08",
                                               "'string lightsampler' 'octree' 'float octree.budget' .08 "
                                               "'string octree.portals' 'always'"},
    double allowed = 0);

}  // namespace pbrt::test
