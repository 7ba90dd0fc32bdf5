#pragma once
#include <span>

#include "pbrt/scene/scene.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Vertex of a bidirectional path: camera, light, surface, or medium.
struct BdptVertex {
    enum class Kind { Camera, Light, Surface, Medium };
    Kind kind = Kind::Surface;
    /// Radiance or importance along the subpath, divided by the subpath's density.
    SampledSpectrum beta{1};
    /// SpectralWeights::ru of the subpath; 1 without media.
    SampledSpectrum ru{1};
    /// Density in its own subpath and in one from the other end, without free-flight factors (BdptWeights): by area, in
    /// media by area across the ray; lights outside the scene: by solid angle.
    Float pdfForward = 0, pdfReverse = 0;
    /// Specular surface vertex: no connections.
    bool isSpecular = false;
    PathVertex surface;  ///< Kind::Surface
    // Other kinds.
    LightId light{};  ///< Kind::Light
    Point3 p{};
    Vector3 pError{};
    Normal3 n{};                 ///< zero without surface
    Vector3 direction{0, 0, 1};  ///< of light from outside the scene; in a medium: unit, towards the previous vertex
    bool isBeyondScene = false;
    // Kind::Medium
    MediumId medium{};
    const HenyeyGreenstein *phase = nullptr;
    Float time = 0;

    bool IsSurface() const { return kind == Kind::Surface; }
    bool IsInMedium() const { return kind == Kind::Medium; }
    Point3 Position() const { return IsSurface() ? surface.point.p : p; }
    Normal3 Normal() const { return IsSurface() ? surface.point.n : n; }
    Vector3 Towards(const BdptVertex &to) const {
        if (to.isBeyondScene) return -to.direction;
        return isBeyondScene ? direction : Normalize(to.Position() - Position());
    }
    /// Converts a density by solid angle, from `from` towards this vertex, into one by area here.
    Float AreaPdf(const BdptVertex &from, Float solidAnglePdf) const {
        if (isBeyondScene) return solidAnglePdf;
        const Vector3 d = Position() - from.Position();
        const Float l2 = LengthSquared(d);
        if (!(l2 > 0)) return 0;
        const Normal3 normal = Normal();
        return solidAnglePdf / l2 * (normal == Normal3(0) ? Float(1) : AbsDot(normal, d) / std::sqrt(l2));
    }
    /// Converts a density by area across parallel rays of this direction (unit) into one by area here.
    Float AreaPdfOfParallel(Float pdf, const Vector3 &w) const {
        const Normal3 normal = Normal();
        return normal == Normal3(0) ? pdf : pdf * AbsDot(normal, w);
    }

    // For surface and medium vertices. `wo` and `wi` are unit and point away.

    /// True if directions not sampled by scattering have nonzero scattering.
    bool CanConnect() const { return IsInMedium() || IsNonSpecular(surface.bsdf.Flags()); }
    /// BSDF or phase function between the direction of the previous vertex and `wi`.
    SampledSpectrum F(const Vector3 &wi, TransportMode mode = TransportMode::Radiance) const {
        return IsInMedium() ? SampledSpectrum(phase->P(direction, wi)) : surface.bsdf.F(surface.point.wo, wi, mode);
    }
    /// Cosine factor of F; 1 in media.
    Float Cosine(const Vector3 &wi) const { return IsInMedium() ? 1 : AbsDot(wi, surface.point.shading.n); }
    Float CosineOfLight(const Vector3 &wi) const {
        return IsInMedium() ? 1 : AdjointCosine(surface.point, surface.point.wo, wi);
    }
    /// Density (solid angle) of scattering from `wo` towards `wi`.
    Float ScatterPdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
        return IsInMedium() ? phase->P(wo, wi) : surface.bsdf.Pdf(wo, wi, mode);
    }
    LightSampleContext Context() const {
        return IsInMedium() ? LightSampleContext{p, {}, {}, {}, time} : LightContextAt(surface.point);
    }
    MediumId MediumTowards(const Vector3 &wi) const { return IsInMedium() ? medium : surface.point.MediumTowards(wi); }
    /// Light sampler query, with outgoing direction `wo`, at this depth from the camera.
    LightQuery Query(const Vector3 &wo, const SampledWavelengths &lambda, int depth) const {
        if (IsInMedium()) return LightQueryInMedium(p, wo, medium, *phase, time, lambda, depth);
        LightQuery query = LightQueryAt(surface, lambda, depth);
        query.wo = wo;
        return query;
    }
};

/// MIS weights of bidirectional paths.
///
/// In media the compared densities are geometric: by area, without the free-flight factors (transmittance, and density
/// per length of scattering). Every strategy scatters at every inner vertex, so the latter is common to all. They
/// differ by the transmittance of the connected edge and by the spectral densities (SpectralWeights); both are omitted.
///
/// A weight need not be a ratio of true densities for the sum over strategies to be unbiased. For every path, the
/// weights of all strategies that can sample it must sum to 1. They do, because each is a share of the same sum, which
/// does not depend on null collisions, on the sampled wavelength, or on transmittance estimates. Each strategy divides
/// by its own density, averaged over wavelengths. The cost is some noise: an edge of low transmittance counts as much
/// as a clear one.
class BdptWeights {
  public:
    /// `shooting` selected the lights of light subpaths, `connecting` those of single light vertices.
    BdptWeights(const LightTable &lights, const LightSampler &shooting, const LightSampler &connecting)
        : lights_(lights), shooting_(shooting), connecting_(connecting) {}

    /// Balance heuristic weight of a path sampled with `fromLight` vertices from the light, against all other splits
    /// (Veach 1997, section 10.2). `path`: vertices from light to camera, each with its own subpath's densities.
    /// `cameraPdf`: density by area of the vertex next to the camera, sampled from the camera.
    Float Weight(std::span<const BdptVertex *const> path, int fromLight, Float cameraPdf,
                 const SampledWavelengths &lambda) const;

    /// Density of a light subpath's first vertex: by area; outside the scene: by solid angle.
    Float LightPdf(const BdptVertex &light, const BdptVertex &next) const;

  private:
    /// Density by area of `next` as the second vertex of a light subpath from `light`.
    Float FirstStepPdf(const BdptVertex &light, const BdptVertex &next) const;
    /// LightPdf for a light vertex selected for and sampled from the vertex `from`, which continues to `beyond` and has
    /// this depth from the camera. For an environment light with regions: of the region.
    Float ConnectedLightPdf(const BdptVertex &light, const BdptVertex &from, const BdptVertex &beyond,
                            const SampledWavelengths &lambda, int depth) const;
    const LightTable &lights_;
    const LightSampler &shooting_, &connecting_;
};

}  // namespace pbrt
