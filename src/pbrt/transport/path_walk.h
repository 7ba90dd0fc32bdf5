#pragma once
#include "pbrt/films/film.h"
#include "pbrt/samplers/sampler.h"
#include "pbrt/scene/shading.h"
#include "pbrt/transport/medium_track.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Shared inputs of path walks. Refers to scene and camera.
struct PathContext {
    const Scene &scene;
    const Camera &camera;
    int samplesPerPixel = 1;      ///< for texture footprints
    bool needsFootprints = true;  ///< some material uses filter footprints
};

/// A vertex that PathWalk::NextVertex has reached.
struct ReachedVertex {
    const HenyeyGreenstein *phase = nullptr;  ///< in a medium; null: at the surface PathWalk::Vertex()
    Point3 p{};                               ///< in a medium
};

/// A path from the camera, traced step by step; used by all integrators. The caller handles the vertices:
///
///     PathWalk walk(context, cameraRay);
///     while (walk.Next() == PathWalk::Met::Surface) {
///         if (!walk.FindScattering(lambda)) continue;       // interface surface: continues behind it
///         ... walk.Vertex().bsdf.Sample(...) ...
///         walk.Scatter(sample);
///     }
///
/// With media, the caller tracks them after every Next (MediumAhead, ThroughMedium), or leaves both to NextVertex.
class PathWalk {
  public:
    /// After more than this many consecutive non-scattering surfaces, the path ends at the next surface.
    static constexpr int MaxPassed = 64;
    enum class Met { Surface, Nothing, TooManyInterfaces };

    /// `visible`, if not null, receives the first scattering surface.
    PathWalk(const PathContext &context, const CameraRay &start, std::optional<VisibleSurface> *visible = nullptr)
        : context_(context), ray_(start.ray), differential_(start.differential), fromCamera_(true), visible_(visible),
          startsWithDifferential_(start.differential.valid) {
        ray_.medium = context.scene.CameraMedium();
    }

    /// A walk with an arbitrary start, such as a light; the ray carries its medium.
    PathWalk(const PathContext &context, const Ray &start)
        : context_(context), ray_(start), visible_(nullptr), startsWithDifferential_(false) {}

    /// Traces the ray to the next surface, stored in Vertex(). Nothing: the ray leaves the scene.
    Met Next();
    /// Calls visit(radiance, light, p, n) for the light of the surface hit, or for every infinite light if nothing was
    /// hit (p and n are zero). Radiance arrives along the ray and is nonzero.
    void ForEachEmission(const SampledWavelengths &lambda, auto &&visit) const;
    /// Completes Vertex() with filter footprint and BSDF. Returns false for a non-scattering surface; the ray then
    /// continues behind it. May terminate secondary wavelengths.
    bool FindScattering(SampledWavelengths &lambda);
    /// The same with media. If these have made termination more or less probable by the first wavelength, to drop the
    /// others from contributions before would be biased: secondary wavelengths then end in `weights` only.
    bool FindScattering(SampledWavelengths &lambda, SpectralWeights &weights);
    /// Next and FindScattering up to the next scattering surface, with media ignored. False: the path ends.
    bool NextSurface(SampledWavelengths &lambda) {
        while (Next() == Met::Surface)
            if (FindScattering(lambda)) return true;
        return false;
    }
    /// Continues to the next vertex in a medium or at a surface, through interface surfaces. Empty: the path ends.
    ///
    ///   track() -> MediumEvent   follows the ray through MediumAhead(), with `weights`
    ///   arrive(met)              before the vertex at a surface or interface, or when the ray leaves the scene
    std::optional<ReachedVertex> NextVertex(SampledWavelengths &lambda, SpectralWeights &weights, auto &&track,
                                            auto &&arrive);
    /// The same by delta tracking with numbers of `rng`; emission is ignored.
    std::optional<ReachedVertex> NextVertex(SampledWavelengths &lambda, SpectralWeights &weights, Rng &rng);
    void Regularize() { vertex_.bsdf.Regularize(); }
    /// Leaves the vertex by a BSDF sample. Ray differentials survive specular scattering only.
    void Scatter(const BsdfSample &sample);
    /// Leaves the vertex by a sample of its BSDF, which is returned. Empty: absorbed.
    std::optional<BsdfSample> SampleScattering(Rng &rng);
    /// Leaves the vertex in a direction (unit) not sampled from its BSDF.
    void Leave(const Vector3 &wi);
    /// Medium between the previous vertex and the hit of Next; null: vacuum.
    const Medium *MediumAhead() const { return context_.scene.MediumAt(ray_.medium); }
    /// TrackMedium up to the hit of Next. The sampler gives the number of the first distance; it and the ray seed those
    /// of all others along the ray: sampler dimensions cost more time and are no better here.
    MediumEvent ThroughMedium(const SampledWavelengths &lambda, Sampler &sampler, bool emits, SpectralWeights &weights,
                              auto &&emit) const {
        const Float u = sampler.Get1D();
        Rng rng(Hash(ray_.o, ray_.d, u));
        return TrackMedium(MediumOnRayAhead(lambda), u, rng, emits, weights, emit);
    }
    /// The same without emission; all numbers are of `rng`.
    MediumEvent ThroughMedium(const SampledWavelengths &lambda, Rng &rng, SpectralWeights &weights) const;
    /// Scatters in the medium before the hit of Next: at a point on the ray, into a direction (unit).
    void ScatterInMedium(const Point3 &p, const Vector3 &wi);
    /// Moves the path to the exit vertex of subsurface scattering.
    void MoveTo(const PathVertex &vertex) { vertex_ = vertex; }

