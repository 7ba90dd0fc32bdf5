#pragma once
#include "pbrt/transport/light_query.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// A place of a bidirectional path: the camera, a light, a surface, or a place in a medium.
struct BdptVertex {
    enum class Kind { Camera, Light, Surface, Medium };
    Kind kind = Kind::Surface;
    /// Radiance or importance that reaches the vertex along its subpath, divided by the subpath's density.
    SampledSpectrum beta{1};
    /// SpectralWeights::ru of the subpath; 1 where no medium is on the way.
    SampledSpectrum ru{1};
    /// Density with which its own subpath makes it, and with which a subpath from the other end would, without the
    /// factors of free flight (BdptWeights): by area, in media by area across the ray; lights beyond the scene: by
    /// solid angle.
    Float pdfForward = 0, pdfReverse = 0;
    /// A surface that scattered the subpath specularly: nothing connects to it.
    bool isSpecular = false;
    PathVertex surface;  ///< Kind::Surface
    // All other kinds.
    LightId light{};  ///< Kind::Light
    Point3 p{};
    Vector3 pError{};
    Normal3 n{};                 ///< zero where there is no surface
    Vector3 direction{0, 0, 1};  ///< of light from beyond the scene; in a medium: unit, to where the subpath came from
    bool isBeyondScene = false;
    // Kind::Medium
    MediumId medium{};
    const HenyeyGreenstein *phase = nullptr;
    Float time = 0;

    bool IsSurface() const { return kind == Kind::Surface; }
    bool IsInMedium() const { return kind == Kind::Medium; }
    Point3 Position() const { return IsSurface() ? surface.point.p : p; }
    Normal3 Normal() const { return IsSurface() ? surface.point.n : n; }
    /// Unit, towards another vertex.
    Vector3 Towards(const BdptVertex &to) const {
        if (to.isBeyondScene) return -to.direction;
        return isBeyondScene ? direction : Normalize(to.Position() - Position());
    }
    /// Turns a density by solid angle, of directions from `from` to this vertex, into one by area here.
    Float AreaPdf(const BdptVertex &from, Float solidAnglePdf) const {
        if (isBeyondScene) return solidAnglePdf;
        const Vector3 d = Position() - from.Position();
        const Float l2 = LengthSquared(d);
        if (!(l2 > 0)) return 0;
        const Normal3 normal = Normal();
        return solidAnglePdf / l2 * (normal == Normal3(0) ? Float(1) : AbsDot(normal, d) / std::sqrt(l2));
    }
    /// Turns a density by area across rays of this direction (unit), which are parallel, into one by area here.
    Float AreaPdfOfParallel(Float pdf, const Vector3 &w) const {
        const Normal3 normal = Normal();
        return normal == Normal3(0) ? pdf : pdf * AbsDot(normal, w);
    }

    // The following are for surfaces and places in media, which scatter. `wo` and `wi` are unit and point away.

    /// True if light can be scattered in directions that something else than scattering has chosen.
    bool CanConnect() const { return IsInMedium() || IsNonSpecular(surface.bsdf.Flags()); }
    /// BSDF or phase function between the direction that the subpath came from and `wi`.
    SampledSpectrum F(const Vector3 &wi, TransportMode mode = TransportMode::Radiance) const {
        return IsInMedium() ? SampledSpectrum(phase->P(direction, wi)) : surface.bsdf.F(surface.point.wo, wi, mode);
    }
    /// The cosine that goes with it; 1 in media.
    Float Cosine(const Vector3 &wi) const { return IsInMedium() ? 1 : AbsDot(wi, surface.point.shading.n); }
    Float CosineOfLight(const Vector3 &wi) const {
        return IsInMedium() ? 1 : AdjointCosine(surface.point, surface.point.wo, wi);
    }
    /// Density by solid angle with which light or importance that came from `wo` is scattered towards `wi`.
    Float ScatterPdf(const Vector3 &wo, const Vector3 &wi, TransportMode mode) const {
        return IsInMedium() ? phase->P(wo, wi) : surface.bsdf.Pdf(wo, wi, mode);
    }
    /// Where connections begin.
    LightSampleContext Context() const {
        return IsInMedium() ? LightSampleContext{p, {}, {}, {}, time} : LightContextAt(surface.point);
    }
    MediumId MediumTowards(const Vector3 &wi) const { return IsInMedium() ? medium : surface.point.MediumTowards(wi); }
    /// What light sampling asks for, seen from `wo`, at the vertex of this depth from the camera.
    LightQuery Query(const Vector3 &wo, const SampledWavelengths &lambda, int depth) const {
        if (IsInMedium()) return LightQueryInMedium(p, wo, medium, *phase, time, lambda, depth);
        LightQuery query = LightQueryAt(surface, lambda, depth);
        query.wo = wo;
        return query;
    }
};

}  // namespace pbrt
