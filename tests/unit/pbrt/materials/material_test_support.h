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

/// Expects that two BSDFs scatter alike: same flags, and equal values, densities and samples for a set of directions.
inline void ExpectSameScattering(const Bsdf &a, const Bsdf &b) {
    ASSERT_EQ(static_cast<bool>(a), static_cast<bool>(b));
    EXPECT_EQ(static_cast<int>(a.Flags()), static_cast<int>(b.Flags()));
    auto near = [](Float x, Float y) { EXPECT_NEAR(x, y, 1e-4f * std::max(Float(1), std::abs(y))); };
    SurfacePoint s = TestPoint();
    for (int i = 0; i < 12; ++i) {
        Float t = static_cast<Float>(i) / 12;
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

}  // namespace pbrt::test
