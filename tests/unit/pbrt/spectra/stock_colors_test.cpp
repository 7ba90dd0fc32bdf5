#include <gtest/gtest.h>

#include "pbrt/spectra/color_space.h"

// Colours of diffuse patches under stdillum-D65, measured in stock pbrt-v4's pictures of the conformance scenes
// color/colorspace_reflectance (output srgb), color/film_rec2020_output and color/saturated_*, divided by the
// irradiance that their grey patches show. They test the whole chain: table, illuminant, matching functions, matrices.

namespace pbrt {
namespace {

struct Patch {
    const char *space;
    Rgb rgb;
    const char *outputSpace;
    Rgb seen;
};

const Patch kPatches[] = {
    {"srgb", {0.7f, 0.25f, 0.15f}, "srgb", {0.7001f, 0.2498f, 0.1498f}},
    {"srgb", {0.2f, 0.6f, 0.3f}, "srgb", {0.1997f, 0.6004f, 0.2999f}},
    {"srgb", {0.2f, 0.3f, 0.75f}, "srgb", {0.1999f, 0.2998f, 0.7502f}},
    {"rec2020", {0.7f, 0.25f, 0.15f}, "srgb", {1.0056f, 0.1944f, 0.1296f}},
    {"rec2020", {0.2f, 0.6f, 0.3f}, "srgb", {-0.0431f, 0.6530f, 0.2714f}},
    {"rec2020", {0.2f, 0.3f, 0.75f}, "srgb", {0.1009f, 0.3085f, 0.8060f}},
    // No reflectance has this colour; the result of the fit depends on how the fit is made.
    {"aces2065-1", {0.7f, 0.25f, 0.15f}, "srgb", {1.3648f, 0.1663f, 0.1809f}},
    {"aces2065-1", {0.2f, 0.6f, 0.3f}, "srgb", {-0.2902f, 0.7476f, 0.2486f}},
    {"aces2065-1", {0.2f, 0.3f, 0.75f}, "srgb", {-0.1223f, 0.2850f, 0.8271f}},
    {"dci-p3", {0.7f, 0.25f, 0.15f}, "srgb", {0.8016f, 0.2308f, 0.1311f}},
    {"dci-p3", {0.2f, 0.6f, 0.3f}, "srgb", {0.1096f, 0.6173f, 0.2782f}},
    {"dci-p3", {0.2f, 0.3f, 0.75f}, "srgb", {0.1774f, 0.3040f, 0.7966f}},
    {"srgb", {0.45f, 0.32f, 0.27f}, "rec2020", {0.3993f, 0.3283f, 0.2773f}},
    {"srgb", {0.84f, 0.49f, 0.17f}, "rec2020", {0.6960f, 0.5106f, 0.2090f}},
    {"srgb", {0.37f, 0.24f, 0.42f}, "rec2020", {0.3292f, 0.2508f, 0.4032f}},
    {"srgb", {0.62f, 0.74f, 0.25f}, "rec2020", {0.6438f, 0.7266f, 0.2990f}},
    {"srgb", {0.1f, 0.25f, 0.6f}, "rec2020", {0.1709f, 0.2434f, 0.5612f}},
    {"srgb", {0.7f, 0.2f, 0.2f}, "rec2020", {0.5137f, 0.2344f, 0.2081f}},
    {"srgb", {0.2f, 0.55f, 0.25f}, "rec2020", {0.3173f, 0.5226f, 0.2755f}},
    // The fits of these colours end at the bound on the coefficients; some have coefficients of -400.
    {"dci-p3", {0.05f, 0.9f, 0.05f}, "srgb", {-0.1420f, 0.9357f, -0.0178f}},
    {"rec2020", {0.05f, 0.9f, 0.05f}, "srgb", {-0.3046f, 0.8594f, 0.0226f}},
    {"rec2020", {0.05f, 0.9f, 0.9f}, "srgb", {-0.3673f, 0.8886f, 0.7706f}},
    {"rec2020", {0.9f, 0.05f, 0.05f}, "srgb", {1.3065f, 0.0950f, 0.1783f}},
    {"aces2065-1", {0.05f, 0.9f, 0.05f}, "srgb", {-0.3931f, 0.7440f, 0.0975f}},
    {"aces2065-1", {0.05f, 0.05f, 0.9f}, "srgb", {-0.1090f, 0.0813f, 0.4695f}},
    {"aces2065-1", {0.05f, 0.9f, 0.9f}, "srgb", {-0.4356f, 0.6217f, 0.5307f}},
    {"aces2065-1", {0.1f, 0.6f, 0.1f}, "srgb", {-0.3695f, 0.7110f, 0.0590f}},
    {"aces2065-1", {0.05f, 0.1f, 0.6f}, "srgb", {-0.1603f, 0.1369f, 0.4765f}},
};

TEST(StockColors, DiffusePatchesAgree) {
    SpectrumPtr light = NamedSpectrum("stdillum-D65");
    for (const Patch &patch : kPatches) {
        RgbAlbedoSpectrum reflectance(*ColorSpace::Find(patch.space), patch.rgb);
        glm::dvec3 xyz(0);
        for (Float lambda = LambdaMin; lambda <= LambdaMax; ++lambda)
            xyz += double(reflectance(lambda)) * double((*light)(lambda)) *
                   glm::dvec3(CieX()(lambda), CieY()(lambda), CieZ()(lambda));
        Rgb rgb = ColorSpace::Find(patch.outputSpace)->ToRgb(Xyz(xyz / double(CieYIntegral)));
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(rgb[c], patch.seen[c], 0.0002f + 0.002f * std::abs(patch.seen[c]))
                << patch.space << " " << patch.rgb.x << " " << patch.rgb.y << " " << patch.rgb.z << " channel " << c;
    }
}

TEST(StockColors, WhitePointsAreThoseOfItsFiles) {
    // The chromaticities are those in the header of stock pbrt-v4's rec2020 picture.
    Point2 white = ColorSpace::Find("rec2020")->White();
    EXPECT_NEAR(white.x, 0.312727f, 2e-6);
    EXPECT_NEAR(white.y, 0.329023f, 2e-6);
}

TEST(StockColors, WhiteBalanceBelow4000KelvinAgrees) {
    // film/cie1931_whitebalance_iso shows a 0.85 grey under a 2900 K black body, balanced for 3200 K. The ratios of the
    // channels are compared, so the exposure cancels.
    const ColorSpace &space = ColorSpace::SRGB();
    Vector3 balanced = SpectrumToXyz(DaylightSpectrum(3200)), light = SpectrumToXyz(BlackbodySpectrum(2900));
    Point2 from(balanced.x / (balanced.x + balanced.y + balanced.z),
                balanced.y / (balanced.x + balanced.y + balanced.z));
    Rgb rgb = space.ToRgb(WhiteBalanceMatrix(from, space.White()) * light);
    EXPECT_NEAR(rgb.x / rgb.y, 0.7554f / 0.6443f, 5e-4);
    EXPECT_NEAR(rgb.z / rgb.y, 0.5306f / 0.6443f, 5e-4);
}

}  // namespace
}  // namespace pbrt
