#pragma once
#include "pbrt/math/frame.h"

namespace pbrt {

/// Anisotropic Trowbridge-Reitz (GGX) distribution with Smith's height-correlated shadowing (Heitz 2014). Local
/// coordinates; directions may be on either side.
class TrowbridgeReitz {
  public:
    TrowbridgeReitz() = default;
    TrowbridgeReitz(Float alphaX, Float alphaY) : alphaX_(alphaX), alphaY_(alphaY) {
        if (!EffectivelySmooth()) {
            alphaX_ = std::max(alphaX_, kMinAlpha);
            alphaY_ = std::max(alphaY_, kMinAlpha);
        }
    }

    /// Remaps the "roughness" of scene files to alpha.
    static Float RoughnessToAlpha(Float roughness) { return std::sqrt(roughness); }
    bool EffectivelySmooth() const { return std::max(alphaX_, alphaY_) < Float(1e-3); }
    Float AlphaX() const { return alphaX_; }
    Float AlphaY() const { return alphaY_; }

    /// Microfacet area density at normal wm; D(wm) |cos| integrates to 1 over the hemisphere.
    Float D(const Vector3 &wm) const {
        Float s = Sqr(wm.x / alphaX_) + Sqr(wm.y / alphaY_) + Sqr(wm.z);
        return 1 / (Pi * alphaX_ * alphaY_ * s * s);
    }
    /// Fraction of the microfacets facing w that are visible from w.
    Float G1(const Vector3 &w) const { return 2 / (1 + SlopeRoot(w)); }
    /// Fraction of microfacets visible from both directions.
    Float G(const Vector3 &wo, const Vector3 &wi) const { return 2 / (SlopeRoot(wo) + SlopeRoot(wi)); }

    /// G(wo, wi) / G1(wo): fraction of the facets visible from wo that are also visible from wi.
    Float GOverG1(const Vector3 &wo, const Vector3 &wi) const {
        const Float rootO = SlopeRoot(wo);
        return (1 + rootO) / (rootO + SlopeRoot(wi));
    }

    /// Density, by solid angle, of normal wm (upper hemisphere) among those visible from w.
    Float VisiblePdf(const Vector3 &w, const Vector3 &wm) const {
        return G1(w) / AbsCosTheta(w) * D(wm) * AbsDot(w, wm);
    }
    /// Samples VisiblePdf (Heitz 2018): stretched to the unit hemisphere, the visible part projects along w to a half
    /// disk plus half an ellipse.
    Vector3 SampleVisible(const Vector3 &w, const Point2 &u) const {
        Vector3 view = Normalize({alphaX_ * w.x, alphaY_ * w.y, w.z});
        if (view.z < 0) view = -view;
        Float length2 = Sqr(view.x) + Sqr(view.y);
        Vector3 t1 = length2 > Float(1e-12) ? Vector3(-view.y, view.x, 0) / std::sqrt(length2) : Vector3(1, 0, 0);
        Vector3 t2 = Cross(view, t1);

        Float r = std::sqrt(u.x), phi = 2 * Pi * u.y;
        Float p1 = r * std::cos(phi), p2 = r * std::sin(phi);
        p2 = Lerp((1 + view.z) / 2, SafeSqrt(1 - p1 * p1), p2);
        Float p3 = SafeSqrt(1 - p1 * p1 - p2 * p2);
        Vector3 n = t1 * p1 + t2 * p2 + view * p3;
        return Normalize({alphaX_ * n.x, alphaY_ * n.y, std::max(Float(1e-6), n.z)});
    }

    /// Samples VisiblePdf by another, faster map (Dupuy and Benyoub 2023): after the stretch, reflections at visible
    /// normals fill a spherical cap.
    Vector3 SampleVisibleByCap(const Vector3 &w, const Point2 &u) const {
        Vector3 view = Normalize({alphaX_ * w.x, alphaY_ * w.y, w.z});
        if (view.z < 0) view = -view;
        const Float z = (1 - u.y) * (1 + view.z) - view.z;
        const Float r = SafeSqrt(1 - z * z), phi = 2 * Pi * u.x;
        const Vector3 n(r * std::cos(phi) + view.x, r * std::sin(phi) + view.y, z + view.z);
        return Normalize({alphaX_ * n.x, alphaY_ * n.y, std::max(Float(1e-6), n.z)});
    }

    /// Raises small alphas (pbrt-v4-format §5.5).
    void Regularize() {
        for (Float *alpha : {&alphaX_, &alphaY_})
            if (*alpha < Float(0.3)) *alpha = std::clamp(2 * *alpha, Float(0.1), Float(0.3));
    }

  private:
    /// Smith's 1 + 2 Lambda.
    Float SlopeRoot(const Vector3 &w) const {
        return std::sqrt(1 + (Sqr(alphaX_ * w.x) + Sqr(alphaY_ * w.y)) / Sqr(w.z));
    }

    static constexpr Float kMinAlpha = Float(1e-4);
    Float alphaX_ = 0, alphaY_ = 0;
};

}  // namespace pbrt
