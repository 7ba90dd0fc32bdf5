#pragma once
#include <gtest/gtest.h>

#include "../textures/texture_test_support.h"
#include "pbrt/materials/material_factory.h"

namespace pbrt::test {

inline const SampledWavelengths kLambda = SampledWavelengths::SampleVisible(0.4f);

/// Makes materials over a texture library and remembers the named ones.
struct Workshop : Bench {
    std::map<std::string, MaterialPtr> named;

    MaterialPtr Make(const std::string &type, const Params &params = Params("material")) {
        MaterialContext context{textures, files, sink, [this](const std::string &name) -> MaterialPtr {
                                    auto found = named.find(name);
                                    return found == named.end() ? nullptr : found->second;
                                }};
        return MakeMaterial(type, params, context);
    }
};

/// A surface point whose tangent frame is neither aligned with the axes nor of unit length.
inline SurfacePoint TestPoint() {
    SurfacePoint s;
    s.p = {1, 2, 3};
    s.n = s.shading.n = Normalize(Vector3(1, 2, 2));
    Vector3 x, y;
    CoordinateSystem(s.n, &x, &y);
    s.dpdu = s.shading.dpdu = x * 2.f;
    s.dpdv = s.shading.dpdv = y * 3.f;
    s.wo = Normalize(s.n + x * 0.4f - y * 0.3f);
    s.uv = {0.3f, 0.6f};
    return s;
}

/// p = (2 u, 3 v, 0).
inline SurfacePoint FlatPoint() {
    SurfacePoint s;
    s.uv = {.3f, .6f};
    s.p = {.6f, 1.8f, 0};
    s.n = s.shading.n = {0, 0, 1};
    s.dpdu = s.shading.dpdu = {2, 0, 0};
    s.dpdv = s.shading.dpdv = {0, 3, 0};
    return s;
}

/// A normal map of one column of pixels, top first.
inline std::shared_ptr<const Image> NormalMapOf(const std::vector<Vector3> &normals) {
    Image image(PixelFormat::Float, {1, int(normals.size())}, {"R", "G", "B"});
    for (size_t y = 0; y < normals.size(); ++y)
        for (int c = 0; c < 3; ++c) image.Set({0, int(y)}, c, (normals[y][c] + 1) / 2);
    return std::make_shared<const Image>(std::move(image));
}

inline void ExpectNear(const Vector3 &a, const Vector3 &b, Float tolerance = 1e-5f) {
    EXPECT_LT(Distance(a, b), tolerance) << a.x << " " << a.y << " " << a.z;
}

/// Expects that two BSDFs scatter alike: same flags, and equal values, densities and samples for a set of directions.
inline void ExpectSameScattering(const Bsdf &a, const Bsdf &b) {
    ASSERT_EQ(bool(a), bool(b));
    EXPECT_EQ(int(a.Flags()), int(b.Flags()));
    auto near = [](Float x, Float y) { EXPECT_NEAR(x, y, 1e-4f * std::max(Float(1), std::abs(y))); };
    SurfacePoint s = TestPoint();
    for (int i = 0; i < 12; ++i) {
        Float t = Float(i) / 12;
        Vector3 wi = Normalize(SphericalDirection(std::sin(t * Pi), std::cos(t * Pi), 9 * t));
        SampledSpectrum fa = a.F(s.wo, wi), fb = b.F(s.wo, wi);
        for (int c = 0; c < SpectrumSamples; ++c) near(fa[c], fb[c]);
        near(a.Pdf(s.wo, wi), b.Pdf(s.wo, wi));
        auto sa = a.Sample(s.wo, t, {t, 1 - t}), sb = b.Sample(s.wo, t, {t, 1 - t});
        ASSERT_EQ(sa.has_value(), sb.has_value());
        if (!sa) continue;
        for (int c = 0; c < SpectrumSamples; ++c) near(sa->f[c], sb->f[c]);
        near(sa->pdf, sb->pdf);
        near(Distance(sa->wi, sb->wi), 0);
    }
}

/// Materials against lobes that are built by hand from the same numbers, at the test point.
class MaterialTest : public testing::Test {
  protected:
    /// The BSDF of a material; fails if there is an error.
    Bsdf Of(const std::string &type, const Params &params = Params()) {
        lambda_ = kLambda;
        MaterialPtr m = shop_.Make(type, params);
        EXPECT_EQ(shop_.Errors(), 0u);
        return m->GetBsdf(point_, lambda_);
    }
    template <class Lobe>
    void ExpectLobe(const std::string &type, const Params &params, const Lobe &lobe) {
        ExpectSameScattering(Of(type, params), Bsdf(point_.shading.n, point_.shading.dpdu, lobe));
    }
    static SampledSpectrum Albedo(Float r, Float g, Float b) {
        return RgbAlbedoSpectrum(ColorSpace::SRGB(), Rgb(r, g, b)).Sample(kLambda);
    }
    static SampledSpectrum Unbounded(Float r, Float g, Float b) {
        return RgbUnboundedSpectrum(ColorSpace::SRGB(), Rgb(r, g, b)).Sample(kLambda);
    }

    Workshop shop_;
    SurfacePoint point_ = TestPoint();
    SampledWavelengths lambda_ = kLambda;
};

}  // namespace pbrt::test
