#pragma once
#include "pbrt/paths/vertex.h"
#include "pbrt/scene/footprint.h"

namespace pbrt {

/// What every walk of a path needs. Refers to the scene and the camera.
struct PathContext {
    const Scene &scene;
    const Camera &camera;
    int samplesPerPixel = 1;     ///< for texture footprints
    bool needsFootprints = true; ///< some material looks at filter footprints
};

/// A path from the camera, step by step: the only place where one is walked. Whoever walks decides what happens at a
/// vertex:
///
///     PathWalk walk(context, cameraRay);
///     while (walk.Next() == PathWalk::Met::Surface) {
///         if (!walk.FindScattering(lambda)) continue;       // it lets light pass, and so the walk goes on behind it
///         ... walk.Vertex().bsdf.Sample(...) ...
///         walk.Scatter(sample);
///     }
class PathWalk {
  public:
    /// Surfaces that do not scatter may follow each other this often; at the next one the path ends.
    static constexpr int MaxPassed = 64;
    enum class Met { Surface, Nothing, TooManyInterfaces };

    PathWalk(const PathContext &context, const CameraRay &start)
        : context_(context), ray_(start.ray), differential_(start.differential) {}

    /// Follows the ray to the next surface, whose point is then in Vertex(). Nothing: the ray leaves the scene.
    Met Next();
    /// What the ray meets shines: calls visit(radiance, light, p, n) for the light of the surface met, or for every
    /// infinite light once nothing was met (where p and n are zero). Radiance arrives along the ray and is not zero.
    template <class Visit>
    void ForEachEmission(const SampledWavelengths &lambda, Visit &&visit) const;
    /// Completes Vertex() by its filter footprint and its BSDF. False: the surface does not scatter, and the ray goes on
    /// behind it. May terminate secondary wavelengths.
    bool FindScattering(SampledWavelengths &lambda);
    /// Roughens the vertex's BSDF.
    void Regularize() { vertex_.bsdf.Regularize(); }
    /// Leaves the vertex by a BSDF sample. Ray differentials survive specular scattering only.
    void Scatter(const BsdfSample &sample);
    /// Leaves the vertex in a direction (unit) that did not come from its BSDF.
    void Leave(const Vector3 &wi);
    /// The path goes on from another place, where light that went below the surface comes out.
    void MoveTo(const PathVertex &vertex) { vertex_ = vertex; }

    const PathVertex &Vertex() const { return vertex_; }
    const Ray &GetRay() const { return ray_; }
    const RayDifferential &Differential() const { return differential_; }

  private:
    void FindFootprint();

    const PathContext &context_;
    Ray ray_;
    RayDifferential differential_;
    PathVertex vertex_;
    int passed_ = 0;
    bool left_ = false;  ///< the ray met nothing
};

template <class Visit>
void PathWalk::ForEachEmission(const SampledWavelengths &lambda, Visit &&visit) const {
    const Scene &scene = context_.scene;
    const SurfacePoint &point = vertex_.point;
    if (left_) {
        scene.Lights().ForEachBeyond(ray_.o, ray_.d, lambda, [&](const SampledSpectrum &Le, LightId id) {
            visit(Le, id, Point3(0), Normal3(0));
        });
    } else if (SampledSpectrum Le = EmittedRadiance(scene, point, lambda)) {
        visit(Le, point.light, point.p, point.n);
    }
}

}  // namespace pbrt