    /// Ends the walk at a surface before FindScattering. If `visible` is still empty, continues to the first scattering
    /// surface.
    void End(SampledWavelengths lambda) {
        while (visible_ && !*visible_ && !FindScattering(lambda) && Next() == Met::Surface) {
        }
    }

    const PathVertex &Vertex() const { return vertex_; }
    const Ray &GetRay() const { return ray_; }

  private:
    MediumOnRay MediumOnRayAhead(const SampledWavelengths &lambda) const {
        return MediumAhead()->On(ray_, left_ ? Infinity : vertex_.point.t, lambda);
    }
    void FindFootprint();
    void RecordVisible(const SampledWavelengths &lambda) const;

    const PathContext &context_;
    Ray ray_;
    RayDifferential differential_;
    PathVertex vertex_;
    int passed_ = 0;           ///< surfaces since the last vertex
    Point3 start_{};           ///< of the ray at the last vertex, if any was passed
    bool left_ = false;        ///< the ray left the scene
    bool fromCamera_ = false;  ///< the ray starts at the camera
    std::optional<VisibleSurface> *visible_;
    const bool startsWithDifferential_;
};

void PathWalk::ForEachEmission(const SampledWavelengths &lambda, auto &&visit) const {
    const Scene &scene = context_.scene;
    const SurfacePoint &point = vertex_.point;
    if (left_) {
        // A portal is passed from the last vertex on, as for light samples there.
        const Point3 &start = passed_ > 0 ? start_ : ray_.o;
        scene.Lights().ForEachInfiniteEmission(start, ray_.d, lambda, [&](const SampledSpectrum &Le, LightId id) {
            visit(Le, id, Point3(0), Normal3(0));
        });
    } else if (SampledSpectrum Le = EmittedRadiance(scene, point, lambda)) {
        visit(Le, point.light, point.p, point.n);
    }
}

std::optional<ReachedVertex> PathWalk::NextVertex(SampledWavelengths &lambda, SpectralWeights &weights, auto &&track,
                                                  auto &&arrive) {
    for (;;) {
        const Met met = Next();
        if (met == Met::TooManyInterfaces) return {};
        if (const Medium *medium = MediumAhead()) {
            const MediumEvent event = track();
            if (event.kind == MediumEvent::Kind::Absorbed || !weights.beta) return {};
            if (event.kind == MediumEvent::Kind::Scattered) return ReachedVertex{&medium->Phase(), ray_(event.t)};
        }
        arrive(met);
        if (met == Met::Nothing) return {};
        const bool scatters = FindScattering(lambda);
        weights.onlyFirst = lambda.SecondaryTerminated();
        if (scatters) return ReachedVertex{};
    }
}

struct SubsurfaceExit {
    PathVertex vertex;       ///< wo: shading normal on the exit side; the BSDF is the exit lobe
    SampledSpectrum weight;  ///< profile over density
};

/// Samples the exit of light that crosses the surface at `entry`. Empty: none. Uses a fixed number of random numbers.
std::optional<SubsurfaceExit> SampleSubsurfaceExit(const Scene &scene, const SurfacePoint &entry, const Bssrdf &bssrdf,
                                                   Sampler &sampler);

}  // namespace pbrt
