#pragma once
#include "pbrt/films/visible_surface.h"
#include "pbrt/scene/footprint.h"
#include "pbrt/transport/medium_track.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// What every walk of a path needs. Refers to the scene and the camera.
struct PathContext {
    const Scene &scene;
    const Camera &camera;
    int samplesPerPixel = 1;      ///< for texture footprints
    bool needsFootprints = true;  ///< some material uses filter footprints
};

/// A path from the camera, followed step by step; all integrators use it. The caller decides what happens at a vertex:
///
///     PathWalk walk(context, cameraRay);
///     while (walk.Next() == PathWalk::Met::Surface) {
///         if (!walk.FindScattering(lambda)) continue;       // does not scatter: the walk continues behind it
///         ... walk.Vertex().bsdf.Sample(...) ...
///         walk.Scatter(sample);
///     }
///
/// Where there are media, the caller follows the light through them after every step of Next: MediumAhead,
/// ThroughMedium.
class PathWalk {
  public:
    /// After more than this many surfaces in a row that do not scatter, the path ends at the next surface.
    static constexpr int MaxPassed = 64;
    enum class Met { Surface, Nothing, TooManyInterfaces };

    /// `visible`, if not null, receives the first surface that scatters.
    PathWalk(const PathContext &context, const CameraRay &start, std::optional<VisibleSurface> *visible = nullptr)
        : context_(context), ray_(start.ray), differential_(start.differential), visible_(visible),
          startsWithDifferential_(start.differential.valid) {
        ray_.medium = context.scene.CameraMedium();
    }

    /// A walk that starts anywhere, such as on a light; the ray has its medium.
    PathWalk(const PathContext &context, const Ray &start)
        : context_(context), ray_(start), visible_(nullptr), startsWithDifferential_(false) {}

    /// Follows the ray to the next surface, whose point is then in Vertex(). Nothing: the ray leaves the scene.
    Met Next();
    /// Reports the emission that the ray meets: calls visit(radiance, light, p, n) for the light of the surface met, or
    /// for every infinite light once nothing was met (where p and n are zero). Radiance arrives along the ray and is
    /// not zero.
    template <class Visit>
    void ForEachEmission(const SampledWavelengths &lambda, Visit &&visit) const;
    /// Completes Vertex() by its filter footprint and its BSDF. False: the surface does not scatter, and the ray goes
    /// on behind it. May terminate secondary wavelengths.
    bool FindScattering(SampledWavelengths &lambda);
    /// Roughens the vertex's BSDF.
    void Regularize() { vertex_.bsdf.Regularize(); }
    /// Leaves the vertex by a BSDF sample. Ray differentials survive specular scattering only.
    void Scatter(const BsdfSample &sample);
    /// Leaves the vertex in a direction (unit) that did not come from its BSDF.
    void Leave(const Vector3 &wi);
    /// The medium between the vertex left and what Next has met; null: vacuum.
    const Medium *MediumAhead() const { return context_.scene.MediumAt(ray_.medium); }
    /// Follows light through that medium: TrackMedium.
    template <class Emit>
    MediumEvent ThroughMedium(const SampledWavelengths &lambda, Float u, Rng &rng, bool emits, SpectralWeights &weights,
                              Emit &&emit) const {
        return TrackMedium(MediumAhead()->On(ray_, left_ ? Infinity : vertex_.point.t, lambda), u, rng, emits, weights,
                           emit);
    }
    /// Scatters in the medium before the ray reaches what Next has met: at a place on the ray, into a direction (unit).
    void ScatterInMedium(const Point3 &p, const Vector3 &wi);
    /// Moves the path to the vertex where light that went below the surface comes out.
    void MoveTo(const PathVertex &vertex) { vertex_ = vertex; }

    /// Ends the walk at a surface met before FindScattering. If `visible` is still empty, continues to the first
    /// surface that scatters.
    void End(SampledWavelengths lambda) {
        while (visible_ && !*visible_ && !FindScattering(lambda) && Next() == Met::Surface) {
        }
    }

    const PathVertex &Vertex() const { return vertex_; }
    const Ray &GetRay() const { return ray_; }

  private:
    void FindFootprint();
    void RecordVisible(const SampledWavelengths &lambda) const;

    const PathContext &context_;
    Ray ray_;
    RayDifferential differential_;
    PathVertex vertex_;
    int passed_ = 0;
    bool left_ = false;  ///< the ray met nothing
    std::optional<VisibleSurface> *visible_;
    const bool startsWithDifferential_;
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
